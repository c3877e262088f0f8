// Turning by h·ω without trigonometric functions, and torque-free rotation.
#pragma once

#include "carom/rigid/detail/solver_body.h"

namespace carom::rigid::detail {

/// tan(y)/y by the continued fraction of the tangent, as a function of y²: error below 10⁻⁵ for |y| ≤ 1.25.
inline float tangent_over_angle(float yy) { return (105 - 10 * yy) / (105 - 45 * yy + yy * yy); }
inline constexpr float max_turn = 2.5f;  ///< rad in a substep; faster bodies are slowed to this

inline Rot2f turn(float angle) {
  const float y = 0.5f * angle, t = y * tangent_over_angle(y * y);
  const float s = 1 / (1 + t * t);
  return {(1 - t * t) * s, 2 * t * s};
}
inline Quatf turn(const Vec3f& angle) {
  const Vec3f y = 0.5f * angle;
  const Vec3f t = y * tangent_over_angle(dot(y, y));
  const float s = 1 / math::sqrt(1 + dot(t, t));
  return {s, s * t};
}

/// Torque-free rotation of a body for the time h: attitude q and angular velocity (world axes), such that the world's
/// angular momentum stays the same to rounding. Implicit midpoint on the rotation group, which is symmetric in time and
/// so has no drift of energy. `inertia` and `inverse_inertia` in body axes. Returns the turn in the body's frame.
inline Quatf torque_free_turn(const Mat3f& inertia, const Mat3f& inverse_inertia, const Quatf& q, float h, Vec3f& angular_velocity) {
  const Vec3f w = inverse_rotate(q, angular_velocity);
  const Vec3f momentum = inertia * w;
  Vec3f middle = w;
  for (int i = 0; i < 3; ++i) middle = inverse_inertia * inverse_rotate(turn((0.5f * h) * middle), momentum);
  const Quatf r = turn(h * middle);
  angular_velocity = rotate(q * r, inverse_inertia * inverse_rotate(r, momentum));
  return r;
}

}  // namespace carom::rigid::detail
