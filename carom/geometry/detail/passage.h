// How far a convex shape may go before it passes another: what continuous collision asks. A time of impact alone would
// stop all that touches; here only what would come out on the other side, or so deep that contacts cannot mend it well,
// is stopped.
#pragma once

#include "carom/geometry/query.h"

namespace carom::geometry::detail {

template <class Shape, class Sweep>
struct Passage {
  const Shape& shape;  ///< convex
  const Sweep& sweep;
  float inner = 0;      ///< m: half the smallest thickness of the shape
  bool guarded = true;  ///< its inner parts stop at what it touches already
};
using Passage2 = Passage<Shape2, Sweep2>;
using Passage3 = Passage<Shape3, Sweep3>;

/// m before a surface, where what would pass it stands in the end
inline constexpr double stop_distance = 0.0025;

/// The fraction of its way, at most `limit`, that `a` may go past `b` of any kind but a compound; `limit` where nothing
/// stops it. Both sweeps are given in one frame.
/// - What at the end is at most shallow in `b`, and not behind it, goes all the way: contacts put it right.
/// - What else comes from outside stops where it first touches.
/// - What touches from the start, as on the ground, must not pass with its inner parts: its core (a box less 3/4 of its
///   half thickness, …) comes no nearer than a part of its thickness, and never farther than half of what is left.
/// Surfaces of triangles and segments stop only what comes from their front. By conservative advancement, with
/// separating planes to be done early: what at its end is above a supporting plane of `b` has not passed.
float free_fraction(const Passage2& a, const Shape2& b, const Sweep2& b_sweep, float limit);
float free_fraction(const Passage3& a, const Shape3& b, const Sweep3& b_sweep, float limit);

/// Bounds of all places of a shape in a sweep, in the sweep's frame.
Bounds2f swept_bounds(const Shape2& shape, const Sweep2& sweep);
Bounds3f swept_bounds(const Shape3& shape, const Sweep3& sweep);

/// The same motion, of a shape that stands at `local` in what moves.
template <class Sweep, class Transform>
Sweep sweep_of_part(const Sweep& s, const Transform& local) {
  return {inverse_rotate(local.q, s.local_center - local.p), s.c0, s.c1, s.q0 * local.q, s.q1 * local.q};
}

}  // namespace carom::geometry::detail
