// Impulses of impacts as closed forms (chapter 5). The engine's solver is checked against these.
#pragma once

#include "carom/math/mat.h"

namespace carom::forces {

/// One side of an impact. A mass or inertia that cannot move has the inverse 0.
struct ImpactBody3 {
  double inverse_mass = 0;                            ///< 1/kg
  math::Mat3d inverse_inertia = math::Mat3d::zero();  ///< 1/(kg·m²), world axes
  math::Vec3d arm{};                                  ///< m, from the centre of mass to the point of impact
  math::Vec3d velocity{};                             ///< m/s, of the centre of mass
  math::Vec3d angular_velocity{};                     ///< rad/s
};
struct ImpactBody2 {
  double inverse_mass = 0;
  double inverse_inertia = 0;
  math::Vec2d arm{};
  math::Vec2d velocity{};
  double angular_velocity = 0;
};

/// Two particles on one line (5.2): J = (1 + e)(v₁ − v₂)/(1/m₁ + 1/m₂), v₁' = v₁ − J/m₁, v₂' = v₂ + J/m₂.
struct DirectImpact {
  double impulse, velocity_1, velocity_2;
};
constexpr DirectImpact direct_impact(double mass_1, double mass_2, double velocity_1, double velocity_2,
                                     double restitution) {
  const double impulse = (1 + restitution) * (velocity_1 - velocity_2) / (1 / mass_1 + 1 / mass_2);
  return {impulse, velocity_1 - impulse / mass_1, velocity_2 + impulse / mass_2};
}

/// Velocity of the point of impact of body 1 relative to that of body 2.
constexpr math::Vec3d impact_velocity(const ImpactBody3& a, const ImpactBody3& b) {
  return a.velocity + math::cross(a.angular_velocity, a.arm) - b.velocity - math::cross(b.angular_velocity, b.arm);
}
constexpr math::Vec2d impact_velocity(const ImpactBody2& a, const ImpactBody2& b) {
  return a.velocity + math::cross(a.angular_velocity, a.arm) - b.velocity - math::cross(b.angular_velocity, b.arm);
}

/// 1/m₁ + 1/m₂ + n·((I₁⁻¹(r₁×n))×r₁) + n·((I₂⁻¹(r₂×n))×r₂), 1/kg: what an impulse along n has to move.
constexpr double inverse_effective_mass(const ImpactBody3& a, const ImpactBody3& b, math::Vec3d n) {
  const math::Vec3d turn_a = math::cross(a.inverse_inertia * math::cross(a.arm, n), a.arm);
  const math::Vec3d turn_b = math::cross(b.inverse_inertia * math::cross(b.arm, n), b.arm);
  return a.inverse_mass + b.inverse_mass + math::dot(n, turn_a) + math::dot(n, turn_b);
}
constexpr double inverse_effective_mass(const ImpactBody2& a, const ImpactBody2& b, math::Vec2d n) {
  const double arm_a = math::cross(a.arm, n), arm_b = math::cross(b.arm, n);
  return a.inverse_mass + b.inverse_mass + a.inverse_inertia * arm_a * arm_a + b.inverse_inertia * arm_b * arm_b;
}

/// Gives body 1 the impulse (N·s) at its arm: Δv = J/m, Δω = I⁻¹(r × J).
constexpr void apply_impulse(ImpactBody3& body, math::Vec3d impulse) {
  body.velocity += body.inverse_mass * impulse;
  body.angular_velocity += body.inverse_inertia * math::cross(body.arm, impulse);
}
constexpr void apply_impulse(ImpactBody2& body, math::Vec2d impulse) {
  body.velocity += body.inverse_mass * impulse;
  body.angular_velocity += body.inverse_inertia * math::cross(body.arm, impulse);
}

/// What an impact did. Body 1 received `normal_impulse`·n + `tangent_impulse`, body 2 the opposite.
template <class V>
struct ImpactResult {
  double normal_impulse = 0;  ///< N·s along n, ≥ 0
  V tangent_impulse{};        ///< N·s
  bool slides = false;        ///< the cone's limit μ J_n was reached
};

/// Newton's impact along n (unit, from body 2 toward body 1) with Coulomb friction: J_n = −(1 + e) v_n / k_n, and the
/// tangential impulse that would stop the point's sliding, v_t/k_t, but at most μ J_n. k_n and k_t are taken
/// separately (the coupling between them is left out, as in the textbook formula; exact for central impacts, and for
/// spheres). Separating points get nothing. Changes both bodies.
template <class Body, class V>
inline ImpactResult<V> impact(Body& a, Body& b, V n, double restitution, double friction) {
  ImpactResult<V> result;
  const V velocity = impact_velocity(a, b);
  const double approach = math::dot(velocity, n);
  const double k_n = inverse_effective_mass(a, b, n);
  if (!(approach < 0) || !(k_n > 0)) return result;
  result.normal_impulse = -(1 + restitution) * approach / k_n;
  const V sliding = velocity - approach * n;
  const double speed = math::length(sliding);
  if (friction > 0 && speed > 0) {
    const V t = sliding / speed;
    const double k_t = inverse_effective_mass(a, b, t);
    const double stick = k_t > 0 ? speed / k_t : 0, limit = friction * result.normal_impulse;
    result.slides = stick > limit;
    result.tangent_impulse = -(result.slides ? limit : stick) * t;
  }
  const V impulse = result.normal_impulse * n + result.tangent_impulse;
  apply_impulse(a, impulse);
  apply_impulse(b, -impulse);
  return result;
}

/// Height after n bounces of a ball dropped from h: e^{2n} h.
constexpr double bounce_height(double height, double restitution, int bounces) {
  for (int i = 0; i < bounces; ++i) height *= restitution * restitution;
  return height;
}
/// Time (s) until a dropped ball has come to rest: √(2h/g)(1 + e)/(1 − e); e < 1.
inline double bounce_time(double height, double gravity, double restitution) {
  return math::sqrt(2 * height / gravity) * (1 + restitution) / (1 - restitution);
}
/// Speed of a ball (m at rest) struck centrally by a club head (M, V): (1 + e) M V/(M + m).
constexpr double struck_ball_speed(double club_mass, double ball_mass, double club_speed, double restitution) {
  return (1 + restitution) * club_mass * club_speed / (club_mass + ball_mass);
}

}  // namespace carom::forces
