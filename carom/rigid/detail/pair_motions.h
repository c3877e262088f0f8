// How pairs of the plane that are looked at have moved, as many at a time as there are lanes.
#pragma once

#include "carom/rigid/detail/body_store.h"
#include "carom/rigid/detail/contact_watch.h"

namespace carom::rigid::detail {

/// By lane, what pair_motion.inl tells of one contact.
struct PairMotions {
  static constexpr int capacity = 16;
  const ContactRecord<Dim2>* contact[capacity];
  const Transform2f* local[2][capacity];  ///< by side: shape → body
  float middle[2][capacity];              ///< m, in B's shape: about it that turns
  float extent[capacity];                 ///< m per radian of such a turn, Moved::extent

  // Found:
  alignas(16) float b_in_a[capacity][4];               ///< a Transform2f
  float way[2][capacity], turn[capacity];              ///< m, Moved::way and turn
  float ahead[capacity];                               ///< m, how far the surfaces may come nearer in this step
  float sweep_way[2][capacity], sweep_turn[capacity];  ///< m, a BodySweep of B's shape, where `swept`
  bool swept = false;
};

/// Bits by lane, of pairs without manifolds of which something was known.
struct KnownApart {
  std::uint32_t stays = 0;   ///< all of it is still true
  std::uint32_t slides = 0;  ///< they slid far past each other, but the axis that was between them still is
};

/// What bodies a kernel of pairs reads: by slot.
struct MovingBodies {
  const Dim2::Pose* poses;
  const BodySweep<Dim2>* sweeps;
  const SolverBody<Dim2>* velocities;
  const BodyMotion<Dim2>* motion;
};

}  // namespace carom::rigid::detail
