// Pairs that have nothing new to tell are passed over: per contact one packed record, read in a row, instead of the
// contact, its shapes and its manifolds.
#pragma once

#include "carom/rigid/detail/contact_store.h"

namespace carom::rigid::detail {

/// How far a body may come in this step by the velocity it has. A row of four floats, which lanes transpose.
template <class D>
struct alignas(16) BodySweep {
  typename D::Vector way{};  ///< m, of its centre; 0 for who sleeps
  float turning = 0;         ///< m, of its farthest surface by the spin
};
inline constexpr float most_turning = 100.0f;  ///< m/s of a surface that are looked ahead

/// How far a turn moves a point one metre from the axis, at most.
inline float chord(const Rot2f& a, const Rot2f& b) {
  const Vec2f d{b.c - a.c, b.s - a.s};
  return math::length(d);
}
inline float chord(const Quatf& a, const Quatf& b) { return 2 * math::length((conjugate(a) * b).vector()); }

/// While it holds, update_contact would leave the contact as it is: without manifolds, because the shapes are still
/// apart, or with those of an earlier step, because they hardly slid. So it changes no result and may be forgotten at
/// any time.
template <class D>
struct ContactWatch {
  std::int32_t body[2] = {none, none};  ///< none: look at it
  typename D::Transform base{};         ///< the body of B seen from that of A, when it was looked at
  typename D::Vector normal{};  ///< in A's body; apart: along which they are, or zero; recycled: of the first manifold
  typename D::Vector middle{};  ///< m, in B's body: about it its shape turns
  float extent = 0;             ///< m: how far a turn of B by one radian moves its surface about that
  float gap = 0;       ///< m, apart: what is left until the shapes are of interest; recycled: less than 0 is close
  float most_way = 0;  ///< m, with the turn, where there is a normal; recycled: across it
  float cap = 0;  ///< m, apart: more than that is not looked ahead; recycled: below zero, as far as the gap may close
  [[no_unique_address]] RecordRest<D::dimension == 3 ? 1 : 0> rest;
};

}  // namespace carom::rigid::detail
