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
/// angular momentum and the kinetic energy stay the same to rounding (an energy–momentum method, after Simo & Wong,
/// Int. J. Numer. Meth. Eng. 31, 1991). In body axes the momentum m turns by −θ into m₁, with θ = ½h I⁻¹(m + m₁): what
/// a rotation changes is at right angles to its axis, so (m₁ − m)·I⁻¹(m₁ + m) = 0, which is twice the change of energy.
/// Uniform spin turns by exactly h ω. Newton's method finds θ, because the fixed point alone diverges for a thin rod.
/// Inertia in body axes. In double, because a body near its intermediate axis feels every rounding. Returns the turn in
/// the body's frame.
inline Quatf torque_free_turn(const Mat3f& inertia, const Quatf& q, float h, Vec3d& angular_velocity) {
  const auto turned = [](const Vec3d& angle) {
    const Vec3d y = 0.5 * angle;
    const double yy = dot(y, y);
    const Vec3d t = y * ((105 - 10 * yy) / (105 - 45 * yy + yy * yy));
    const double s = 1 / math::sqrt(1 + dot(t, t));
    return Quatd{s, s * t};
  };
  const Quatd attitude = normalize(Quatd(q));
  const double scale = double(inertia.cx.x), half = 0.5 * double(h);  // positive for every body that turns
  const Mat3d tensor = Mat3d(inertia) / scale;
  const Vec3d w = inverse_rotate(attitude, angular_velocity), m = tensor * w;
  const double enough = 1e-28 * half * half * dot(m, m);
  Vec3d angle = double(h) * w, turned_m = m;
  Quatd r;
  for (int i = 0; i < 8; ++i) {
    r = turned(angle);
    turned_m = inverse_rotate(r, m);
    const Vec3d error = tensor * angle - half * (m + turned_m);
    if (dot(error, error) <= enough) break;
    // Moving the angle by δ turns m₁ by J δ more, J the right Jacobian of the exponential map (its series).
    const double aa = dot(angle, angle);
    const double b = 0.5 - aa * (1.0 / 24 - aa * (1.0 / 720)), c = 1.0 / 6 - aa * (1.0 / 120 - aa * (1.0 / 5040));
    const auto column = [&](const Vec3d& axis, const Vec3d& of_tensor) {
      const Vec3d first = cross(angle, axis), second = cross(angle, first);
      return of_tensor - half * cross(turned_m, axis - b * first + c * second);
    };
    const Mat3d slope{column({1, 0, 0}, tensor.cx), column({0, 1, 0}, tensor.cy), column({0, 0, 1}, tensor.cz)};
    angle -= inverse(slope) * error;
  }
  angular_velocity = rotate(attitude * r, inverse(tensor) * turned_m);
  return Quatf(r);
}

}  // namespace carom::rigid::detail
