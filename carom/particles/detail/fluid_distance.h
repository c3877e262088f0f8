// Signed distances to shapes, for the cut cells of a fluid: negative inside.
#pragma once

#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"

namespace carom::particles::detail {

/// m, in the shape's frame. Exact outside of convex shapes but hulls, cones and ellipsoids (there a lower bound near
/// edges, exact at the surface). What has no inside (segments, meshes, voxel grids) counts as a sheet of `thickness` to
/// each side; chains and height fields as solid behind, six thicknesses deep.
float signed_distance(const geometry::Shape2& shape, math::Vec2f point, float thickness);
float signed_distance(const geometry::Shape3& shape, math::Vec3f point, float thickness);

}  // namespace carom::particles::detail
