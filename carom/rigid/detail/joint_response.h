// How a joint row answers an error: Δλ = −m_eff (velocity·v + position·C) − memory·λ.
// Rigid rows are stiff springs of the world's joint frequency, implicit in time, with a relaxing second pass
// (Catto, "Solver2D", 2024). Springs that a user asks for follow the exact motion instead.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/definitions.h"

namespace carom::rigid::detail {

struct Response {
  float velocity = 1;  ///< share of the relative velocity that is removed
  float position = 0;  ///< 1/s
  float memory = 0;    ///< share of the last impulse that is given back
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

/// The spring whose discrete motion is the exact one. With x' = x + h v' and v' = α v − β x the map has determinant α
/// and trace 1 − hβ + α; a damped oscillator moves with determinant d = e^(−2ζωh) and trace t = 2 e^(−ζωh) cos(ω_d h)
/// (cosh above critical damping), so α = d and β = (1 + d − t)/h. Frequency and decay are then exact for every h.
/// Undamped rows are explicit, so that several of them on one light body would run away when each turns through more
/// than about a radian in h: from ωh = 0.7 on the row goes over to implicit Euler, wholly at ωh = 1.4.
inline Response spring_response(float hertz, float damping_ratio, float h) {
  const double omega = 2 * pi * double(hertz), zeta = double(damping_ratio), angle = omega * double(h);
  const Response implicit = implicit_response(hertz, damping_ratio, h);
  if (!(angle > 0)) return {0, 0, 0};
  if (angle >= 1.4) return implicit;
  const double decay = math::exp(-zeta * angle);
  double trace;
  if (zeta <= 1) {
    trace = 2 * decay * math::cos(angle * math::sqrt(1 - zeta * zeta));
  } else {
    const double fast = angle * math::sqrt(zeta * zeta - 1);
    trace = math::exp(-zeta * angle + fast) + math::exp(-zeta * angle - fast);
  }
  const double determinant = decay * decay;
  // 1 + d − t is a difference of nearly equal numbers for soft springs; in double nine digits remain.
  const Response exact{float(1 - determinant), float((1 + determinant - trace) / double(h)), float(determinant)};
  const float blend = clamp((float(angle) - 0.7f) / 0.7f, 0.0f, 1.0f);
  return {lerp(exact.velocity, implicit.velocity, blend), lerp(exact.position, implicit.position, blend),
          lerp(exact.memory, implicit.memory, blend)};
}

/// The same for a spring of stiffness k (N/m) and damping c (N·s/m) that moves `mass` (kg).
inline Response spring_response_of(double stiffness, double damping, double mass, float h) {
  if (!(mass > 0)) return {0, 0, 0};
  if (!(stiffness > 0)) {  // a damper alone: v' = v e^(−c h/m)
    const double d = math::exp(-damping * double(h) / mass);
    return {float(1 - d), 0, float(d)};
  }
  const double omega = math::sqrt(stiffness / mass);
  return spring_response(float(omega / (2 * pi)), float(damping / (2 * mass * omega)), h);
}

}  // namespace carom::rigid::detail
