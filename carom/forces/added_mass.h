// Added mass: the fluid that a body has to move along with itself when it speeds up (chapters 3.4, 3.6). Potential
// flow; H. Lamb, Hydrodynamics (6th ed. 1932), articles 71, 92, 114, 115.
#pragma once

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

/// Of a sphere: ½ ρ V (kg).
constexpr double sphere_added_mass(double density, double radius) {
  return 0.5 * density * 4.0 / 3 * math::pi * radius * radius * radius;
}
/// Of a circular cylinder across the flow, per metre: ρ π r² (kg/m).
constexpr double cylinder_added_mass(double density, double radius) { return density * math::pi * radius * radius; }
/// Of a long flat plate of width b across the flow, per metre: ρ π b²/4 (kg/m).
constexpr double plate_added_mass(double density, double width) { return density * math::pi * 0.25 * width * width; }
/// Of a disc broadside: 8/3 ρ r³ (kg).
constexpr double disc_added_mass(double density, double radius) { return 8.0 / 3 * density * radius * radius * radius; }

/// Shares of an ellipsoid: of the displaced mass along each half axis, and of the moment of inertia of the displaced
/// fluid, (m/5)(b² + c²), about each.
struct AddedShares {
  math::Vec3d linear{};
  math::Vec3d angular{};
};
/// Half axes in m, > 0. To 1e-9.
CAROM_API AddedShares ellipsoid_added_mass(math::Vec3d half_axes);

/// How a body of mass m that displaces `displaced` kg of fluid starts from rest: (m − displaced) g/(m +
/// share·displaced), downward (m/s²).
constexpr double sinking_acceleration(double mass, double displaced, double share, double gravity) {
  return (mass - displaced) * gravity / (mass + share * displaced);
}

}  // namespace carom::forces
