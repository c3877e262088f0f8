// How a joint row answers an error C and a speed v: Δλ = −m (velocity·v + previous·v₋ + position·C) − memory·λ.
// v₋ is the speed at the end of the last substep.
// Rigid rows are stiff springs of the world's joint frequency, implicit in time, with a relaxing second pass (Catto,
// "Solver2D", 2024). Springs that a user asks for follow the exact motion instead.
// Tried and left out: softening rigid rows toward a share of the last step's impulse. Sag shrinks by that share, but
// chains of twenty links jitter from a share of .3 and fly apart at .8 with joints at a quarter of the substep rate.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/definitions.h"

namespace carom::rigid::detail {

struct Response {
  float velocity = 1;  ///< share of the relative velocity that is removed
  float position = 0;  ///< 1/s
  float memory = 0;    ///< share of the last impulse that is given back
  float previous = 0;  ///< share of the last substep's speed that is removed
};

/// The velocity is removed and nothing else: what the relaxing pass does to a rigid row.
inline constexpr Response velocity_only{};

/// A spring of `hertz` and `damping_ratio`, by implicit Euler: stable for any stiffness, but it damps.
inline Response implicit_response(float hertz, float damping_ratio, float h) {
  const float omega = 2 * pi_f * hertz;
  const float a1 = 2 * damping_ratio + h * omega;
  const float a2 = h * omega * a1;
  const float a3 = 1 / (1 + a2);
  return {a2 * a3, h * omega * omega * a3, a3};
}

struct ExactSpring {
  double determinant = 1;   ///< d
  double stiffness = 0;     ///< 1 + d − t
  double static_share = 1;  ///< (1 + d − t)/(ω h)²
};

inline Response exact_response(const ExactSpring& e, double h) {
  // v' = v* − (1 − d)(w v* + (1 − w) v₋) − β x, with v* = v₋ + what other forces gave in h. Without them the mean does
  // not matter; with them w must be such that a lasting force F rests at F/k: 1 − (1 − d) w = β/(ω² h).
  const double removed = 1 - e.determinant, now = 1 - e.static_share;
  return {float(now), float(e.stiffness / h), float(e.static_share), float(removed - now)};
}

/// The spring whose discrete motion is the exact one. With x' = x + h v' and v' = α v − β x the map has determinant α
/// and trace 1 − hβ + α; a damped oscillator moves with determinant d = e^(−2ζωh) and trace t = 2 e^(−ζωh) cos(ω_d h)
/// (cosh above critical damping), so α = d and β = (1 + d − t)/h. Frequency, decay and the place of rest are then exact
/// for every h. Undamped rows are explicit, so that several of them on one light body would run away when each turns
/// through more than about a radian in h: from ωh = 0.7 on the row goes over to implicit Euler, wholly at ωh = 1.4.
inline Response spring_response(float hertz, float damping_ratio, float h) {
  const double omega = 2 * pi * double(hertz), zeta = double(damping_ratio), angle = omega * double(h);
  const Response implicit = implicit_response(hertz, damping_ratio, h);
  if (!(angle > 0)) return {0, 0, 1, 0};
  if (angle >= 1.4) return implicit;
  const double decay = math::exp(-zeta * angle);
  double trace;
  if (zeta <= 1) {
    trace = 2 * decay * math::cos(angle * math::sqrt(1 - zeta * zeta));
  } else {
    const double fast = angle * math::sqrt(zeta * zeta - 1);
    trace = math::exp(-zeta * angle + fast) + math::exp(-zeta * angle - fast);
  }
  // 1 + d − t is a difference of nearly equal numbers for soft springs; in double nine digits remain.
  const double stiffness = 1 + decay * decay - trace;
  const Response exact = exact_response({decay * decay, stiffness, stiffness / (angle * angle)}, double(h));
  const float blend = clamp((float(angle) - 0.7f) / 0.7f, 0.0f, 1.0f);
  return {lerp(exact.velocity, implicit.velocity, blend), lerp(exact.position, implicit.position, blend),
          lerp(exact.memory, implicit.memory, blend), lerp(exact.previous, 0.0f, blend)};
}

/// The same for a spring of stiffness k (N/m) and damping c (N·s/m) that moves `mass` (kg).
inline Response spring_response_of(double stiffness, double damping, double mass, float h) {
  if (!(mass > 0)) return {0, 0, 1, 0};
  if (!(stiffness > 0)) {  // a damper alone: v' = v e^(−c h/m), and F/c under a lasting force F
    const double z = damping * double(h) / mass, d = math::exp(-z);
    return exact_response({d, 0, z > 1e-9 ? (1 - d) / z : 1}, double(h));
  }
  const double omega = math::sqrt(stiffness / mass);
  return spring_response(float(omega / (2 * pi)), float(damping / (2 * mass * omega)), h);
}

}  // namespace carom::rigid::detail
