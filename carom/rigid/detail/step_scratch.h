// Arrays that a step fills and keeps its capacity in, so that a warm step does not allocate.
#pragma once

#include <vector>

#include "carom/rigid/detail/box_strips.h"
#include "carom/rigid/detail/box_sweep.h"
#include "carom/rigid/detail/constraint_graph.h"
#include "carom/rigid/detail/contact_watch.h"
#include "carom/rigid/detail/joint_tree.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/events.h"

namespace carom::rigid::detail {

/// A manifold found by the narrow phase that its contact does not hold yet.
template <class D>
struct FoundManifold {
  std::int32_t awake_index;  ///< of the contact
  std::int32_t ordinal;      ///< among those of the contact
  std::uint32_t child;
  typename D::Manifold manifold;
};
struct FoundPair {
  std::int32_t a, b;  ///< slots of shapes, a < b
  /// As one number, which sorting compares without a branch that nobody foresees.
  std::uint64_t order() const { return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b); }
  friend bool operator<(const FoundPair& l, const FoundPair& r) { return l.order() < r.order(); }
  friend bool operator==(const FoundPair& l, const FoundPair& r) { return l.a == r.a && l.b == r.b; }
};

enum ContactMark : std::uint8_t {
  mark_bounces = 1,    ///< may bounce in this step
  mark_pushed = 2,     ///< so deep that it is pushed out fast
  mark_settles = 4,    ///< that, or beside it: a body of both is the same
  mark_hits = 8,       ///< closes so fast that a hit may have to be told
  mark_anew = 16,      ///< takes an anchor once it bears a load
  mark_anchored = 32,  ///< has one
  mark_open = 64,      ///< that settles, or is watched until it bears a load: asked again once it is solved
  mark_again = 128,    ///< one of its bodies takes impulses again in every substep
};
/// Where a colour's contacts are in the arena of the step.
struct ColorBlocks {
  void* blocks = nullptr;
  void* extra = nullptr;
  std::uint8_t* marks = nullptr;  ///< ContactMark by place in the colour's list
  float* kept = nullptr;          ///< impulses before something was pushed out, where something is
  int count = 0;
  bool bounces = false;
  bool again = false;  ///< any with mark_again
};

/// A pass over bodies or over the constraints of some colours: what the solver does between two barriers.
enum class SolverPass : std::uint8_t {
  flights,
  velocities,
  impacts,
  begin_trees,
  warm_start,
  warm_start_again,  ///< joints, and contacts of bodies that take impulses again
  solve,
  solve_trees,
  positions,
  forget_blows,  ///< of slender bodies with joints that whirl
  turn_slender,  ///< the inertia of slender bodies, and the masses of their contacts where they are few
  turn_masses,   ///< where they are many
  factorise_trees,
  take_back,  ///< what pushed something out
  settle,     ///< what is pushed out: relaxing of normals, before the pass that counts
  relax,
  settle_trees
};
struct SolverStage {
  SolverPass pass = SolverPass::velocities;
  std::uint8_t first_rank = 0, last_rank = 0;  ///< of the colours, in the order of a sweep
  std::uint8_t order = 0;  ///< in which the points of manifolds are solved; impacts: the moment; velocities: 1 where
                           ///< bodies carry on what contacts did in the substep before
};

/// Where something is pushed out fast, what the solving pass gave is taken back once the bodies have moved: relaxing
/// alone, row by row, would leave some of it where many overlaps push from all sides, and most of it with what is
/// light. So many relaxing passes then do what solving did besides. Contacts of bodies that nothing pushes need none of
/// them.
inline constexpr int settle_passes = 4;
/// So many stages a step has at most.
inline constexpr std::size_t most_solver_stages(int substeps, int settling = 0) {
  return 1 + std::size_t(substeps) * std::size_t(10 + (settling > 0 ? 5 + settling : 4) * (color_count + 1));
}

/// How a body came out of a step; body_flew only until continuous collision has looked at it.
enum BodyChange : std::uint8_t { body_outgrew = 1, body_broke = 2, body_flew = 4 };

/// Where a body was when the step began, and how it went on.
template <class D>
struct SweepStart {
  typename D::Rotation rotation{};
  typename D::Position center{};
  typename D::Angular turn{};  ///< rad, where it may be more than half a revolution; zero: the short way
  float fraction = 1;          ///< of the step after which continuous collision stopped it
};

/// A sensor and a shape of a fast body that may have met on its way.
struct SensorMeeting {
  std::int32_t own, other;  ///< slots of shapes
};

/// A bullet's shape and one of a body that moves, which may meet within the step.
struct BulletPair {
  std::int32_t own, other;  ///< slots of shapes
  std::int32_t place[2];    ///< of the bullet and whom it may meet in BodyStore::awake; none: sleeps
  std::int32_t next[2];     ///< edge keys (2·pair + side) in the lists by place
};
/// A shape whose way left its fat bounds, where others may have missed it.
template <class D>
struct StrayShape {
  typename D::Bounds box;  ///< of its way
  std::int32_t shape;
};
/// When a pair meets, as far as is known of the ways of both.
struct BulletMeeting {
  float time;  ///< fraction of the step
  std::int32_t pair;
  friend bool operator<(const BulletMeeting& l, const BulletMeeting& r) {
    return l.time != r.time ? l.time < r.time : l.pair < r.pair;
  }
};

