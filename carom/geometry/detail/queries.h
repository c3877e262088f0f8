// What the query sources share.
#pragma once

#include "carom/geometry/height_field.h"
#include "carom/geometry/query.h"

namespace carom::geometry::detail {

/// As shape_cast; hits beyond `limit` may be left out.
CAROM_API CastHit2 shape_cast_within(const Shape2& a, const Shape2& b, const Transform2f& b_in_a, Vec2f translation,
                                     float limit);
CAROM_API CastHit3 shape_cast_within(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, Vec3f translation,
                                     float limit);
/// A point that travels against a convex shape of any kind, rounded ones too.
CastHit3 cast_point(const Shape3& convex, Vec3f origin, Vec3f translation);
/// The surface's height at (x, z); false off the grid and over a hole.
bool height_at(const HeightField& field, float x, float z, float& height);
/// Is the point below a height field, or in a filled cell?
bool inside_ground(const Shape3& surface, Vec3f p);

}  // namespace carom::geometry::detail
