// How far a ball is from a shape. A contact's manifold tells nothing beside the border of a sharp shape, where nothing
// is met yet; what comes fast is met there within the step.
#include "carom/particles/detail/nearest_surface.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/manifold.h"
#include "carom/geometry/query.h"
#include "carom/geometry/tree_walk.h"
#include "carom/math/elementary.h"

namespace carom::particles::detail {

using math::Vec3d;
using math::Vec3f;

bool nearest_plane(const geometry::Shape3& shape, Vec3f center, float radius, float margin, Vec3f& normal,
                   float& separation) {
  const geometry::Shape3 ball(geometry::Sphere{radius});
  const math::Transform3f place{center, {}};
  bool found = false;
  const auto take = [&](const geometry::Manifold3& manifold) {
    for (int k = 0; k < manifold.count; ++k)
      if (manifold.points[k].separation <= margin && (!found || manifold.points[k].separation < separation)) {
        found = true;
        separation = manifold.points[k].separation;
        normal = manifold.normal;
      }
  };
  if (is_convex(shape) || shape.type == geometry::ShapeType3::plane) {
    geometry::PairCache cache;
    geometry::Manifold3 manifold;
    geometry::collide(shape, ball, place, margin, cache, manifold);
    take(manifold);
  } else {
    geometry::Manifold3 manifolds[4];
    const int count = geometry::collide_many(shape, ball, place, margin, manifolds);
    for (int k = 0; k < count; ++k) take(manifolds[k]);
  }
  return found;
}

namespace {

struct CoreGap {
  Vec3d normal{};
  double separation = 0;  ///< m, of a point; less than 0 within
};

CoreGap from_box(Vec3d half, Vec3d p) {
  const Vec3d off = p - min(max(p, -half), half);
  const double l2 = dot(off, off);
  if (l2 > 1e-12 * dot(half, half)) {
    const double l = math::sqrt(l2);
    return {off / l, l};
  }
  const Vec3d gap = abs(p) - half;
  const int axis = gap.x >= gap.y && gap.x >= gap.z ? 0 : (gap.y >= gap.z ? 1 : 2);
  CoreGap out{{}, gap[axis]};
  out.normal[axis] = p[axis] < 0 ? -1.0 : 1.0;
  return out;
}

CoreGap from_cylinder(const geometry::Cylinder& cylinder, Vec3d p) {
  const double from_axis = math::sqrt(p.x * p.x + p.z * p.z);
  const Vec3d outward = from_axis > 0 ? Vec3d{p.x / from_axis, 0, p.z / from_axis} : Vec3d{1, 0, 0};
  const Vec3d along{0, p.y < 0 ? -1.0 : 1.0, 0};
  const double side = from_axis - double(cylinder.radius), end = math::abs(p.y) - double(cylinder.half_height);
  if (side > 0 && end > 0) {
    const double l = math::sqrt(side * side + end * end);
    return {(side * outward + end * along) / l, l};
  }
  return side >= end ? CoreGap{outward, side} : CoreGap{along, end};
}

/// Of a compound's parts the nearest.
bool nearest_part(const geometry::Compound& compound, Vec3f center, float radius, float margin, Vec3f& normal,
                  float& separation) {
  bool found = false;
  const float reach = radius + margin;
  const auto look = [&](std::uint32_t i) {
    const geometry::CompoundChild& part = compound.children[i];
    Vec3f n;
    float s = 0;
    if (nearest_surface(part.shape, transform_point(inverse(part.local), center), radius, margin, n, s) &&
        (!found || s < separation)) {
      found = true;
      normal = rotate(part.local.q, n);
      separation = s;
    }
    return true;
  };
  query(compound.tree, geometry::Bounds3f{center - Vec3f{reach, reach, reach}, center + Vec3f{reach, reach, reach}},
        look);
  return found;
}

}  // namespace

bool nearest_surface(const geometry::Shape3& shape, Vec3f center, float radius, float margin, Vec3f& normal,
                     float& separation) {
  using geometry::ShapeType3;
  if (shape.type == ShapeType3::compound)
    return nearest_part(*shape.compound, center, radius, margin, normal, separation);
  if (nearest_plane(shape, center, radius, margin, normal, separation)) return true;
  if (shape.type == ShapeType3::box || shape.type == ShapeType3::cylinder) {
    const bool box = shape.type == ShapeType3::box;
    const CoreGap gap =
        box ? from_box(Vec3d(shape.box.half_extents), Vec3d(center)) : from_cylinder(shape.cylinder, Vec3d(center));
    const float rounding = box ? shape.box.radius : shape.cylinder.rounding;
    const float beyond = float(gap.separation - double(rounding) - double(radius));
    if (beyond > margin) return false;
    normal = Vec3f(gap.normal);
    separation = beyond;
    return true;
  }
  const bool sharp = shape.type == ShapeType3::cone || shape.type == ShapeType3::hull;
  if (!sharp && shape.type != ShapeType3::mesh) return false;
  const geometry::Bounds3f tight = geometry::bounds(shape, {});
  const Vec3f off = center - min(max(center, tight.low), tight.high);
  if (dot(off, off) > math::square(radius + margin)) return false;
  const geometry::Distance3 found = geometry::distance(shape, geometry::Sphere{radius}, {center, {}});
  if (!(found.distance > 0) || found.distance > margin) return false;
  normal = found.normal;
  separation = found.distance;
  return true;
}

}  // namespace carom::particles::detail
