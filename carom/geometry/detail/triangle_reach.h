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

/// What a triangle must reach to be worth a look, for shapes without corners: in front of it the shape's middle, near
/// its plane and its sides, and in the shape's own frame its box, which fits closer than the one in the surface's
/// frame.
struct TriangleReach {
  Vec3f middle{}, axis[3]{}, origin{};
  Vec3f judged{};  ///< what must be in front of a triangle
  Bounds3f own{};
  float around = 0;  ///< m from the middle; of a ball or capsule, from its line
  Vec3f end{};       ///< of the line, from the middle
  Vec3f box_middle{}, half[3]{};
  bool line = false, solid = false;

  TriangleReach(const Shape3& shape, const Convex& core, const Transform3f& x, float margin, Vec3f held, bool below)
      : middle(transform_point(x, inner_point(core))),
        origin(x.p),
        judged(middle + held),
        own(grow(own_bounds(shape), margin)),
        box_middle(transform_point(x, own.center())),
        solid(below) {
    line = core.kind == CoreKind::point || core.kind == CoreKind::segment;
    const Mat3f turn = to_matrix(x.q);
    axis[0] = turn.cx, axis[1] = turn.cy, axis[2] = turn.cz;
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
  bool meets(const Vec3f (&corner)[3]) const {
    const Vec3f normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float above = max(line_height(normal, corner[0]), 0.0f), size = length_squared(normal),
                most = around * around;
    if (above * above > most * size) return false;
    if (!solid && dot(normal, judged - corner[0]) < 0) return false;
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
    for (int k = 0; k < 3; ++k) {
      const float a = dot(axis[k], corner[0] - origin), b = dot(axis[k], corner[1] - origin),
                  c = dot(axis[k], corner[2] - origin);
      if (min(a, min(b, c)) > own.high[k] || max(a, max(b, c)) < own.low[k]) return false;
    }
    return true;
  }
};

/// The same for shapes with corners, a group at a time; what is off as the shape goes on does not count.
class CornersReach {
 public:
  /// `size`: m, no corner is farther from the origin.
  CornersReach(const PlacedCorners& corners, float radius, float size, float margin, Vec3f held, bool solid,
               OffDirections& off)
      : corners_(corners), off_(off), kernels_(triangle_kernels()) {
    question_.middle = corners.middle() + held;
    question_.around = 1.0001f * (radius + margin) + 1e-6f * (length(corners.origin()) + size);
    question_.keeps = off.most();
    corners.tell(shape_);
    shape_.radius = radius, shape_.solid = solid;
  }
  /// Which of the lanes may be met.
  std::uint32_t meets(const TriangleGroup& group, std::uint32_t lanes) {
    off_.tell(shape_);
    NearAnswer near;
    lanes = kernels_.near(group, lanes, shape_, question_, near);
    off_.count_uses(near.uses);
    for (int i = 0; i < near.learned; ++i) learn(group, near.lane[i], near.direction[i]);
    if (lanes == 0 || shape_.solid || !corners_.has_faces()) return lanes;
    corners_.tell_faces(shape_);
    FacesAnswer faces;
    kernels_.before_faces(group, lanes, shape_, question_, faces);
    if (faces.apart != 0) {
      const int lane = __builtin_ctz(faces.apart);
      learn(group, lane, -corners_.plane(faces.face[lane]).normal);
      lanes &= ~faces.apart;
    }
    for (std::uint32_t ahead = faces.ahead; ahead != 0; ahead &= ahead - 1) {
      const int lane = __builtin_ctz(ahead);
      if (learn(group, lane, -corners_.plane(faces.face[lane]).normal)) lanes &= ~(1u << lane);
    }
    return lanes;
  }
  /// Is one of a group off along what was learned since?
  bool keeps_off(const TriangleGroup& group, int lane) {
    return off_.keeps_off(seen(group, 0, lane), seen(group, 1, lane), seen(group, 2, lane));
  }

 private:
  Vec3f seen(const TriangleGroup& group, int c, int lane) const {
    return Vec3f{group.corner[c][0][lane], group.corner[c][1][lane], group.corner[c][2][lane]} - corners_.origin();
  }
  bool learn(const TriangleGroup& group, int lane, Vec3f direction) {
    return off_.learn(direction, seen(group, 0, lane), seen(group, 1, lane), seen(group, 2, lane));
  }

  const PlacedCorners& corners_;
  OffDirections& off_;
  const TriangleKernels& kernels_;
  PlacedShape shape_{};
  NearQuestion question_{};
};

}  // namespace carom::geometry::detail
