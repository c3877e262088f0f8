// Casts and overlaps in closed form, for the pairs that have one.
#pragma once

#include "carom/geometry/detail/convex.h"

namespace carom::geometry::detail {

/// Where a moving core first meets another.
struct Sweep {
  bool hit = false;
  double time = 0;     ///< of the way, 0…1
  Vec3d normal{};      ///< unit, outward from A; zero where they touch at the start
  Vec3d core_point{};  ///< where A's core is touched (at the start: some point of the touch)
};

/// B, placed by x, moves by `way` in A's frame, no further than `limit`. False: no closed form for this pair.
bool closed_cast(const Convex& a, const Convex& b, const Transform3f& x, Vec3d way, double limit, Sweep& out);
/// Whether A and B, placed by x, touch. False: no closed form for this pair.
bool closed_overlap(const Convex& a, const Convex& b, const Transform3f& x, bool& overlap);

}  // namespace carom::geometry::detail
