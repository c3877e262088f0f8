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
/// so has no drift of energy. Inertia in body axes. In double, because a body near its intermediate axis feels every
/// rounding. Returns the turn in the body's frame.
inline Quatf torque_free_turn(const Mat3f& inertia, const Quatf& q, float h, Vec3d& angular_velocity) {
  const auto turned = [](const Vec3d& angle) {
    const Vec3d y = 0.5 * angle;
    const double yy = dot(y, y);
    const Vec3d t = y * ((105 - 10 * yy) / (105 - 45 * yy + yy * yy));
    const double s = 1 / math::sqrt(1 + dot(t, t));
    return Quatd{s, s * t};
  };
  const Quatd attitude = normalize(Quatd(q));
  const double scale = double(inertia.cx.x);  // positive for every body that turns
  const Mat3d tensor = Mat3d(inertia) / scale, inverse_tensor = inverse(tensor);
  const Vec3d w = inverse_rotate(attitude, angular_velocity), momentum = tensor * w;
  Vec3d middle = w;
  for (int i = 0; i < 5; ++i) middle = inverse_tensor * inverse_rotate(turned((0.5 * double(h)) * middle), momentum);
  const Quatd r = turned(double(h) * middle);
  angular_velocity = rotate(attitude * r, inverse_tensor * inverse_rotate(r, momentum));
  return Quatf(r);
}

}  // namespace carom::rigid::detail
