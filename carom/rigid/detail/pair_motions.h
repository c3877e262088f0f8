// How pairs that are looked at have moved, as many at a time as there are lanes.
#pragma once

#include "carom/rigid/detail/body_store.h"
#include "carom/rigid/detail/contact_watch.h"

namespace carom::rigid::detail {

/// By lane, what pair_motion.inl tells of one contact.
template <class D>
struct PairMotions {
  static constexpr int capacity = 16, N = D::dimension;
  const ContactRecord<D>* contact[capacity];
  const typename D::Transform* local[2][capacity];  ///< by side: shape → body
  float middle[N][capacity];                        ///< m, in B's shape: about it that turns
  /// In space, m, of a hull that turns far less about its long axis: half the extents of its bounds, and its radius.
  /// Of other shapes `no_box` and 0.
  float box[3][capacity], rounding[capacity];
  static constexpr float no_box = 1e15f;
  float extent[capacity];  ///< m per radian that B turns from here, Moved::extent; found in space, told in the plane

  // Found:
  alignas(16) float b_in_a[capacity][N == 2 ? 4 : 8];  ///< begins with a Transform
  float way[N][capacity], turn[capacity];              ///< m, Moved::way and turn
  float ahead[capacity];                               ///< m, how far the surfaces may come nearer in this step
  float sweep_way[N][capacity], sweep_turn[capacity];  ///< m, a BodySweep of B's shape, where bodies turn far
};

/// Bits by lane, of pairs without manifolds of which something was known.
struct KnownApart {
  std::uint32_t stays = 0;   ///< all of it is still true
  std::uint32_t slides = 0;  ///< they slid far past each other, but the axis that was between them still is
};

/// How far pairs that are apart along an axis may move until it is looked at whether their bounds still meet: a share
/// of half the thickness of the thinner.
template <class D>
inline constexpr float longest_slide = D::dimension == 2 ? 1.0f : 0.5f;

/// Bodies that turn by more than that share of half the thickness of the thinner are asked how their shapes go.
inline constexpr float far_turn = 0.1f;

/// What bodies a kernel of pairs reads: by slot.
template <class D>
struct MovingBodies {
  const typename D::Pose* poses;
  const BodySweep<D>* sweeps;
  const SolverBody<D>* velocities;
  const BodyMotion<D>* motion;
};

}  // namespace carom::rigid::detail
