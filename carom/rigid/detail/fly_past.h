// What flies past another at a distance, told before their surfaces are asked: by the balls about two shapes on their
// straight ways, and by the ball about one and the box about the other.
#pragma once

#include "carom/geometry/hull.h"
#include "carom/rigid/detail/contacts.h"

namespace carom::rigid::detail {

/// The ball about a shape from one time to another; world axes, both of a pair seen from one place.
struct BallWay {
  Vec3f from{}, way{};  ///< m, of its middle
  Quatf rotation{};     ///< of the shape, at the beginning
  float radius = 0;     ///< m
  float stray = 0;      ///< m by which the middle may leave the straight way
  float turned = 0;     ///< m by which a turn of the shape moves its surface about the middle
};

/// The box about a shape in its own frame. False: too many parts, or no end.
inline bool box_about(const geometry::Shape3& shape, geometry::Bounds3f& box) {
  Vec3f half;
  switch (shape.type) {
    case geometry::ShapeType3::sphere:
      half = Vec3f{1, 1, 1} * shape.sphere.radius;
      break;
    case geometry::ShapeType3::box:
      half = shape.box.half_extents + Vec3f{1, 1, 1} * shape.box.radius;
      break;
    case geometry::ShapeType3::capsule:
      half = Vec3f{0, shape.capsule.half_length, 0} + Vec3f{1, 1, 1} * shape.capsule.radius;
      break;
    case geometry::ShapeType3::hull:
      box = geometry::grow(shape.hull->bounds, shape.hull->radius);
      return true;
    default:
      if (!is_convex(shape)) return false;
      box = geometry::bounds(shape, {});
      return true;
  }
  box = {-half, half};
  return true;
}

/// Does the line from middle − d to middle + d miss the box |x| ≤ half? Separating axes, of which there are six.
inline bool line_misses_box(const Vec3f& middle, const Vec3f& d, const Vec3f& half) {
  const Vec3f m = abs(middle), a = abs(d);
  if (m.x > half.x + a.x || m.y > half.y + a.y || m.z > half.z + a.z) return true;
  const Vec3f c = abs(cross(middle, d));
  return c.x > half.y * a.z + half.z * a.y || c.y > half.z * a.x + half.x * a.z || c.z > half.x * a.y + half.y * a.x;
}

inline bool has_inside(const geometry::Shape3& s) { return is_convex(s) || s.type == geometry::ShapeType3::compound; }

/// Do two shapes stay farther apart than `slack` (m, ≥ 1 mm) on their ways? False where that is not seen at a glance.
inline bool fly_past(const geometry::Shape3& a, const geometry::Shape3& b, const BallWay& way_a, const BallWay& way_b,
                     float slack) {
  if (!has_inside(a) || !has_inside(b)) return false;
  const Vec3f half_way = (way_b.way - way_a.way) * 0.5f, middle = way_b.from - way_a.from + half_way;
  const float more = slack + way_a.stray + way_b.stray, length_squared = math::length_squared(half_way);
  const float f = length_squared > 0 ? clamp(-dot(middle, half_way) / length_squared, -1.0f, 1.0f) : 0.0f;
  const float apart = way_a.radius + way_b.radius + more;
  if (math::length_squared(middle + half_way * f) > apart * apart) return true;
  const auto past_box = [&](const geometry::Shape3& shape, const BallWay& own, float radius, float sign) {
    geometry::Bounds3f box;
    if (shape.type == geometry::ShapeType3::sphere || !box_about(shape, box)) return false;
    // From the middle of the ball about the shape, which is that of its box too or its origin.
    const float reach = radius + more + own.turned;
    const Vec3f center = shape.type == geometry::ShapeType3::hull ? Vec3f{} : box.center();
    return line_misses_box(inverse_rotate(own.rotation, middle * sign) - center, inverse_rotate(own.rotation, half_way),
                           box.extents() + Vec3f{reach, reach, reach});
  };
  return past_box(a, way_a, way_b.radius, 1) || past_box(b, way_b, way_a.radius, -1);
}

}  // namespace carom::rigid::detail
