// Pairs that were apart are not looked at again before their bodies can have come near: per contact a few numbers, read
// in a row, instead of poses and shapes.
#pragma once

#include "carom/rigid/detail/contact_store.h"

namespace carom::rigid::detail {

/// How far a body has come; asked twice for every contact, so there is nothing more in it.
struct BodyPath {
  double way = 0;     ///< m, summed: of the body's origin, and path_lever · outer extent for every radian of turn
  float reach = 0;    ///< m: how far the surface can come in this step by the velocity it has; 0 for who sleeps
  float turning = 0;  ///< m/s: speed of the farthest surface by the spin
};
inline constexpr float path_lever = 3;

/// Where a body was when its path was last followed.
template <class D>
struct PathEnd {
  typename D::Pose pose{};
  float outer_extent = 0;  ///< m
  bool known = false;
};

/// While the ways of both bodies and their reach stay below the limit, the test by which update_contact leaves a
/// contact without manifolds as it is (its `motion` against its gap) cannot fail. So this changes no result and may be
/// forgotten at any time.
struct ContactWatch {
  std::int32_t body[2] = {none, none};
  float cap = 0;      ///< m: more than that is not looked ahead
  double limit = -1;  ///< m; −1: look at it
};
inline constexpr float most_slack = 1e3f;  ///< m

inline bool still_apart(const std::vector<BodyPath>& paths, const ContactWatch& w) {
  if (w.limit < 0) return false;
  const BodyPath &a = paths[std::size_t(w.body[0])], &b = paths[std::size_t(w.body[1])];
  return a.way + b.way + double(min(a.reach + b.reach, w.cap)) < w.limit;
}

inline float chord(const Rot2f& a, const Rot2f& b) {
  const Vec2f d{b.c - a.c, b.s - a.s};
  return math::length(d);
}
inline float chord(const Quatf& a, const Quatf& b) { return 2 * math::length((conjugate(a) * b).vector()); }

}  // namespace carom::rigid::detail
