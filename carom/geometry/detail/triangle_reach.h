// Which triangles of a surface a convex shape may meet: told by a few planes, before anything is asked about the shape.
#pragma once

#include "carom/geometry/detail/off_directions.h"
#include "carom/math/mat.h"

namespace carom::geometry::detail {

/// Bounds in the shape's own frame.
inline Bounds3f own_bounds(const Shape3& shape) {
  if (shape.type == ShapeType3::box) {
    const Vec3f half = shape.box.half_extents + shape.box.radius * Vec3f{1, 1, 1};
    return {-half, half};
  }
  return shape.type == ShapeType3::hull ? grow(shape.hull->bounds, shape.hull->radius) : bounds(shape, {});
}

/// What a triangle must reach to be worth a look: in front of it the shape's middle, near its plane and its sides, and
/// in the shape's own frame its box, which fits closer than the one in the surface's frame.
struct TriangleReach {
  Vec3f middle{}, axis[3]{}, origin{};
  Bounds3f own{};
  float around = 0;  ///< m from the middle; of a ball or capsule, from its line
  Vec3f end{};       ///< of the line, from the middle
  Vec3f box_middle{}, half[3]{};
  const PlacedCorners& corners;
  const ShapeWay& approach;
  float radius = 0;
  bool line = false, solid = false;

  TriangleReach(const Shape3& shape, const Convex& core, const PlacedCorners& placed, const Transform3f& x,
                float margin, const ShapeWay& goes, bool below)
      : middle(transform_point(x, inner_point(core))),
        origin(x.p),
        own(grow(own_bounds(shape), margin)),
        box_middle(transform_point(x, own.center())),
        corners(placed),
        approach(goes),
        radius(core.radius),
        solid(below) {
    line = core.kind == CoreKind::point || core.kind == CoreKind::segment;
    if (corners.known()) {
      middle -= origin;
      around = 1.0001f * (core.radius + margin) + 1e-6f * (length(origin) + length(max(abs(own.low), abs(own.high))));
      if (corners.has_faces()) return;  // the rest is not asked for
    }
    const Mat3f turn = to_matrix(x.q);
    axis[0] = turn.cx, axis[1] = turn.cy, axis[2] = turn.cz;
    if (corners.known()) return;
    const Vec3f at = inner_point(core), extents = 1.0001f * own.extents();
    for (int k = 0; k < 3; ++k) half[k] = extents[k] * axis[k];
    if (line) end = core.half.y * axis[1];
    around = 1.0001f * (line ? core.radius + margin : length(max(abs(own.low - at), abs(own.high - at))));
  }
  /// How far (m, times the length of the normal) all of the line stands above a plane, or all of the box.
  float line_height(Vec3f normal, Vec3f corner) const { return dot(normal, middle - corner) - abs(dot(normal, end)); }
  float box_height(Vec3f normal, Vec3f corner) const {
    return dot(normal, box_middle - corner) - abs(dot(normal, half[0])) - abs(dot(normal, half[1])) -
           abs(dot(normal, half[2]));
  }
  bool meets(const Vec3f (&corner)[3], OffDirections& off) const {
    if (corners.known()) {
      const Vec3f p = corner[0] - origin, q = corner[1] - origin, r = corner[2] - origin;
      return near_corners(p, q, r, off);
    }
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
    return solid || in_box(corner[0] - origin, corner[1] - origin, corner[2] - origin);
  }

 private:
  bool in_box(Vec3f p, Vec3f q, Vec3f r) const {
    for (int k = 0; k < 3; ++k) {
      const float a = dot(axis[k], p), b = dot(axis[k], q), c = dot(axis[k], r);
      if (min(a, min(b, c)) > own.high[k] || max(a, max(b, c)) < own.low[k]) return false;
    }
    return true;
  }
  /// Does all of the shape, which lies this far along a direction, stay out of reach as it goes on?
  bool keeps_off(float height, Vec3f direction, float level) const {
    const float most = approach.margin + approach.bend + radius, size = most * most * length_squared(direction);
    if (!(height > 0) || height * height <= size) return false;
    const float then = corners.least_then(direction) - level;
    return then > 0 && then * then > size;
  }
  /// By the corners themselves; p, q, r are seen from the origin of the shape.
  bool near_corners(Vec3f p, Vec3f q, Vec3f r, OffDirections& off) const {
    if (off.keeps_off(p, q, r)) return false;
    const Vec3f edge[3] = {q - p, r - q, p - r}, start[3] = {p, q, r}, normal = cross(edge[0], edge[1]);
    const float level = dot(normal, p);
    if (!solid && dot(normal, middle) < level) return false;
    const float above = max(corners.least(normal) - level, 0.0f), size = length_squared(normal), most = around * around;
    if (above * above > most * size || keeps_off(above, normal, level)) {
      off.learn(normal, p, q, r);
      return false;
    }
    for (int e = 0; e < 3; ++e) {
      // Above the plane and beside an edge of it: both are parts of the distance.
      const Vec3f outward = cross(edge[e], normal);
      const float beside = corners.least(outward) - dot(outward, start[e]);
      if (!(beside > 0)) continue;
      const float length = length_squared(outward);
      if (beside * beside * size + above * above * length > most * size * length ||
          keeps_off(beside, outward, dot(outward, start[e]))) {
        off.learn(outward, p, q, r);
        return false;
      }
    }
    if (solid) return true;
    if (!corners.has_faces()) return in_box(p, q, r);
    // In front of a face of the shape.
    const PlacedCorners::Before face = corners.face_before(p, q, r);
    const float most_before = approach.margin + approach.bend + radius;
    if (face.distance > around) {
      off.learn(-face.normal, p, q, r);
      return false;
    }
    return !(face.distance > most_before && off.learn(-face.normal, p, q, r));
  }
};

}  // namespace carom::geometry::detail
