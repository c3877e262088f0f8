// Rising air: a thermal as gliders meet it.
#pragma once

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

/// Warm air that rises in the middle and sinks round it: w = W (27/4) ζ (1 − ζ)² (1 − r²/R²) exp(−r²/R²) with ζ the
/// height over the depth of the mixed layer. Over the ground it draws air in and spreads it at the top so that no air
/// is made or lost; the sum of what rises and sinks at any height is zero. The section is that of J. Gedeon, "Dynamic
/// analysis of dolphin-style thermal cross-country flight", OSTIV (1973).
struct Thermal {
  math::Vec3d base{};   ///< m, its foot on the ground
  double strength = 3;  ///< m/s, W: the fastest rise, a third up
  double radius = 100;  ///< m, R > 0: where rise turns to sink
  double depth = 1000;  ///< m, > 0, from the ground to the inversion
  math::Vec3d lean{};   ///< m/m: how far the column stands downwind for every metre of height (y unused)
};

/// The thermal's part of the wind at a point (m/s).
inline math::Vec3d thermal_at(const Thermal& thermal, math::Vec3d point) {
  const double height = point.y - thermal.base.y, zeta = height / thermal.depth;
  if (!(zeta > 0) || zeta >= 1) return {};
  const double x = point.x - thermal.base.x - thermal.lean.x * height;
  const double z = point.z - thermal.base.z - thermal.lean.z * height;
  const double q = (x * x + z * z) / (thermal.radius * thermal.radius);
  if (q > 40) return {};
  const double bell = math::exp(-q), shape = 6.75 * zeta * (1 - zeta) * (1 - zeta);
  const double slope = 6.75 * (1 - zeta) * (1 - 3 * zeta) / thermal.depth;
  const double up = thermal.strength * shape * (1 - q) * bell;
  // Continuity: (1/r) ∂(r u_r)/∂r = −∂w/∂y gives u_r = −½ W f′ r e^(−r²/R²), carried along by the lean.
  const double in = -0.5 * thermal.strength * slope * bell;
  return {in * x + up * thermal.lean.x, up, in * z + up * thermal.lean.z};
}

/// The thermal of a day with the convective velocity scale w* (m/s) and mixed layer z_i (m), as at a third of the
/// layer: mean updraft w* ζ^⅓ (1 − 1.1 ζ), peak about 1.5 of it, r = .102 ζ^⅓ (1 − .25 ζ) z_i. M. J. Allen, "Updraft
/// model for development of autonomous soaring uninhabited air vehicles", AIAA 2006-1510, after Lenschow & Stephens
/// 1980.
inline Thermal thermal_of_day(math::Vec3d base, double convective_velocity, double mixed_layer) {
  constexpr double zeta = 1.0 / 3, root = 0.69336127435063470;  // ζ^⅓
  Thermal thermal;
  thermal.base = base;
  thermal.strength = 1.5 * convective_velocity * root * (1 - 1.1 * zeta);
  thermal.radius = math::max(10.0, 0.102 * root * (1 - 0.25 * zeta) * mixed_layer);
  thermal.depth = mixed_layer;
  return thermal;
}

}  // namespace carom::environment
