// Which triangles of a surface a convex shape may meet: told by a few planes, before anything is asked about the shape.
#pragma once

#include "carom/geometry/detail/convex.h"
#include "carom/math/mat.h"

namespace carom::geometry::detail {

/// What a triangle must reach to be worth a look: in front of it the shape's middle, near its plane and its sides, and
/// in the shape's own frame its box, which fits closer than the one in the surface's frame.
struct TriangleReach {
  Vec3f middle{}, axis[3]{}, origin{};
  Bounds3f own{};
  float around = 0;  ///< m from the middle; of a ball or capsule, from its line
  Vec3f end{};       ///< of the line, from the middle
  Vec3f box_middle{}, half[3]{};
  bool line = false, solid = false;

  TriangleReach(const Shape3& shape, const Convex& core, const Transform3f& x, float margin, bool below)
      : middle(transform_point(x, inner_point(core))),
        origin(x.p),
        own(grow(bounds(shape, {}), margin)),
        box_middle(transform_point(x, own.center())),
        solid(below) {
    const Mat3f turn = to_matrix(x.q);
    axis[0] = turn.cx, axis[1] = turn.cy, axis[2] = turn.cz;
    const Vec3f at = inner_point(core), extents = 1.0001f * own.extents();
    for (int k = 0; k < 3; ++k) half[k] = extents[k] * axis[k];
    line = core.kind == CoreKind::point || core.kind == CoreKind::segment;
    if (line) end = core.half.y * axis[1];
    around = 1.0001f * (line ? core.radius + margin : length(max(abs(own.low - at), abs(own.high - at))));
  }
  /// How far (m, times the length of the normal) all of the line stands above a plane, or all of the box.
  float line_height(Vec3f normal, Vec3f corner) const { return dot(normal, middle - corner) - abs(dot(normal, end)); }
  float box_height(Vec3f normal, Vec3f corner) const {
    return dot(normal, box_middle - corner) - abs(dot(normal, half[0])) - abs(dot(normal, half[1])) -
           abs(dot(normal, half[2]));
  }
  bool meets(const Vec3f (&corner)[3]) const {
    const Vec3f normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float above = max(line_height(normal, corner[0]), 0.0f), size = length_squared(normal),
                most = around * around;
    if (above * above > most * size) return false;
    if (!solid && dot(normal, middle - corner[0]) < 0) return false;
    if (!line && box_height(normal, corner[0]) > 0) return false;
    for (int e = 0; e < 3; ++e) {
      const Vec3f outward = cross(corner[e == 2 ? 0 : e + 1] - corner[e], normal);
      if (!line) {
        if (box_height(outward, corner[e]) > 0) return false;
        continue;
      }
      // Above the plane and beside an edge of it: both are parts of the distance.
      const float beside = line_height(outward, corner[e]), length = length_squared(outward);
      if (beside > 0 && beside * beside * size + above * above * length > most * size * length) return false;
    }
    if (solid) return true;
    const Vec3f p = corner[0] - origin, q = corner[1] - origin, r = corner[2] - origin;
    for (int k = 0; k < 3; ++k) {
      const float a = dot(axis[k], p), b = dot(axis[k], q), c = dot(axis[k], r);
      if (min(a, min(b, c)) > own.high[k] || max(a, max(b, c)) < own.low[k]) return false;
    }
    return true;
  }
};

}  // namespace carom::geometry::detail
