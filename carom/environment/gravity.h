// Gravity: from uniform to an oblate Earth (chapter 3.2). All are accelerations in m/s².
#pragma once

#include "carom/math/vec.h"

namespace carom::environment {

inline constexpr double standard_gravity = 9.80665;          ///< m/s², by definition
inline constexpr double gravitational_constant = 6.674e-11;  ///< m³/(kg·s²)
inline constexpr double earth_gm = 3.986004418e14;           ///< m³/s², WGS-84
inline constexpr double earth_mean_radius = 6371000.0;       ///< m

/// g(h) = g₀ (R/(R + h))². h in m above the radius R.
constexpr double gravity_at_height(double height, double surface_gravity = standard_gravity,
                                   double radius = earth_mean_radius) {
  const double ratio = radius / (radius + height);
  return surface_gravity * ratio * ratio;
}

/// −GM r/|r|³ for V = Vec2d or Vec3d; within `minimum_radius` the pull stays as strong as there, and is zero at r = 0.
template <class V>
inline V spherical_gravity(V r, double gm, double minimum_radius = 0) {
  const double distance = math::length(r);
  if (!(distance > 0)) return V{};
  const double bounded = math::max(distance, minimum_radius);
  return r * (-gm / (bounded * bounded) / distance);
}

/// Newton's law between two masses (kg) `distance` m apart: N.
constexpr double gravitational_force(double mass_1, double mass_2, double distance) {
  return gravitational_constant * mass_1 * mass_2 / (distance * distance);
}

/// A point mass with the second zonal harmonic; z is the axis of rotation, r from the centre (m).
/// Source: the gradient of U = −GM/r [1 − J₂ (a/r)² (3 sin²φ − 1)/2].
struct ZonalGravity {
  double gm = earth_gm;             ///< m³/s²
  double radius = 6378137.0;        ///< m, equatorial, the a above
  double j2 = 1.08262982136857e-3;  ///< WGS-84: −C̄₂₀ √5
};
inline math::Vec3d zonal_gravity(math::Vec3d r, const ZonalGravity& body = {}) {
  const double r2 = math::length_squared(r);
  if (!(r2 > 0)) return {};
  const double distance = math::sqrt(r2);
  const double k = 1.5 * body.j2 * body.radius * body.radius / r2, s = 5 * r.z * r.z / r2;
  const double pull = -body.gm / (r2 * distance);
  return {pull * r.x * (1 + k * (1 - s)), pull * r.y * (1 + k * (1 - s)), pull * r.z * (1 + k * (3 - s))};
}

}  // namespace carom::environment
