// Resistance of a fluid (chapters 3.4, 6.2). V is Vec2d or Vec3d; forces in N on the body.
#pragma once

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

/// Velocity through the medium of a point at r (m, from the centre of mass) of a body that moves with v and ω.
constexpr math::Vec3d relative_velocity(math::Vec3d v, math::Vec3d omega, math::Vec3d r, math::Vec3d medium) {
  return v + math::cross(omega, r) - medium;
}
constexpr math::Vec2d relative_velocity(math::Vec2d v, double omega, math::Vec2d r, math::Vec2d medium) {
  return v + math::cross(omega, r) - medium;
}

/// F = −c v; c in N·s/m. Right for low Reynolds numbers.
template <class V>
constexpr V linear_drag(double coefficient, V relative_velocity) {
  return -coefficient * relative_velocity;
}
/// F = −½ ρ C_d A |v| v; ρ in kg/m³, A in m².
template <class V>
inline V quadratic_drag(double density, double drag_coefficient, double area, V relative_velocity) {
  return (-0.5 * density * drag_coefficient * area * math::length(relative_velocity)) * relative_velocity;
}
/// Torque −c |ω| ω; c in N·m·s²/rad².
constexpr double quadratic_angular_drag(double coefficient, double omega) {
  return -coefficient * math::abs(omega) * omega;
}
inline math::Vec3d quadratic_angular_drag(double coefficient, math::Vec3d omega) {
  return (-coefficient * math::length(omega)) * omega;
}

/// Re = ρ v d / μ; d in m, μ in Pa·s.
constexpr double reynolds_number(double density, double speed, double diameter, double viscosity) {
  return density * speed * diameter / viscosity;
}

// Drag coefficient of a smooth sphere by Reynolds number; infinite at Re = 0.
/// 24/Re: creeping flow, Re < 1. Stokes 1851.
constexpr double sphere_drag_stokes(double reynolds) { return 24.0 / reynolds; }
/// (24/Re)(1 + .15 Re^.687): Re < 1000. Schiller & Naumann 1933.
CAROM_API double sphere_drag_schiller_naumann(double reynolds);
/// One formula through the drag crisis: Re < 10⁶. F. A. Morrison, An Introduction to Fluid Mechanics, eq. 8.83 (2013).
CAROM_API double sphere_drag_morrison(double reynolds);

/// Speed and way of a straight run.
struct Run {
  double speed = 0;     ///< m/s
  double distance = 0;  ///< m
};
/// v_t = √(2mg/(ρ C_d A)).
CAROM_API double terminal_speed(double mass, double gravity, double density, double drag_coefficient, double area);
/// v = v_t tanh(g t/v_t), y = (v_t²/g) ln cosh(g t/v_t).
CAROM_API Run quadratic_fall(double terminal_speed, double gravity, double time);

/// Coasting against quadratic drag alone, a = −k v²: v = v₁/(1 + v₁ k t), s = ln(1 + v₁ k t)/k (chapter 2.3).
CAROM_API Run quadratic_coast(double initial_speed, double k, double time);
/// A ship, m v̇ = T − C v: v = T/C − (T/C − v₁)e^{−Ct/m}, and its distance (chapter 4.2). C > 0.
CAROM_API Run thrust_against_linear_drag(double mass, double thrust, double coefficient, double initial_speed,
                                         double time);

}  // namespace carom::forces
