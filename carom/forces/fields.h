// Force fields (chapter 3.2): radial, vortex, electric and magnetic. V is Vec2d or Vec3d.
#pragma once

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

struct Radial {
  double strength = -10;  ///< m/s² at the reference distance; negative pulls, positive pushes
  double reference = 1;   ///< m, > 0
  double exponent = -2;   ///< of the distance
  double range = 1e30;    ///< m: nothing beyond
  double core = 1e-3;     ///< m: inside it the strength stays as at this distance
};
/// strength · (d/reference)^exponent, m/s².
CAROM_API double radial_strength(const Radial& field, double distance);
/// Acceleration (m/s²) at r from the centre (m); zero at the centre.
template <class V>
inline V radial_acceleration(const Radial& field, V r) {
  const double distance = math::length(r);
  if (!(distance > 0)) return V{};
  return r * (radial_strength(field, distance) / distance);
}

/// Rankine's vortex: speed Γ/(2π r) outside the core, solid rotation inside.
struct Vortex {
  double circulation = 10;  ///< m²/s, counterclockwise about the axis
  double core_radius = 1;   ///< m, > 0
};
constexpr double vortex_speed(const Vortex& vortex, double distance) {
  const double edge = vortex.circulation / (2 * math::pi * vortex.core_radius);
  return distance < vortex.core_radius ? edge * distance / vortex.core_radius : edge * vortex.core_radius / distance;
}
/// Velocity (m/s) of the medium at r from the centre.
inline math::Vec2d vortex_velocity(const Vortex& vortex, math::Vec2d r) {
  const double distance = math::length(r);
  return distance > 0 ? math::perpendicular(r) * (vortex_speed(vortex, distance) / distance) : math::Vec2d{};
}
/// The same about an axis (unit vector) through the centre.
inline math::Vec3d vortex_velocity(const Vortex& vortex, math::Vec3d axis, math::Vec3d r) {
  const math::Vec3d around = math::cross(axis, r);
  const double distance = math::length(around);
  return distance > 0 ? around * (vortex_speed(vortex, distance) / distance) : math::Vec3d{};
}

inline constexpr double coulomb_constant = 8.9875517862e9;  ///< N·m²/C², 1/(4πε₀) with CODATA 2022 ε₀

/// Force (N) on charge 1 (C) at r (m) from charge 2; zero where they coincide.
template <class V>
inline V coulomb_force(double charge_1, double charge_2, V r) {
  const double distance = math::length(r);
  if (!(distance > 0)) return V{};
  return r * (coulomb_constant * charge_1 * charge_2 / (distance * distance * distance));
}
/// F = q(E + v × B): C, V/m, m/s, T.
constexpr math::Vec3d lorentz_force(double charge, math::Vec3d electric, math::Vec3d velocity, math::Vec3d magnetic) {
  return charge * (electric + math::cross(velocity, magnetic));
}

}  // namespace carom::forces
