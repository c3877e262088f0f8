// Sights: zeroing, range cards, hold-over and clicks (chapters 18.2, 18.3).
//
// The frame is the shooter's: the eye at the origin, x level toward the target, y up, z to the right. The line of sight
// starts at the eye, inclined by `slant`; the muzzle lies `sight_height` below it, and `sight_offset` to the left of
// it.
#pragma once

#include <optional>
#include <vector>

#include "carom/ballistics/flight.h"
#include "carom/ballistics/spin.h"

namespace carom::ballistics {

inline constexpr double minute_of_angle = math::pi / 10800;  ///< rad: 29.0888 mm at 100 m (and not 1 inch at 100 yd)
inline constexpr double milliradian = 1e-3;                  ///< rad
inline constexpr double nato_mil = 2 * math::pi / 6400;      ///< rad

/// A firearm and what it shoots.
struct Gun {
  Projectile projectile{};
  double mass = 0;             ///< kg, of the projectile: for energies; 0: none are told
  double muzzle_speed = 800;   ///< m/s
  double sight_height = 0.05;  ///< m, from the bore up to the line of sight
  double sight_offset = 0;     ///< m, from the bore to the right to the line of sight
  /// The bullet in the field's units and the twist (inches a turn, negative: left-hand), for spin drift and jump.
  std::optional<BulletShape> shape{};
  double twist = 0;
};

/// How it is held and set.
struct Aiming {
  double elevation = 0;  ///< rad, from the line of sight up to the bore, as `zero_elevation` gives it
  double slant = 0;      ///< rad, of the line of sight above the horizon
  double cant = 0;       ///< rad, the gun leaning to the right
  double windage = 0;    ///< rad, from the line of sight to the right to the bore, as a turned sight gives it
};
/// A direction (unit vector, y up) turned by angles (rad) across it: up in the upright plane through it, and to the
/// right. Straight up and down, x is taken for what lies ahead.
CAROM_API math::Vec3d swung(math::Vec3d way, double up, double right);
/// Where the bore points (unit vector) whose line of sight points along `line`, a unit vector of any frame with y up:
/// raised, turned and canted. `line` stands for the slant.
CAROM_API math::Vec3d bore_direction(math::Vec3d line, const Aiming& aiming);

/// A point of the flight as the shooter sees it.
struct SightedPoint {
  double distance = 0;  ///< m along the line of sight
  double time = 0;      ///< s
  double speed = 0;     ///< m/s
  double mach = 0;
  double energy = 0;      ///< J
  double height = 0;      ///< m across the line of sight, up; negative: it falls below
  double side = 0;        ///< m, to the right; spin drift and jump included
  double hold_up = 0;     ///< rad, how much higher to aim to hit there
  double hold_right = 0;  ///< rad
};

/// The elevation (rad) at which the shot crosses the line of sight at `distance` m; the smaller one of the two.
/// Error: out of reach, or a field that cannot be, named.
CAROM_API core::Result<double> zero_elevation(const Gun& gun, const Conditions& conditions, double distance,
                                              double slant = 0);

/// Elevation and windage with which the shot crosses the line of sight at `distance` m: the windage is that of a bore
/// beside it (an offset zero), not of wind or spin. Beyond, such a shot goes on to the other side: by
/// offset · (distance/zero − 1). Errors likewise.
CAROM_API core::Result<Aiming> zero_aiming(const Gun& gun, const Conditions& conditions, double distance,
                                           double slant = 0);

/// Parallax of a telescope that is free of it at the distance D₀ (m; infinite, too): there its objective has the image
/// of the reticle, as if it hung in space. An eye off the axis by e looks through the objective M e beside its middle
/// (M: the magnification; it is erecting, so on the same side), and along the line from there to the reticle: what that
/// covers at the distance R lies M e (1 − R/D₀) beside the axis, on the side of the eye where that is positive.
inline double parallax_error(double eye, double distance, double parallax_free, double magnification = 1) {
  return magnification * eye * (1 - distance / parallax_free);
}
/// rad, by which the axis points beside the mark at R that such an eye has the reticle on: −M e (1/R − 1/D₀).
inline double parallax_turn(double eye, double distance, double parallax_free, double magnification = 1) {
  return -parallax_error(eye, distance, parallax_free, magnification) / distance;
}

/// A shot seen along the line of sight.
class CAROM_API SightedFlight {
 public:
  static core::Result<SightedFlight> fire(const Gun& gun, const Conditions& conditions, const Aiming& aiming,
                                          double farthest);
  /// Empty beyond the end of the flight.
  std::optional<SightedPoint> at(double distance) const;
  /// Distances (m) at which it crosses the line of sight: the near and the far zero.
  std::vector<double> zeros() const;
  /// The farthest distance (m) up to which it stays within `radius` m of the line of sight: point-blank range.
  double point_blank_range(double radius) const;
  /// The stretch of distances (m) about `distance` over which the shot stays within `height`/2 m of where it is there:
  /// a target of that height, aimed at its middle, is hit anywhere on it. Cut off at the end of the flight. Empty
  /// beyond it. (Danger space; as long as wrongly judged distances may be.)
  struct Stretch {
    double from = 0, to = 0;
  };
  std::optional<Stretch> danger_space(double distance, double height) const;
  const Trajectory& trajectory() const { return trajectory_; }

 private:
  explicit SightedFlight(Trajectory trajectory) : trajectory_(std::move(trajectory)) {}
  SightedPoint seen(const Trajectory::Point& point) const;
  Trajectory trajectory_;
  math::Vec3d along_{1, 0, 0}, up_{0, 1, 0}, right_{0, 0, 1};
  environment::AirColumn air_{};
  double mass_ = 0, speed_of_sound_ = 340.294, stability_ = 0, twist_sign_ = 0, jump_ = 0;
};

/// The zero (m) that gives the longest point-blank range for targets of that radius, and that range.
struct PointBlank {
  double zero = 0;
  double range = 0;
};
CAROM_API core::Result<PointBlank> best_point_blank(const Gun& gun, const Conditions& conditions, double radius);

/// The elevation (rad) over the horizon that carries farthest over level ground, and how far (m). Errors as
/// `zero_elevation`.
struct GreatestRange {
  double elevation = 0, range = 0, time = 0;
};
CAROM_API core::Result<GreatestRange> greatest_range(const Gun& gun, const Conditions& conditions);

/// Whole clicks of `click` rad nearest to the angle.
inline int clicks(double angle, double click) { return int(math::round(angle / click)); }

/// The side a shot lands on by the closed form of field solvers, z = Ω sin φ R T: for comparison with printed tables
/// only. It overstates the true deflection, which `Conditions::rotation` gives, by a fifth. Latitude in rad.
inline double field_coriolis_drift(double latitude, double range, double time) {
  return 7.292115e-5 * math::sin(latitude) * range * time;
}
/// Its factor on the drop: 1 − 2 Ω v₀ cos φ sin A/g, azimuth A from north over east.
inline double field_coriolis_drop_factor(double latitude, double azimuth, double speed, double gravity = 9.80665) {
  return 1 - 2 * 7.292115e-5 * speed * math::cos(latitude) * math::sin(azimuth) / gravity;
}

}  // namespace carom::ballistics
