// Springs and dampers (chapters 3.7, 13.6).
#pragma once

#include "carom/math/vec.h"

namespace carom::forces {

struct Spring {
  double rest_length = 1;  ///< m
  double stiffness = 100;  ///< N/m
  double damping = 0;      ///< N·s/m along the spring
};

/// Force (N) on end a; on end b its opposite. F = −{k(|L| − r) + k_d Δv·L̂} L̂ with L = a − b. Ends that coincide have
/// no direction: no force.
template <class V>
inline V spring_damper_force(const Spring& spring, V a, V b, V velocity_a, V velocity_b) {
  const V along = a - b;
  const double length = math::length(along);
  if (!(length > 1e-12)) return V{};
  const V direction = along / length;
  const double speed = math::dot(velocity_a - velocity_b, direction);
  return -(spring.stiffness * (length - spring.rest_length) + spring.damping * speed) * direction;
}

/// M = −k_θ(θ − θ₀) − c_θ ω (N·m).
constexpr double torsion_spring(double stiffness, double damping, double angle, double rest_angle, double rate) {
  return -stiffness * (angle - rest_angle) - damping * rate;
}

/// m₁m₂/(m₁ + m₂): the mass that swings between two free ends.
constexpr double reduced_mass(double mass_1, double mass_2) { return mass_1 * mass_2 / (mass_1 + mass_2); }
/// ω = √(k/m), rad/s.
inline double spring_frequency(double stiffness, double mass) { return math::sqrt(stiffness / mass); }
/// ζ = c/(2√(k m)).
inline double damping_ratio(double damping, double stiffness, double mass) {
  return damping / (2 * math::sqrt(stiffness * mass));
}
/// The damping (N·s/m) that gives the ratio.
inline double damping_for_ratio(double ratio, double stiffness, double mass) {
  return 2 * ratio * math::sqrt(stiffness * mass);
}

}  // namespace carom::forces
