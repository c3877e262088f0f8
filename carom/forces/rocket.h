// Variable mass (chapter 6.4).
#pragma once

#include "carom/math/elementary.h"

namespace carom::forces {

/// T = ṁ v_e (N): kg/s, m/s.
constexpr double rocket_thrust(double mass_flow, double exhaust_speed) { return mass_flow * exhaust_speed; }
/// Δv = v_e ln(m₀/m₁). Tsiolkovsky.
inline double rocket_delta_v(double exhaust_speed, double initial_mass, double final_mass) {
  return exhaust_speed * math::log(initial_mass / final_mass);
}
/// Height (m) at the end of a vertical burn of `time` s from rest in uniform gravity:
/// v_e t − ½ g t² − v_e (m₁/ṁ) ln(m₀/m₁).
inline double rocket_burnout_height(double exhaust_speed, double initial_mass, double mass_flow, double time,
                                    double gravity) {
  const double final_mass = initial_mass - mass_flow * time;
  return exhaust_speed * time - 0.5 * gravity * time * time -
         exhaust_speed * (final_mass / mass_flow) * math::log(initial_mass / final_mass);
}

}  // namespace carom::forces
