// A convex core on its way.
#pragma once

#include "carom/geometry/detail/convex.h"
#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/motion.h"

namespace carom::geometry::detail {

/// The farthest point of a core from `center`.
inline double reach_about(const Convex& c, Vec3d center) {
  double most = 0;
  const auto see = [&](Vec3f p) { most = max(most, length_squared(Vec3d(p) - center)); };
  switch (c.kind) {
    case CoreKind::point:
      return math::length(center);
    case CoreKind::hull:
      for (const Vec3f& v : c.hull->vertices) see(v);
      break;
    case CoreKind::triangle:
      for (const Vec3f& v : c.corner) see(v);
      break;
    case CoreKind::segment:
    case CoreKind::box: {
      const Vec3d far = abs(center) + Vec3d(c.half);
      return math::length(far);
    }
    case CoreKind::ellipsoid:
      return max(double(c.half.x), max(double(c.half.y), double(c.half.z))) + math::length(center);
    case CoreKind::cylinder:
    case CoreKind::cone: {
      const double r = double(c.half.x) + math::sqrt(center.x * center.x + center.z * center.z);
      const double h = double(c.half.y) + math::abs(center.y);
      return math::sqrt(r * r + h * h);
    }
  }
  return math::sqrt(most);
}

/// Of a core that stands at `local` in what moves.
inline Swept<Vec3d> swept(const Convex& c, const Motion3& motion, const Transform3d& local = {}) {
  if (!motion.turns()) return {};
  const Vec3d middle(inner_point(c));
  return {transform_point(local, middle) - motion.local_center, reach_about(c, middle)};
}

/// The distance of two cores, for `advance`: remembers the last normal and closest points.
struct CoreGap {
  const Convex &a, &b;
  const Motion3 &motion_a, &motion_b;
  Transform3d local_a{};  ///< of the core in what moves
  CoreDistance last{};

  double operator()(double t, Vec3d& n) {
    const Vec3d guess = last.normal;
    core_distance(Placed(a, motion_a.at(t) * local_a), Placed(b, motion_b.at(t)), 1e30, guess, last);
    n = last.normal;
    return last.overlap ? -1.0 : last.distance - double(a.radius) - double(b.radius);
  }
};

}  // namespace carom::geometry::detail
