// Archimedes (chapter 3.6): volume and centre of what lies under the water, exact for the shapes of the engine.
// F = ρ g ∇ upward at the centroid of ∇. Everything in one frame, usually the body's; close to the body, for accuracy.
#pragma once

#include <span>

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

/// The water's surface near the body: under water is where dot(normal, x) < offset. `normal` (unit) points up.
struct WaterLine {
  math::Vec2d normal{0, 1};
  double offset = 0;
};
struct WaterPlane {
  math::Vec3d normal{0, 1, 0};
  double offset = 0;
};

struct Submerged2 {
  double area = 0;         ///< m²: volume per metre of depth of the plane
  math::Vec2d centroid{};  ///< m; zero where the area is zero
};
struct Submerged3 {
  double volume = 0;       ///< m³
  math::Vec3d centroid{};  ///< m; zero where the volume is zero
};

/// Any shape of the plane: a convex polygon (counterclockwise) swept by a circle of `radius`. One corner makes a
/// circle, two a capsule. A simple concave polygon works with radius 0.
CAROM_API Submerged2 submerged(std::span<const math::Vec2d> polygon, double radius, const WaterLine& water);

/// Sphere: the cap formula ∇ = π h²(3R − h)/3, exact.
CAROM_API Submerged3 submerged_sphere(math::Vec3d center, double radius, const WaterPlane& water);
/// A cap of height h (0 … 2R) of a sphere: its volume.
constexpr double spherical_cap_volume(double radius, double height) {
  return math::pi * height * height * (3 * radius - height) / 3;
}
/// Box with half extents along the axes, at the origin.
CAROM_API Submerged3 submerged_box(math::Vec3d half_extents, const WaterPlane& water);

/// A closed triangle mesh, convex or not, outward counterclockwise: exact for a plane surface.
CAROM_API Submerged3 submerged_mesh(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices,
                                    const WaterPlane& water);
/// The same under a curved surface: `depths[i]` (m) is how far vertex i lies below the surface along `up` (negative:
/// above). Within a triangle the depth is linear, so the error falls with the square of the triangles' size over the
/// wavelength.
CAROM_API Submerged3 submerged_mesh(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices,
                                    std::span<const double> depths, math::Vec3d up);

/// A solid of revolution from `base` to `top`: cone frustum with radii `base_radius` and `top_radius` (equal: cylinder;
/// one zero: cone), and, where `round_ends`, half spheres beyond both ends (capsule; equal radii). By Gauss quadrature
/// along the axis between the places where the section's wetting changes, relative error of the volume < 1e-7.
struct Revolution {
  math::Vec3d base{}, top{0, 1, 0};
  double base_radius = 0.5, top_radius = 0.5;
  bool round_ends = false;
};
CAROM_API Submerged3 submerged_revolution(const Revolution& solid, const WaterPlane& water);

/// ρ g ∇ (N) upward.
constexpr double buoyant_force(double density, double gravity, double volume) { return density * gravity * volume; }

}  // namespace carom::forces
