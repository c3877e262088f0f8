// Taking aim: where to point a barrel so that a projectile with drag, in wind, from a moving shooter, meets a moving
// target (chapter 18.2).
//
// For a flight time T there is one initial velocity u(T) that brings the projectile to the target's place at T; the
// barrel gives it where |u(T) − v_shooter| is the muzzle speed. The solver finds the roots of that function of T: the
// earliest is the low arc, the latest the high one, and where there is no root there is no solution, and it says so.
#pragma once

#include <optional>

#include "carom/ballistics/flight.h"

namespace carom::ballistics {

/// A target that keeps its acceleration. Position and velocity at the moment of firing, in the frame of the muzzle's
/// position: y up.
struct Target {
  math::Vec3d position{}, velocity{}, acceleration{};
};

struct Shooter {
  double muzzle_speed = 100;  ///< m/s, relative to the muzzle
  math::Vec3d muzzle{};       ///< m
  math::Vec3d velocity{};     ///< m/s, of the muzzle
};

/// A way to hit.
struct Shot {
  math::Vec3d direction{};  ///< of the barrel, a unit vector in the world's axes
  double time = 0;          ///< s from firing to the hit
  math::Vec3d place{};      ///< m, where it hits
  math::Vec3d velocity{};   ///< m/s, of the projectile at the hit
};

/// Empty: no solution. With one root both are the same shot.
struct Aims {
  std::optional<Shot> low{};   ///< the earliest hit
  std::optional<Shot> high{};  ///< the latest hit within the longest time
  explicit operator bool() const { return low.has_value(); }
};

struct AimOptions {
  double longest_time = 120;  ///< s
  double tolerance = 2e-3;    ///< m, how far from the target's place a shot may pass
  bool high_arc = true;       ///< false: only the earliest hit is looked for, in a fraction of the time
};

/// Both ways to hit a target that keeps its acceleration; the low arc in about 10 µs, both in 40 to
/// 400 µs, longer for flights of minutes. Errors: a field that is not
/// finite, a muzzle speed ≤ 0.
CAROM_API core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                                 const Target& target, const AimOptions& options = {});

/// The same for any motion of the target, its position (m) by the time since firing (s): every root in the longest time
/// that is not a passing touch of less than a hundredth of it; about ten times slower.
CAROM_API core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                                 core::FunctionRef<math::Vec3d(double)> target, const AimOptions& options = {});

/// Compass-like angles of a direction: elevation above the horizon, azimuth from x toward z (rad).
struct Laying {
  double elevation = 0, azimuth = 0;
};
inline Laying laying(math::Vec3d direction) {
  return {math::atan2(direction.y, math::hypot(direction.x, direction.z)), math::atan2(direction.z, direction.x)};
}

}  // namespace carom::ballistics
