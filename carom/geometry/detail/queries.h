// What the query sources share.
#pragma once

#include "carom/geometry/height_field.h"
#include "carom/geometry/query.h"

namespace carom::geometry::detail {

/// A point that travels against a convex shape of any kind, rounded ones too.
CastHit3 cast_point(const Shape3& convex, Vec3f origin, Vec3f translation);
/// The surface's height at (x, z); false off the grid and over a hole.
bool height_at(const HeightField& field, float x, float z, float& height);

}  // namespace carom::geometry::detail
