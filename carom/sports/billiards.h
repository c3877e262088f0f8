// Balls on a cloth: what they are made of, how they move by themselves, and how they strike each other and the bed
// (chapter 19.3–19.8).
//
// The frame: y up, the bed of the table at y = 0, its length along x. A ball on the bed has its centre at y = R.
// Between two events a ball's path is a polynomial: sliding and flying balls move on parabolas, rolling ones on
// straight lines. Laws of motion: W. C. Marlow, "The Physics of Pocket Billiards" (1995); D. G. Alciatore, technical
// proofs TP 4.1, 4.2, A.4 (billiards.colostate.edu). Impacts: Alciatore TP A.14; S. Mathavan, M. R. Jackson, R. M.
// Parkin, "Numerical simulations of the frictional collisions of solid balls on a rough surface", Sports Engineering 17
// (2014).
#pragma once

#include <cstdint>
#include <limits>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/elementary.h"
#include "carom/math/vec.h"
#include "carom/sports/cushion.h"

namespace carom::sports {

/// One kind of ball; all balls on a table are alike. A uniform sphere: I = ⅖ m R².
struct BilliardBall {
  double mass = 0.170097;    ///< kg
  double radius = 0.028575;  ///< m
};

/// The bed with its cloth.
struct Cloth {
  double sliding_friction = 0.2;                ///< μ_s
  double rolling_friction = 0.01;               ///< μ_r: a rolling ball slows down by μ_r g
  double spinning_friction = 0.444 * 0.028575;  ///< μ_sp: spin about the vertical slows down by 5 μ_sp g/(2R)
  double restitution = 0.5;                     ///< of a ball that drops on the bed
  double bounce_threshold = 0.05;               ///< m/s: a ball that would leave the bed more slowly stays on it
};

/// Ball on ball.
struct BallContact {
  enum class Model : std::uint8_t {
    closed_form,  ///< Coulomb friction that ends at the latest where slip ends: Alciatore TP A.14, here for any
                  ///< restitution
    mathavan,     ///< integrated over the impulse, with the bed's friction during the impact (balls on the bed only)
  };
  Model model = Model::closed_form;
  double restitution = 0.95;
  /// μ = floor + range·exp(−rate·slip): TP A.14's fit, slip in m/s. A constant μ: {μ, 0, …}.
  double friction_floor = 0.009951, friction_range = 0.108, friction_rate = 1.088;
  double contact_time = 2.5e-4;  ///< s, how long an impact at 1 m/s lasts: only where gaps of a cluster must close
  int steps = 400;               ///< of the integrated model
};
/// μ between two balls whose surfaces slip by so much (m/s).
inline double ball_friction(const BallContact& c, double slip) {
  return c.friction_floor + (c.friction_range > 0 ? c.friction_range * math::exp(-c.friction_rate * slip) : 0);
}

/// Everything a shot depends on besides the table's outline.
struct BilliardPhysics {
  BilliardBall ball{};
  Cloth cloth{};
  BallContact balls{};
  CushionContact cushion{};
  double gravity = 9.81;  ///< m/s²
};

/// Presets (pooltool's parameter sets, E. Kiefl et al., Apache-2.0; facts only).
CAROM_API BilliardPhysics pool_physics();
CAROM_API BilliardPhysics snooker_physics();
CAROM_API BilliardPhysics carom_physics();
/// Balls of 68 mm and 285 g (rules of the pyramid); cloth and contacts as on a pool table.
CAROM_API BilliardPhysics russian_physics();
/// Names the first field that cannot be.
CAROM_API core::Status validate(const BilliardPhysics& physics);

enum class BallPhase : std::uint8_t {
  resting,  ///< it may still spin about the vertical
  rolling,  ///< without slip
  sliding,
  airborne,
  pocketed,   ///< out of play
  off_table,  ///< out of play
};
constexpr bool in_play(BallPhase phase) { return phase < BallPhase::pocketed; }

struct BilliardState {
  math::Vec3d position{};          ///< m, of the centre
  math::Vec3d velocity{};          ///< m/s
  math::Vec3d angular_velocity{};  ///< rad/s
  BallPhase phase = BallPhase::resting;
};

/// Velocity of the ball's lowest point over the cloth.
inline math::Vec3d bed_slip(const BilliardState& s, double radius) {
  return {s.velocity.x + radius * s.angular_velocity.z, 0, s.velocity.z - radius * s.angular_velocity.x};
}
/// The horizontal spin with which a ball rolls.
inline math::Vec3d rolling_spin(math::Vec3d velocity, double radius) {
  return {velocity.z / radius, 0, -velocity.x / radius};
}
/// Kinetic and potential (J), zero for a ball that rests on the bed.
CAROM_API double energy(const BilliardState& state, const BilliardPhysics& physics);

inline constexpr double never = std::numeric_limits<double>::infinity();

/// A stretch of a ball's life between two events, in closed form.
struct BilliardMotion {
  double start = 0;    ///< s
  double end = never;  ///< s, when the phase ends by itself (slip ends, comes to rest, drops on the bed)
  math::Vec3d position{}, velocity{}, half_acceleration{};
  math::Vec3d angular_velocity{}, angular_acceleration{};
  double spin_end = 0;  ///< s, when the spin about the vertical has died away
  BallPhase phase = BallPhase::resting;

  math::Vec3d position_at(double time) const {
    const double t = time - start;
    return position + t * (velocity + t * half_acceleration);
  }
  math::Vec3d velocity_at(double time) const { return velocity + (2 * (time - start)) * half_acceleration; }
  /// Exact within [start, end].
  CAROM_API BilliardState at(double time) const;
  /// The state in which the next phase begins, where this one ends by itself.
  CAROM_API BilliardState at_end(const BilliardPhysics& physics) const;
};

/// How a ball goes on from a state. What slips less than 1e-10 m/s rolls; what is slower than that rests. A ball is
/// airborne where its state says so, or where it is above the bed or leaves it.
CAROM_API BilliardMotion motion_from(const BilliardState& state, const BilliardPhysics& physics, double time);

/// Two balls strike each other. `normal` is the unit vector from the centre of a to that of b. On the bed (both balls)
/// the vertical parts of the impulses are taken up by the bed. Nothing happens where they do not approach.
/// Returns the approach speed (m/s).
CAROM_API double strike_balls(BilliardState& a, BilliardState& b, math::Vec3d normal, bool on_bed,
                              const BilliardPhysics& physics);

/// A ball reaches the bed with a velocity downward: restitution, and friction that ends at the latest where slip ends.
CAROM_API void drop_on_bed(BilliardState& state, const BilliardPhysics& physics);
/// The same where the bed gives nothing back (a ball that the cue holds down).
CAROM_API void press_on_bed(BilliardState& state, const BilliardPhysics& physics);

}  // namespace carom::sports
