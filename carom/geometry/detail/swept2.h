// A convex core of the plane on its way.
#pragma once

#include "carom/geometry/detail/motion.h"
#include "carom/geometry/detail/rounded2.h"

namespace carom::geometry::detail {

/// Of a core that stands at `local` in what moves.
inline Swept<Vec2d> swept(const Rounded2& c, const Motion2& motion, const Transform2f& local = {}) {
  if (!motion.turns()) return {};
  const Vec2f middle = center_of(c);
  float most = 0;
  for (int i = 0; i < c.count; ++i) most = max(most, length_squared(c.v[i] - middle));
  return {Vec2d(transform_point(local, middle)) - motion.local_center, math::sqrt(double(most))};
}

/// The distance of two cores, for `advance`: remembers the last closest points.
struct CoreGap2 {
  const Rounded2 &a, &b;
  const Motion2 &motion_a, &motion_b;
  Transform2f local_a{};  ///< of the core in what moves
  CoreDistance2 last{};
  Vec2d origin{};  ///< from which the last points are seen

  double operator()(double t, Vec2d& n) {
    origin = motion_a.c0 + motion_a.way * t;
    last = core_distance(placed(a, in_float(motion_a.at(t, origin)) * local_a),
                         placed(b, in_float(motion_b.at(t, origin))));
    n = Vec2d(last.normal);
    return double(last.distance) - double(a.radius) - double(b.radius);
  }
};

}  // namespace carom::geometry::detail
