// Relativistic time: what a fast or deep clock shows (chapter 1.9 of the subject). SI units; speeds below c.
#pragma once

#include <limits>

#include "carom/math/vec.h"

namespace carom::math {

inline constexpr double speed_of_light = 299792458.0;  ///< m/s, exact (SI)

/// γ = 1/√(1 − v²/c²); infinite at c, NaN above.
inline double lorentz_factor(double speed) {
  const double beta = speed / speed_of_light;
  const double s = (1 - beta) * (1 + beta);
  return s < 0 ? std::numeric_limits<double>::quiet_NaN() : 1 / math::sqrt(s);
}
/// γ − 1 without cancellation at everyday speeds: β²/(1 − β² + √(1 − β²)).
inline double lorentz_factor_minus_one(double speed) {
  const double beta = speed / speed_of_light;
  const double s = (1 - beta) * (1 + beta);
  return s < 0 ? std::numeric_limits<double>::quiet_NaN() : beta * beta / (s + math::sqrt(s));
}
/// Time that passes at rest while a moving clock shows `proper_time`: Δt = γ Δτ.
inline double time_dilation(double proper_time, double speed) { return lorentz_factor(speed) * proper_time; }
/// Time that a moving clock shows while `time` passes at rest (the travelling twin's).
inline double proper_time(double time, double speed) { return time / lorentz_factor(speed); }
/// Length along the motion of an object that is `rest_length` long at rest: L = L₀/γ.
inline double length_contraction(double rest_length, double speed) { return rest_length / lorentz_factor(speed); }

/// Speed seen at rest of what moves with u inside a frame that moves with v along the same line: (u + v)/(1 + uv/c²).
inline double add_velocities(double v, double u) { return (u + v) / (1 + (u / speed_of_light) * (v / speed_of_light)); }
/// The same in space (Møller): u is seen in the frame that moves with v, |v| < c.
inline Vec3d add_velocities(Vec3d v, Vec3d u) {
  const Vec3d b = v / speed_of_light;
  const double beta2 = dot(b, b), gamma = 1 / math::sqrt(1 - beta2), along = dot(b, u);
  // u/γ + v + (γ/(1 + γ)) (β·u) β, over 1 + β·u/c.
  return (u / gamma + v + b * (along * gamma / (1 + gamma))) / (1 + along / speed_of_light);
}

/// dτ/dt − 1 of a clock at rest at distance r from a mass with G M = mu, against one far away: −mu/(r c²) (weak field).
constexpr double gravitational_clock_rate(double mu, double r) { return -mu / (r * speed_of_light * speed_of_light); }
/// dτ/dt − 1 of a clock that moves with `speed`, to second order in v/c: −v²/2c².
constexpr double velocity_clock_rate(double speed) {
  return -0.5 * (speed / speed_of_light) * (speed / speed_of_light);
}
/// Both together.
constexpr double clock_rate(double mu, double r, double speed) {
  return gravitational_clock_rate(mu, r) + velocity_clock_rate(speed);
}
/// How much faster (seconds per second) a clock on a circular orbit of radius r runs than one at rest at ground_radius.
constexpr double orbit_clock_rate(double mu, double r, double ground_radius) {
  // v² = mu/r, so the velocity term is half the gravitational one.
  return 1.5 * gravitational_clock_rate(mu, r) - gravitational_clock_rate(mu, ground_radius);
}

}  // namespace carom::math
