// Manifolds and rays of any shape of either dimension: what characters and the adviser ask of geometry.
#pragma once

#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/manifold.h"
#include "carom/geometry/query.h"

namespace carom::rigid::detail {

/// Which point of a manifold that has any lies deepest; how deep (m, below 0), or how far apart it is.
template <class Manifold>
int deepest_point(const Manifold& m) {
  int deepest = 0;
  for (int k = 1; k < m.count; ++k)
    if (m.points[k].separation < m.points[deepest].separation) deepest = k;
  return deepest;
}
template <class Manifold>
float smallest_separation(const Manifold& m) {
  return m.points[deepest_point(m)].separation;
}

/// Of shapes of many parts, those are looked at which come within `around` (m) of a straight way in a's frame.
template <class Vector>
struct Around {
  Vector way{};
  float around = 0;
  template <class Bounds>
  Bounds along(const Bounds& box) const {
    return geometry::grow(merge(box, Bounds{box.low + way, box.high + way}), around);
  }
};

/// Calls f for every manifold of the convex shape b with a; normals point from a to b, in a's frame. Returns how far
/// (m) they are known to be from each other: 0 where they meet, or it was not told.
template <class F>
float for_manifolds(const geometry::Shape2& a, const geometry::Shape2& b, const math::Transform2f& b_in_a, float margin,
                    const Around<math::Vec2f>& near, F&& f) {
  const auto one = [&](const geometry::Shape2& part) {
    geometry::PairCache cache;
    geometry::Manifold2 m;
    geometry::collide(part, b, b_in_a, margin, cache, m);
    if (m.count > 0) f(m);
    return m.count == 0 && m.points[0].separation > margin ? m.points[0].separation : 0.0f;
  };
  if (a.type != geometry::ShapeType2::chain) return one(a);
  const geometry::Bounds2f box = near.along(geometry::bounds(b, b_in_a));
  for (int i = 0; i < a.chain->segment_count(); ++i) {
    const geometry::ChainSegment s = a.chain->segment(i);
    if (geometry::overlaps(geometry::Bounds2f{min(s.a, s.b), max(s.a, s.b)}, box)) one(geometry::Shape2(s));
  }
  return 0;
}
template <class F>
float for_manifolds(const geometry::Shape3& a, const geometry::Shape3& b, const math::Transform3f& b_in_a, float margin,
                    const Around<math::Vec3f>& near, F&& f) {
  if (geometry::is_convex(a) || a.type == geometry::ShapeType3::plane) {
    geometry::PairCache cache;
    geometry::Manifold3 m;
    geometry::collide(a, b, b_in_a, margin, cache, m);
    if (m.count > 0) f(m);
    return m.count == 0 && m.points[0].separation > margin ? m.points[0].separation : 0.0f;
  }
  geometry::Manifold3 many[16];
  const geometry::Bounds3f box = near.along(geometry::bounds(b, b_in_a));
  const int count = geometry::is_surface(a) ? geometry::detail::collide_surface(a, b, b_in_a, margin, box, many)
                                            : geometry::collide_many(a, b, b_in_a, margin, many);
  for (int i = 0; i < count; ++i) f(many[i]);
  return 0;
}

inline geometry::CastHit2 ray_into(const geometry::Shape2& shape, math::Vec2f origin, math::Vec2f way) {
  return geometry::ray_cast(shape, origin, way);
}
inline geometry::CastHit3 ray_into(const geometry::Shape3& shape, math::Vec3f origin, math::Vec3f way) {
  return geometry::ray_cast(shape, origin, way);
}

}  // namespace carom::rigid::detail
