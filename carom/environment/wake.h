// The lee of an obstacle, and the vortices behind a wing, in their simplest form.
#pragma once

#include <initializer_list>

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

/// A house, a tower, a windmill: downwind of it the wind is slower by a bell whose lost momentum is the obstacle's
/// drag, ∫ ρ u (U − u) dA = ½ ρ C_D A U². With s the bell's width over d = √(4A/π): (U − u)/U = (1 − √(1 − C_D/(8 s²)))
/// exp(−r²/(2 s² d²)), s = growth·x/d + s₀. After M. Bastankhah and F. Porté-Agel, Renewable Energy 70 (2014) 116–123
/// (of wind turbines), eqs. 5 and 7. Beyond about two d it is right; nearer the flow turns round and the model only
/// shelters.
struct Obstacle {
  math::Vec3d center{};           ///< m, the middle of its front
  double area = 1;                ///< m², > 0, across the wind
  double drag_coefficient = 1.1;  ///< > 0
  double growth = 0.04;           ///< of the bell's width per metre: .03 over sea … .08 in rough air
};

/// What is left of the wind at a point behind the obstacle: 1 outside the lee, 0 where none is left. `direction` is the
/// unit vector of the undisturbed wind.
inline double lee_factor(const Obstacle& obstacle, math::Vec3d direction, math::Vec3d point) {
  const math::Vec3d from = point - obstacle.center;
  const double x = math::dot(from, direction);
  if (!(x > 0)) return 1;
  const double d = math::sqrt(4 * obstacle.area / math::pi);
  // The bell begins as narrow as its momentum allows.
  const double least = math::sqrt(0.125 * obstacle.drag_coefficient);
  const double s = obstacle.growth * x / d + math::max(0.25, least * 1.02);
  const double r2 = math::max(0.0, math::length_squared(from) - x * x) / (2 * s * s * d * d);
  if (r2 > 40) return 1;
  const double deficit = 1 - math::sqrt(math::max(0.0, 1 - obstacle.drag_coefficient / (8 * s * s)));
  return 1 - deficit * math::exp(-r2);
}

/// Two vortices that trail behind a wing and sink together: v_θ = Γ/(2π r) · r²/(r² + r_c²) (Burnham and Hallock 1982).
struct WakeVortexPair {
  math::Vec3d point{};             ///< m: midway between the cores, anywhere along them, at time 0
  math::Vec3d direction{1, 0, 0};  ///< unit vector of the flight that left them, horizontal
  double circulation = 400;        ///< m²/s of each: W/(ρ V b₀)
  double spacing = 40;             ///< m between the cores, b₀ = π/4 of the span
  double core_radius = 2;          ///< m
  double decay_time = 120;         ///< s in which the circulation falls to 1/e
};
/// The pair's part of the wind (m/s) at a place and time: down between the cores, up outside.
inline math::Vec3d wake_vortices_at(const WakeVortexPair& pair, math::Vec3d point, double time) {
  const double sink = pair.circulation / (2 * math::pi * pair.spacing);  // of the pair, at full strength
  const double fade = math::exp(-math::max(time, 0.0) / pair.decay_time);
  const double fallen = sink * pair.decay_time * (1 - fade);
  const math::Vec3d right = math::cross(pair.direction, math::Vec3d{0, 1, 0});
  const math::Vec3d from = point - pair.point;
  const double across = math::dot(from, right), up = from.y + fallen;
  math::Vec3d wind{};
  for (const double side : {1.0, -1.0}) {  // seen from behind the port core turns clockwise, the starboard one against
    const double dx = across - side * 0.5 * pair.spacing, r2 = dx * dx + up * up;
    const double rate = side * pair.circulation * fade / (2 * math::pi * (r2 + pair.core_radius * pair.core_radius));
    wind += rate * (dx * math::Vec3d{0, 1, 0} - up * right);
  }
  return wind;
}

}  // namespace carom::environment
