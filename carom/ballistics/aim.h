// Taking aim: where to point a barrel so that a projectile with drag, in wind, from a moving shooter, meets a moving
// target (chapter 18.2).
//
// For a flight time T there is one initial velocity u(T) that brings the projectile to the target's place at T; the
// barrel gives it where |u(T) − v_shooter| is the muzzle speed. The solver finds the roots of that function of T: the
// earliest is the low arc, the latest the high one, and where there is no root there is no solution, and it says so.
#pragma once

#include <optional>
#include <vector>

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
  double tolerance = 3e-3;    ///< m, how far from the target's place a shot may pass
  bool high_arc = true;       ///< false: only the earliest hit is looked for, in a fraction of the time
};

/// Both ways to hit a target that keeps its acceleration. On one core of a server: the low arc alone 2 to 8 µs, both
/// 7 to 20 µs, a target out of reach, at rest or in flight, 4 to 20 µs; one at the very edge of reach 20 to 45 µs, one
/// with several arcs 30 to 80 µs. Errors: a field that is not finite, a muzzle speed ≤ 0.
CAROM_API core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                                 const Target& target, const AimOptions& options = {});

/// The same for any motion of the target, its position (m) by the time since firing (s): the earliest and the latest
/// hit in the longest time that is not a passing touch of less than a hundredth of it. A target that stays slower than
/// half of what drag leaves of a shot's speed takes as long as one that keeps its acceleration; a faster one 6 µs for
/// the low arc, 17 for both, several times that where it weaves for long just out of reach. It is asked for its place
/// some 150 to 1 000 times, and what it does between two looks (sixty-four, closer together at first) is taken to be
/// no faster than what it does at them.
CAROM_API core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                                 core::FunctionRef<math::Vec3d(double)> target, const AimOptions& options = {});

/// The way to hit that lies close to `last`, the shot of the frame before or one of a table (AimTable): about 4 µs on
/// a low arc. Empty where Newton's method does not lead there: ask `aim`.
CAROM_API core::Result<std::optional<Shot>> aim_again(const Projectile& projectile, const Conditions& conditions,
                                                      const Shooter& shooter, const Target& target, const Shot& last,
                                                      const AimOptions& options = {});

/// Compass-like angles of a direction: elevation above the horizon, azimuth from x toward z (rad).
struct Laying {
  double elevation = 0, azimuth = 0;
};
inline Laying laying(math::Vec3d direction) {
  return {math::atan2(direction.y, math::hypot(direction.x, direction.z)), math::atan2(direction.z, direction.x)};
}

/// How finely, and how far, an AimTable knows its weapon.
struct AimTableDef {
  double muzzle_speed = 100;                            ///< m/s
  double longest_range = 1000;                          ///< m
  double least_elevation = -0.5, most_elevation = 1.5;  ///< rad
  int ranges = 96, elevations = 160;                    ///< at most 1024 each
};
/// (range, height) → (elevation, time) of one weapon in still air, for a hundred shooters that need an answer in half a
/// microsecond: one flight for every elevation, made once. Between its nodes it errs by about a ten-thousandth of the
/// range; `aim_again` makes an answer exact, with wind and moving shooters.
class CAROM_API AimTable {
 public:
  /// Errors: a number that cannot be, named; a flight that cannot be integrated.
  static core::Result<AimTable> make(const Projectile& projectile, const Conditions& conditions,
                                     const AimTableDef& definition);
  struct Entry {
    double elevation = 0;  ///< rad
    double time = 0;       ///< s
  };
  struct Entries {
    std::optional<Entry> low{}, high{};
  };
  /// A point at horizontal distance `range` and `height` above the muzzle (m). Empty: no solution, or outside the
  /// table.
  Entries at(double range, double height) const;
  /// Shots at a moving target, by four looks at where it will be; `velocity` of the shot is not told. The velocity of
  /// the shooter is taken from the target's.
  Aims aim(const Shooter& shooter, const Target& target) const;
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node); }

 private:
  struct Node {
    float height = 0, slope = 0, time = 0;  // m, dy/dx, s where the shot passes that range; time < 0: it does not
  };
  AimTableDef definition_{};
  std::vector<Node> nodes_;  // by range, then by elevation
};

}  // namespace carom::ballistics
