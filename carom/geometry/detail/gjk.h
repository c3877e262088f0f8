// Closest points of two convex cores, and the depth of their overlap, in double.
#pragma once

#include "carom/geometry/detail/convex.h"

namespace carom::geometry::detail {

/// A placed core: its pose in the frame of computation.
struct Placed {
  const Convex* core;
  Mat3d rotation{};
  Vec3d position{};

  explicit Placed(const Convex& c) : core(&c) {}
  Placed(const Convex& c, const Transform3f& t) : Placed(c, Transform3d{Vec3d(t.p), Quatd(t.q)}) {}
  Placed(const Convex& c, const Transform3d& t) : core(&c), rotation(to_matrix(normalize(t.q))), position(t.p) {}
  Vec3d support(Vec3d d) const { return rotation * detail::support(*core, d * rotation) + position; }
  Vec3d center() const { return rotation * Vec3d(inner_point(*core)) + position; }
};

class OffDirections;
class PlacedCorners;

struct SimplexVertex {
  Vec3d w, a, b;  ///< w = b − a
};
struct CoreDistance {
  bool overlap = false;
  double distance = 0;  ///< m, of the cores, without their radii
  Vec3d point_a{}, point_b{};
  Vec3d normal{};  ///< unit, from A to B
  int count = 0;   ///< of the last simplex
  RawArray<SimplexVertex, 4> simplex;
};
/// Gilbert, Johnson & Keerthi 1988. Stops early, with a lower bound as the distance and no points, once the cores are
/// known to be farther apart than `cutoff`. `guess` is a direction from A to B to begin with (zero: the centres').
void core_distance(const Placed& a, const Placed& b, double cutoff, Vec3d guess, CoreDistance& out);

/// The same for cores within `radii`, with a lower bound as the distance and no points as soon as it keeps these more
/// than `near` apart and by at least `share` of what does.
void core_clearance(const Placed& a, const Placed& b, double radii, double near, double share, Vec3d guess,
                    CoreDistance& out);

/// The same for a triangle and corners that are placed already. False, and all else unknown, where these keep off.
/// `beyond`: bits of the edges on which the nearest point of the triangle lies; 0: anywhere, or the two meet.
bool triangle_distance(const Vec3d (&corner)[3], const PlacedCorners& b, Vec3d toward_b, double cutoff, int beyond,
                       OffDirections& off, CoreDistance& out);

/// The same for a triangle and a segment (or a point, twice) in closed form. False where they touch, or the triangle is
/// none.
bool triangle_segment_distance(const Vec3d (&corner)[3], Vec3d from, Vec3d to, double cutoff, CoreDistance& out);

/// For cores that overlap (from the simplex of core_distance): the shortest translation that parts them, by the
/// expanding polytope algorithm (van den Bergen 2001). distance ≤ 0. False where the difference body is flat.
bool core_depth(const Placed& a, const Placed& b, CoreDistance& inout);

}  // namespace carom::geometry::detail
