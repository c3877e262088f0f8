// Turning by h·ω without trigonometric functions, and torque-free rotation.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/detail/solver_body.h"

namespace carom::rigid::detail {

/// tan(y)/y by the continued fraction of the tangent, as a function of y²: error below 10⁻⁵ for |y| ≤ 1.25.
inline float tangent_over_angle(float yy) { return (105 - 10 * yy) / (105 - 45 * yy + yy * yy); }
inline constexpr float max_turn = 2.5f;             ///< rad in a substep; faster bodies are slowed to this
inline constexpr float least_spin_squared = 1e-4f;  ///< (rad/s)²: below it precession is not worth its cost
/// rad: a torque-free turn beyond it is none, Newton's method went astray (or to infinity).
inline constexpr float greatest_free_turn = 3.0f;

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

/// Rad by which a body turned in a step that ends with the turn `so_far`, where it may have turned more than half a
/// revolution: the number of whole ones is that which the angular velocity makes likely.
inline float whole_turn(const Rot2f& so_far, float spin, float dt) {
  const float angle = math::atan2(so_far.s, so_far.c), revolution = 2 * float(math::pi);
  return angle + revolution * math::floor((spin * dt - angle) / revolution + 0.5f);
}
inline Vec3f whole_turn(const Quatf& so_far, const Vec3f& spin, float dt) {
  const Quatf q = so_far.w < 0 ? -so_far : so_far;
  const float sine = length(q.vector()), revolution = 2 * float(math::pi);
  const Vec3f axis = sine > 1e-3f ? q.vector() / sine : normalize(spin);
  const float angle = sine > 1e-3f ? 2 * math::atan2(sine, q.w) : 0;
  return axis * (angle + revolution * math::floor((dot(spin, axis) * dt - angle) / revolution + 0.5f));
}
/// The rotation by an angle of any size.
inline Rot2f rotation_by(float angle) { return {math::cos(angle), math::sin(angle)}; }
inline Quatf rotation_by(const Vec3f& angle) {
  const float size = length(angle);
  if (!(size > 0)) return {};
  return {math::cos(0.5f * size), angle * (math::sin(0.5f * size) / size)};
}

/// Torque-free rotation of a body for the time h: attitude q and angular velocity (world axes), such that the world's
/// angular momentum and the kinetic energy stay the same to rounding (an energy–momentum method, after Simo & Wong,
/// Int. J. Numer. Meth. Eng. 31, 1991). In body axes the momentum m turns by −θ into m₁, with θ = ½h I⁻¹(m + m₁): what
/// a rotation changes is at right angles to its axis, so (m₁ − m)·I⁻¹(m₁ + m) = 0, which is twice the change of energy.
/// Uniform spin turns by exactly h ω. Newton's method finds θ, because the fixed point alone diverges for a thin rod.
/// Inertia in body axes. Returns the turn in the body's frame. In double for free bodies, because one near its
/// intermediate axis feels every rounding; in float, to seven digits, for those that constraints turn too.
template <class T>
Quatf torque_free_turn(const Mat3f& inertia, const Quatf& q, float h, math::Vec3<T>& angular_velocity) {
  using V = math::Vec3<T>;
  using M = math::Mat3<T>;
  constexpr T precision = sizeof(T) == 8 ? T(1e-28) : T(1e-12);  // squared
  const auto turned = [](const V& angle) {
    const V y = T(0.5) * angle;
    const T yy = dot(y, y);
    const V t = y * ((105 - 10 * yy) / (105 - 45 * yy + yy * yy));
    const T s = 1 / math::sqrt(1 + dot(t, t));
    return math::Quat<T>{s, s * t};
  };
  const math::Quat<T> attitude = normalize(math::Quat<T>(q));
  const T scale = T(inertia.cx.x), half = T(0.5) * T(h);  // positive for every body that turns
  const M tensor = M(inertia) / scale;
  const V w = inverse_rotate(attitude, angular_velocity), m = tensor * w;
  const T enough = precision * half * half * dot(m, m);
  V angle = T(h) * w, turned_m = m;
  math::Quat<T> r;
  M inverse_slope{};
  T last = 0;
  for (int i = 0; i < 12; ++i) {
    r = turned(angle);
    turned_m = inverse_rotate(r, m);
    const V error = tensor * angle - half * (m + turned_m);
    const T size = dot(error, error);
    if (size <= enough) break;
    // A slope serves as long as it makes each error 64 times smaller: it costs more than two looks at the error.
    const bool serves = i > 0 && size * T(4096) < last;
    last = size;
    if (serves) {
      angle -= inverse_slope * error;
      continue;
    }
    // Moving the angle by δ turns m₁ by J δ more, J the right Jacobian of the exponential map (its series).
    const T aa = dot(angle, angle);
    const T b = T(0.5) - aa * (T(1.0 / 24) - aa * T(1.0 / 720)),
            c = T(1.0 / 6) - aa * (T(1.0 / 120) - aa * T(1.0 / 5040));
    const auto column = [&](const V& axis, const V& of_tensor) {
      const V first = cross(angle, axis), second = cross(angle, first);
      return of_tensor - half * cross(turned_m, axis - b * first + c * second);
    };
    const M slope{column({1, 0, 0}, tensor.cx), column({0, 1, 0}, tensor.cy), column({0, 0, 1}, tensor.cz)};
    inverse_slope = inverse(slope);
    angle -= inverse_slope * error;
  }
  if (!(dot(angle, angle) < T(greatest_free_turn * greatest_free_turn))) return Quatf(turned(T(h) * w));
  angular_velocity = rotate(attitude * r, inverse(tensor) * turned_m);
  return Quatf(r);
}

}  // namespace carom::rigid::detail
