// How balls bounce, skid and roll (chapters 5.4 and 19): grip and slip, turf that gives way, greens of a given speed.
#pragma once

#include <span>
#include <string_view>

#include "carom/sports/flight.h"

namespace carom::sports {

/// What a ball meets.
struct Surface {
  double friction = 0.4;              ///< μ
  double restitution = 0.7;           ///< e at low speed
  double restitution_slope = 0;       ///< s/m: e falls by this per m/s of normal speed …
  double restitution_curve = 0;       ///< s²/m²: … and rises by this with its square
  double restitution_floor = 0;       ///< never below it
  double restitution_speed = 1e9;     ///< m/s: from here on the floor
  double tangential_restitution = 0;  ///< e_x: 0 grips dead, 1 gives all slip back; 0 … .3 fits tennis
  /// Soft ground is ploughed: its surface acts as if it leaned toward the ball by
  /// tilt · (v/tilt_speed)(φ/tilt_angle), φ the angle of the way from the normal; tilt 0: firm.
  double tilt = 0;             ///< rad
  double tilt_speed = 18.6;    ///< m/s
  double tilt_angle = 0.7749;  ///< rad, 44.4°
  /// Rolling: deceleration as a part of g; of a green with Stimp distance d it is v₀²/(2 d g), v₀ = 1.83 m/s.
  double rolling = 0.05;
};
/// Errors name the field.
CAROM_API core::Status check(const Surface& surface);

/// hard_court, clay_court, grass_court, wood_floor, table, fairway, rough, green, bunker, pitch, soccer_grass,
/// outfield, ash_board; each with its source.
struct SurfacePreset {
  std::string_view name, source;
  Surface surface{};
};
CAROM_API std::span<const SurfacePreset> surface_presets();
CAROM_API core::Result<Surface> surface_preset(std::string_view name);

/// e at a normal speed (m/s, ≥ 0).
CAROM_API double restitution(const Surface& surface, double normal_speed);
/// Rolling resistance (a part of g) of a green: `stimp` is the distance (m) that the Stimpmeter's ball rolls on the
/// level after it left with 1.83 m/s (6 ft/s). USGA, Stimpmeter instruction booklet (the speed from memory).
CAROM_API double rolling_of_stimp(double stimp);

struct Bounce {
  BallState after{};
  bool slides = false;        ///< the impulse of friction reached μ J_n
  double normal_impulse = 0;  ///< N·s
  Vec3d tangent_impulse{};    ///< N·s
};
/// Grip, slip and tangential restitution (Garwin, Am. J. Phys. 37 (1969) 88; Brody, Phys. Teach. 22 (1984) 494; Cross,
/// Am. J. Phys. 70 (2002) 482): J/m = clip((1 + e_x) s β/(1 + β), μ (1 + e) |v_n|) against the slip s of the point of
/// contact; soft ground by its lean (A. R. Penner, Can. J. Phys. 80 (2002) 931). `normal` is a unit vector out of the
/// ground. A ball that leaves already is not changed.
CAROM_API Bounce bounce(const Ball& ball, const Surface& surface, Vec3d normal, const BallState& before);

/// The ground at a place.
struct Ground {
  double height = 0;      ///< m
  Vec3d normal{0, 1, 0};  ///< unit
  Surface surface{};
};
/// What lies at (x, z).
using GroundAt = core::FunctionRef<Ground(double x, double z)>;

struct PlayLimits {
  double time = 120;  ///< s
  int bounces = 60;
  double roll_speed = 0.3;    ///< m/s: a ball that would leave the ground slower than this stays on it and rolls
  double rest_speed = 0.005;  ///< m/s
  double tolerance = 1e-8;
};
/// A shot from the start until the ball rests: flights, bounces, and the last roll.
class CAROM_API Shot {
 public:
  enum class Phase : std::uint8_t { flight, roll, rest };
  struct Contact {
    double time = 0;
    BallState before{}, after{};
    bool slides = false;
  };
  BallState at(double time) const;
  Phase phase_at(double time) const;
  double duration() const { return end_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  const BallFlight& first_flight() const { return legs_.front().path; }
  double roll_time() const { return roll_start_; }  ///< s, when the last roll began; the duration where it never did
  BallState rest() const { return at(end_); }

 private:
  friend core::Result<Shot> play(const Ball&, const Conditions&, const BallState&, GroundAt, const PlayLimits&);
  struct Leg {
    double start = 0;
    Phase phase = Phase::flight;
    BallFlight path{};
  };
  std::vector<Leg> legs_;
  std::vector<Contact> contacts_;
  double end_ = 0, roll_start_ = 0;
};

/// Flies, bounces and rolls a ball over a ground. A ball that comes to roll first skids until the point of contact
/// rests: with friction μ it loses slip at (1 + 1/β) μ g. On a slope it follows the fall line by g sin θ/(1 + β).
/// Errors: a ball, a surface or a start that cannot be.
CAROM_API core::Result<Shot> play(const Ball& ball, const Conditions& conditions, const BallState& start,
                                  GroundAt ground, const PlayLimits& limits = {});
/// The same over level ground of one kind.
CAROM_API core::Result<Shot> play(const Ball& ball, const Conditions& conditions, const BallState& start,
                                  const Surface& surface, const PlayLimits& limits = {});

}  // namespace carom::sports
