// The flight of a point mass through air (chapters 2.4, 4.3, 6.1–6.3, 18.1). y is up; in the local frame of a shooter
// x points down range and z to the right.
#pragma once

#include <optional>
#include <vector>

#include "carom/ballistics/drag_curve.h"
#include "carom/core/function_ref.h"
#include "carom/environment/wind_field.h"
#include "carom/forces/projectile.h"
#include "carom/ode/state.h"

namespace carom::ballistics {

using forces::FlightPoint;
using State = ode::Motion<math::Vec3d>;  ///< position (m) and velocity (m/s)

/// What a point mass is to the air: a = −½ ρ C_D(M) (A/m) |w| w, w the velocity through the air.
struct Projectile {
  DragCurve drag{};
  double area_per_mass = 0;  ///< m²/kg; 0: no drag
};
/// By its ballistic coefficient (lb/in²): A/m = (π/4) (.0254²/.45359237)/BC.
CAROM_API Projectile projectile_from_coefficient(DragFunction function, double ballistic_coefficient,
                                                 Interpolation interpolation = Interpolation::smooth);
/// By mass (kg) and diameter (m); a form factor multiplies the drag.
CAROM_API Projectile projectile_from_size(DragCurve drag, double mass, double diameter, double form_factor = 1);
/// Quadratic drag with the terminal speed v_t (m/s) in air of density `density` (kg/m³) under `gravity` (m/s²).
CAROM_API Projectile projectile_from_terminal_speed(double terminal_speed, double density = 1.225,
                                                    double gravity = 9.80665);

enum class GravityModel {
  uniform,         ///< the same everywhere
  inverse_square,  ///< falls with height, as g₀ (R/(R + y))², straight down over flat ground
  round_earth,     ///< toward the centre of the Earth, R below the origin
};

/// Where it flies.
struct Conditions {
  environment::AirColumn air{};
  environment::WindColumn wind{};
  double gravity = 9.80665;  ///< m/s² at y = 0
  GravityModel gravity_model = GravityModel::uniform;
  double earth_radius = 6356766;  ///< m
  /// rad/s, the turning of the frame: adds the true −2Ω × v. Zero: no Coriolis force.
  math::Vec3d rotation{};
  /// Wind by place and time, which stands for `wind` where there is one: gusts, thermals, lees. Flights, shells,
  /// rockets and bodies of a world feel it, in steps of at most a fiftieth of a second. Batches and the aim solver know
  /// wind by height alone: they keep to `wind`.
  environment::WindFunction field{};
  double field_time = 0;  ///< s: of the field when a flight begins, or when a world's time is 0
};

/// The Earth's turning in a local frame whose x axis points to compass bearing `bearing` (rad from north over east):
/// Ω (cos φ north + sin φ up).
CAROM_API math::Vec3d earth_rotation_rate(double latitude, double bearing);

/// Acceleration (m/s²) of the projectile, `time` s after the flight began.
CAROM_API math::Vec3d acceleration(const Projectile& projectile, const Conditions& conditions, const State& state,
                                   double time = 0);

/// A flight as nodes with a polynomial of fifth order between them: ask it at any time, distance or height.
class CAROM_API Trajectory {
 public:
  struct Node {
    double time = 0;  ///< s
    math::Vec3d position{}, velocity{}, acceleration{};
  };
  struct Point : FlightPoint {
    double time = 0;  ///< s since the start
  };

  explicit Trajectory(std::vector<Node> nodes) : nodes_(std::move(nodes)) {}
  double duration() const { return nodes_.back().time; }
  std::span<const Node> nodes() const { return nodes_; }
  /// Times before the start and after the end give those.
  Point at(double time) const;
  Point start() const { return at(0); }
  Point end() const { return at(duration()); }
  /// The first time at which `value` (of a point) rises through or falls to zero; empty where it never does.
  std::optional<Point> first(core::FunctionRef<double(const Point&)> value) const;
  /// The first point at the horizontal distance from the start (m), and the first on the way down through a height y.
  std::optional<Point> at_distance(double distance) const;
  std::optional<Point> falling_through(double height) const;
  Point apex() const;  ///< the highest point

 private:
  std::vector<Node> nodes_;
};

struct FlightLimits {
  double time = 600;        ///< s
  double ground = -1e300;   ///< m: ends on the way down through this height
  double distance = 1e300;  ///< m, horizontal from the start
  double tolerance = 1e-9;  ///< of a step, relative
};
/// From `start` to the first limit. Errors: a start, limit or projectile that is not finite, or a flight that cannot be
/// integrated.
CAROM_API core::Result<Trajectory> fly(const Projectile& projectile, const Conditions& conditions,
                                       const FlightPoint& start, const FlightLimits& limits = {});

/// Unit vector `elevation` rad above the horizon, `azimuth` rad to the right of x.
CAROM_API math::Vec3d direction(double elevation, double azimuth = 0);

}  // namespace carom::ballistics
