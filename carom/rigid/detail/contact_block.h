// Contacts as the wide solver reads them: W manifolds side by side, one array of W floats per quantity. Plain data, so
// that sources compiled for different instruction sets can share it.
#pragma once

#include <cstdint>

#include "carom/math/cpu.h"
#include "carom/rigid/detail/box_lanes.h"
#include "carom/rigid/detail/box_strips.h"
#include "carom/rigid/detail/contact_watch.h"
#include "carom/rigid/detail/pair_motions.h"
#include "carom/rigid/detail/step_context.h"

namespace carom::rigid::detail {

/// m: what goes less far in half a step hardly moves; what goes farther, in parts of its extent, is struck more likely
/// than it rolls, or other features will meet then.
inline constexpr float least_middle_way = 1e-3f;  ///< of `inner`, or half of still_way
inline constexpr float most_middle_way = 0.03f;   ///< of `extent`

/// ContactBlock::struck: a hard blow fell on it; it was pushed out of an overlap.
inline constexpr float block_struck = 1, block_pushed = 2;
/// ContactBlock::again: a mass follows its load, so that what presses there is not taken back.
inline constexpr std::int32_t block_bears = 4;

/// Masses in 1/kg and 1/(kg·m²); r are vectors from the centres of mass to the contact, world axes at the step's start.
/// Passes over many blocks wait for memory: what follows from other rows is not stored.
template <class D, int W>
struct ContactBlock;

/// The slot of a block's body, whoever it is.
inline std::int32_t slot_of(std::int32_t body) { return body ^ (body >> 31); }

template <int W>
struct alignas(64) ContactBlock<Dim2, W> {
  static constexpr int points = 2;
  std::int32_t body_a[W], body_b[W];  ///< slots; of a body that impulses do not move −1 − its slot
  float normal[2][W];
  float inverse_mass_a[W], inverse_mass_b[W], inverse_inertia_a[W], inverse_inertia_b[W];
  float center_offset[2][W];  ///< r_B = r_A + this, for every point of the manifold
  struct Point {
    float r_a[2][W];
    float separation[W];
    float normal_mass[W];
    float impulse[W];
    float total[W];
  } point[points];
  float friction[W];
  float patch_r_a[2][W];  ///< where friction acts
  float tangent_mass[W], tangent_target[W], tangent_impulse[W], tangent_total[W];
  float settles[W];       ///< 1: takes part in the passes that settle what is pushed out
  float struck[W];        ///< its points are solved together in this step: block_struck, block_pushed
  std::int32_t again[W];  ///< bits 0, 1: A, B takes impulses again in every substep; block_bears
};

template <int W>
struct alignas(64) ContactBlock<Dim3, W> {
  static constexpr int points = 4;
  std::int32_t body_a[W], body_b[W];
  float normal[3][W], tangent[3][W];  ///< the second tangent is normal × tangent
  float inverse_mass_a[W], inverse_mass_b[W];
  float inverse_inertia_a[6][W], inverse_inertia_b[6][W];  ///< xx, yy, zz, xy, xz, yz, world axes
  float center_offset[3][W];
  struct Point {
    float r_a[3][W];
    float separation[W];
    float normal_mass[W];
    float impulse[W];
    float total[W];
  } point[points];
  float friction[W];
  float patch_r_a[3][W];
  float tangent_mass[3][W];  ///< inverse of the 2×2 matrix of both tangents: 11, 22, 12
  float tangent_target[2][W], tangent_impulse[2][W], tangent_total[2][W];
  float twist_mass[W], twist_radius[W], twist_impulse[W];
  float settles[W];
  float struck[W];
  std::int32_t again[W];
};

/// What the preparation of a block starts from, as the records hold it; the points, the normal (both in A's shape
/// frame) and the impulses lie in the block itself. An absent point has a normal_mass of 0, others 1.
template <class D, int W>
struct alignas(64) ContactRaw {
  static constexpr int dimension = D::dimension, turn = D::dimension == 2 ? 2 : 4;  ///< turn: c, s or w, x, y, z
  struct Placed {
    float p[dimension][W], q[turn][W];
  };
  float rotation_a[turn][W], rotation_b[turn][W];  ///< of the bodies
  Placed shape_a, shape_b;                         ///< in their bodies, from the centres of mass
  Placed base;                                     ///< B in A when the manifold was made
  float recycled[W];                               ///< 1: the manifold was made at `base`, 0: now
  float anchor_a[dimension][W], anchor_b[dimension][W];
  float anchor_state[W];  ///< 0: friction slides freely, 1: no anchor yet, 2: holds, 3: settles; out: 1: a new anchor
  float friction_impulse[dimension][W];
  float squeezed[W];  ///< 0 … 1: how far the masses follow the load (load.h), of the body where they do more
  float tangent_speed[W], patch_factor[W], point_factor[W];
  float spin_radius[W];  ///< m by which spinning resistance adds to the radius on which friction turns
};

/// Only where a contact of the colour rolls with resistance or bounces.
template <class D, int W>
struct alignas(64) ContactExtra {
  static constexpr int angular = D::dimension == 2 ? 1 : 3;
  float rolling_lever[W];  ///< m: the torque is at most this times the normal force
  float rolling_mass[W];   ///< kg·m², 0: does not roll; plane alone, in space it is found from those of the bodies
  float rolling_impulse[angular][W];
  float bounce_speed[D::max_points][W];  ///< m/s to leave the surface with, 0: does not bounce
  float closing_acceleration[W];         ///< m/s² along the normal
  std::int32_t struck[W];                ///< what stage_impact.cpp knows of it
};

/// Where the records of contacts and bodies are, for kernels that read and write them by themselves.
template <class D>
struct ContactSources {
  ManifoldRecord<D>* manifolds = nullptr;
  const ContactRecord<D>* contacts = nullptr;
  const BodyMotion<D>* motion = nullptr;
  const typename D::Pose* pose = nullptr;
  const BodyRecord* record = nullptr;
  const SolverBody<D>* bodies = nullptr;
  const float* load_shares = nullptr;  ///< by level
  float* loads = nullptr;              ///< BodyLoad<D> by slot of the body
  ContactSoftness softness;
  typename D::Vector gravity{};     ///< m/s²
  float restitution_threshold = 0;  ///< m/s
  float push_speed = 0;             ///< m/s: what is pushed out of an overlap faster is `pushed`
  float rest_speed_squared = 0;     ///< (m/s)², of what is at rest,
  float restless_load = 0;          ///< and what others count for (load.h)
  float still_way = 0;              ///< m
  float half_step = 0;              ///< s
};
/// Bits by lane.
struct GatheredLanes {
  std::uint32_t placed =
      0;  ///< a shape stands elsewhere than its body: ContactRaw::shape_a and shape_b are not right yet
  std::uint32_t pushed = 0;              ///< so deep that it is pushed out fast
  std::uint32_t anchored = 0, open = 0;  ///< mark_anchored, mark_open
  std::uint32_t turns = 0;               ///< is to be solved as it is in the middle of the step (contact_middle.h)
};

/// What is asked of pairs before they are solved, compiled for one instruction set.
template <class D>
struct PairKernels {
  int width = 4;
  /// Which of the others (a multiple of 16) each member of a group meets now, but did not before: bits by place.
  void (*new_meetings)(const BoxGroup<D>& group, int members, int others, std::uint64_t* news) = nullptr;
  /// Tells which boxes at places [begin, end) of a strip meet that did not before. Null in space.
  void (*sweep)(const StripRows& rows, std::int32_t begin, std::int32_t end, TellMeetings tell, void* whom) = nullptr;
  /// Which of `count` watches in a row, at most the width, tell that nothing is new. Bits by lane.
  std::uint32_t (*nothing_new)(const ContactWatch<D>* watches, int count, const typename D::Pose* poses,
                               const BodySweep<D>* sweeps, float dt) = nullptr;
  /// How `count` pairs have moved, at most as many as the width.
  KnownApart (*pair_motions)(PairMotions<D>& pairs, int count, const MovingBodies<D>& bodies, float dt) = nullptr;
};

/// The kernels of one width, compiled for one instruction set. Blocks [begin, end); `extra` may be null.
template <class D>
struct ContactKernels {
  using Blocks = void*;
  int width = 4;
  /// Fills `block` and `raw` from the records of the manifolds in `list`; lanes without one are like the first, but
  /// move nobody.
  GatheredLanes (*gather)(const ContactSources<D>& from, const std::int32_t* list, int lanes, void* block,
                          void* raw) = nullptr;
  /// Rolling resistance and restitution of a prepared block. Bits by lane: may bounce in this step. Not for worlds
  /// where bodies have clocks of their own.
  std::uint32_t (*approach)(const ContactSources<D>& from, const std::int32_t* list, int lanes, const void* block,
                            void* extra) = nullptr;
  /// Which lanes of a prepared block close at `least` m/s or more. Bits by lane.
  std::uint32_t (*closing)(const ContactSources<D>& from, int lanes, const void* block, float least) = nullptr;
  /// Which lanes of a prepared block meet in this step from so far off that a blow does not act where the block has it.
  /// Bits by lane.
  std::uint32_t (*strikes)(const SolverBody<D>* bodies, const void* block) = nullptr;
  /// The impulses of a block to the records and to the loads of its bodies. Bits by lane: friction is at its limit.
  std::uint32_t (*store)(const ContactSources<D>& to, const std::int32_t* list, int lanes, const void* block) = nullptr;
  /// Fills a block from its `raw`. anchor_rate: 1/s, at which sticking friction takes slip back. friction_leak: part of
  /// its impulse that is forgotten in a substep where faces are squeezed. Bits by lane: its friction sticks anew.
  std::uint32_t (*prepare)(void* block, void* raw, float anchor_rate, float friction_leak) = nullptr;
  /// The masses of all rows of a block anew, from its bodies' inertia. Space alone.
  void (*masses)(void* block) = nullptr;
  /// again: to the bodies of ContactBlock::again only.
  void (*warm_start)(SolverBody<D>* bodies, Blocks blocks, const void* extra, int begin, int end, bool again) = nullptr;
  /// order: 0 … 3, in which the points of a manifold come (see list_stages).
  void (*solve)(SolverBody<D>* bodies, Blocks blocks, int begin, int end, float inverse_h, float push_speed,
                const ContactSoftness& softness, int order) = nullptr;
  /// What the soft rows let be of the normal impulses is kept, `points` times as many floats as there are lanes for
  /// each block; where something settles, what they have become more since is taken back.
  void (*keep)(Blocks blocks, float* kept, int begin, int end, const ContactSoftness& softness) = nullptr;
  void (*take_back)(SolverBody<D>* bodies, Blocks blocks, const float* kept, int begin, int end) = nullptr;
  /// Relaxing of the lanes that settle, before the pass that counts.
  void (*settle)(SolverBody<D>* bodies, Blocks blocks, int begin, int end, float inverse_h) = nullptr;
  void (*relax)(SolverBody<D>* bodies, Blocks blocks, void* extra, int begin, int end, float inverse_h) = nullptr;
  void (*restitute)(SolverBody<D>* bodies, Blocks blocks, const void* extra, int begin, int end) = nullptr;
  /// As many bodies as there are lanes through a substep, from a place of the awake list on (2D; stage_integrate.cpp).
  /// flights: Flight<D> as floats; max_turn: rad; carry_on: see SolverStage::order. False, and nothing done, where one
  /// of them has locks.
  bool (*integrate_velocities)(SolverBody<D>* bodies, const BodyDrive<D>* drives, float* flights, float h,
                               float max_speed, float max_turn, bool carry_on) = nullptr;
  bool (*integrate_positions)(SolverBody<D>* bodies, const BodyDrive<D>* drives, const float* flights,
                              float h) = nullptr;
};

namespace contact_kernels_baseline {
PairKernels<Dim2> pair_kernels(Dim2);
PairKernels<Dim3> pair_kernels(Dim3);
ContactKernels<Dim2> kernels(Dim2);
ContactKernels<Dim3> kernels(Dim3);
}  // namespace contact_kernels_baseline
#if CAROM_WIDE_UNITS
namespace contact_kernels_avx2 {
PairKernels<Dim2> pair_kernels(Dim2);
PairKernels<Dim3> pair_kernels(Dim3);
ContactKernels<Dim2> kernels(Dim2);
ContactKernels<Dim3> kernels(Dim3);
}  // namespace contact_kernels_avx2
namespace contact_kernels_avx512 {
ContactKernels<Dim2> kernels(Dim2);
ContactKernels<Dim3> kernels(Dim3);
}  // namespace contact_kernels_avx512
#endif

}  // namespace carom::rigid::detail
