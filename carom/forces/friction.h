// Dry friction and rolling (chapter 3.3).
#pragma once

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

/// The friction force (N) on a body that is pressed with N (N) and otherwise pushed along the surface by `push` (N)
/// while it moves along the surface with `velocity` (m/s). At rest it holds against the push up to μ_s N.
template <class V>
inline V friction_force(double static_coefficient, double kinetic_coefficient, double normal_force, V push, V velocity,
                        double rest_speed = 1e-9) {
  if (!(normal_force > 0)) return V{};
  const double speed = math::length(velocity);
  if (speed > rest_speed) return velocity * (-kinetic_coefficient * normal_force / speed);
  const double size = math::length(push);
  if (size <= static_coefficient * normal_force) return -push;
  return push * (-kinetic_coefficient * normal_force / size);
}

/// A block on a plane inclined by `angle` (rad) stays iff tan θ ≤ μ_s.
CAROM_API bool stays_on_incline(double angle, double static_coefficient);
/// Acceleration (m/s²) down the incline of a sliding block: g (sin θ − μ_k cos θ).
CAROM_API double incline_acceleration(double angle, double kinetic_coefficient, double gravity);
/// Of a body that rolls without slipping: g sin θ/(1 + I/(m r²)). `shape_factor` = I/(m r²): 2/5 solid sphere, 1/2
/// solid cylinder, 2/3 spherical shell, 1 hoop.
CAROM_API double rolling_acceleration(double angle, double shape_factor, double gravity);
/// The least μ_s that lets it roll: tan θ · k/(1 + k).
CAROM_API double rolling_friction_needed(double angle, double shape_factor);

}  // namespace carom::forces