template <class D>
struct StepScratch {
  ColorBlocks blocks[color_count + 1];
  std::vector<BodyLoad<D>> loads;                   ///< by slot of the body; nothing between steps
  std::vector<std::vector<LoadWish>> load_wishes;   ///< by worker
  std::vector<std::int32_t> dropped;                ///< bodies that are their own selves again
  std::vector<std::uint8_t> again;                  ///< by slot of the body: takes impulses of contacts again in every
                                                    ///< substep (list_stages); nothing between steps
  std::vector<std::uint64_t> placed;                ///< manifolds of all colours behind their places (order_by_place)
  std::vector<std::int32_t> hits;                   ///< manifolds of what may be told as a hit
  std::vector<Flight<D>> flights;                   ///< by place in BodyStore::awake
  std::vector<std::int32_t> impacts, impact_queue;  ///< manifolds that may strike a row, and those to look at now
  std::vector<SolverStage> solver_stages;
  std::vector<core::TaskScheduler::Stage> solver_loops;  ///< of the same places
  std::vector<BodySweep<D>> sweeps;                      ///< by slot of the body
  std::vector<std::int32_t> sweeping;                    ///< bodies whose sweep is not zero
  core::Column<ContactWatch<D>> watches;                 ///< by place in ContactStore::awake, or empty: look at all
  std::vector<typename D::Bounds> old_bounds;  ///< by place in `moved`: fat bounds when pairs were last looked for
  std::vector<std::int32_t> moved_place;       ///< by slot of the shape: place in old_bounds, or −1
  std::vector<std::int32_t> moved;             ///< shapes whose fat bounds changed
  BoxSweep sweep;                              ///< of what flies, where it is sparse
  BoxStrips strips;                            ///< in the plane of all, where much moved
  std::vector<std::vector<std::int32_t>> found_outgrown;  ///< by part of the bodies; ~shape: was in `moved` before
  std::vector<std::int32_t> outgrown;                     ///< shapes that left their fat bounds,
  std::vector<std::int32_t> outgrown_places;              ///< their places in `moved`, or none: they were there before,
  std::vector<typename D::Bounds> new_bounds;             ///< and what these become
  std::vector<std::vector<FoundPair>> found_pairs;        ///< by worker
  std::vector<std::vector<SensorMeeting>> met_sensors;    ///< by worker
  std::vector<FoundPair> pairs;
  std::vector<std::vector<BulletPair>> found_bullet_pairs;  ///< by worker
  std::vector<std::vector<StrayShape<D>>> found_strays;     ///< by worker
  std::vector<StrayShape<D>> strays;
  std::vector<StrayShape<D>> driven;  ///< of bodies that no force moves
  std::vector<BulletPair> bullet_pairs;
  std::vector<BulletMeeting> bullet_meetings;                  ///< a heap, earliest first
  std::vector<float> pair_meetings;                            ///< by place in bullet_pairs, as the ways are known now
  std::vector<std::int32_t> first_bullet_pair;                 ///< by place in BodyStore::awake
  std::vector<SweepStart<D>> swept;                            ///< by place in BodyStore::awake
  std::vector<std::int32_t> fast;                              ///< places in BodyStore::awake
  std::vector<std::int32_t> driven_over;                       ///< bodies
  std::vector<std::int32_t> tied;                              ///< bodies, to one that was stopped
  std::vector<std::int32_t> broken;                            ///< bodies to be quarantined
  std::vector<std::uint8_t> body_changes;                      ///< by place in BodyStore::awake
  std::vector<std::uint8_t> contact_changes;                   ///< by place in ContactStore::awake
  std::vector<std::vector<FoundManifold<D>>> found_manifolds;  ///< by worker
  std::vector<FoundManifold<D>> manifolds;
  std::vector<std::int32_t> island_parent, island_list, island_bodies, island_ends, doomed_contacts, new_touches,
      new_manifolds;
  std::vector<std::uint8_t> island_restless;
  // Of islands with substeps of their own (stage_substeps.cpp):
  std::vector<std::uint8_t> island_substeps;  ///< by place in BodyStore::awake; 0: kinematic
  std::vector<std::int32_t> whole_awake;      ///< all, while a group is solved; so the others
  std::vector<TreeRange> whole_trees;
  GraphColor whole_colors[color_count + 1];

  std::vector<ContactBeginEvent> contact_begin;
  std::vector<ContactEndEvent> contact_end, pending_contact_end;  ///< pending: from calls between steps
  std::vector<ContactHitEvent<D>> contact_hit;
  std::vector<SensorEvent> sensor_begin, sensor_end, pending_sensor_end;
  std::vector<SleepEvent> fell_asleep, quarantined;
  std::vector<MoveEvent<D>> body_moves;
  std::vector<JointBreakEvent<D>> joint_break;
  std::vector<SpringBreakEvent<D>> spring_break;
};

/// Events of the last step are gone; those that wait for the next one stay.
template <class D>
void forget_events(StepScratch<D>& s) {
  s.contact_begin.clear();
  s.contact_end.clear();
  s.contact_hit.clear();
  s.sensor_begin.clear();
  s.sensor_end.clear();
  s.fell_asleep.clear();
  s.quarantined.clear();
  s.body_moves.clear();
  s.joint_break.clear();
  s.spring_break.clear();
}

}  // namespace carom::rigid::detail
