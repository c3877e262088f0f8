// Arrays that a step fills and keeps its capacity in, so that a warm step does not allocate.
#pragma once

#include <vector>

#include "carom/rigid/detail/contact_watch.h"
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
  friend bool operator<(const FoundPair& l, const FoundPair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; }
  friend bool operator==(const FoundPair& l, const FoundPair& r) { return l.a == r.a && l.b == r.b; }
};

enum ContactMark : std::uint8_t {
  mark_bounces = 1,  ///< may bounce in this step
};
/// Where a colour's contacts are in the arena of the step.
struct ColorBlocks {
  void* blocks = nullptr;
  void* extra = nullptr;
  std::uint8_t* marks = nullptr;  ///< ContactMark by place in the colour's list
  int count = 0;
  bool bounces = false;
};

/// A pass over bodies or over the constraints of some colours: what the solver does between two barriers.
enum class SolverPass : std::uint8_t {
  velocities,
  begin_trees,
  warm_start,
  solve,
  solve_trees,
  positions,
  factorise_trees,
  relax,
  settle_trees
};
struct SolverStage {
  SolverPass pass = SolverPass::velocities;
  std::uint8_t first_rank = 0, last_rank = 0;  ///< of the colours, in the order of a sweep
};

/// So many stages a step has at most.
inline constexpr std::size_t most_solver_stages(int substeps) {
  return std::size_t(substeps) * (6 + 3 * (color_count + 1));
}

enum BodyChange : std::uint8_t { body_outgrew = 1, body_broke = 2 };

/// Where a fast body was when the step began.
template <class D>
struct SweepStart {
  typename D::Rotation rotation{};
  typename D::Position center{};
  bool stopped = false;  ///< continuous collision cut its way
};

/// A sensor and a shape that met in a fast body's way.
struct SensorMeeting {
  std::int32_t own, other;  ///< slots of shapes
  float time;               ///< fraction of the step
};

/// A body's velocities before and after a substep's forces.
template <class D>
struct Flight {
  typename D::Vector after, before;
};

template <class D>
struct StepScratch {
  ColorBlocks blocks[color_count + 1];
  std::vector<Flight<D>> flights;                   ///< by place in BodyStore::awake
  std::vector<std::int32_t> impacts, impact_queue;  ///< manifolds that may strike a row, and those to look at now
  std::vector<SolverStage> solver_stages;
  std::vector<core::TaskScheduler::Stage> solver_loops;  ///< of the same places
  std::vector<BodyPath> paths;                           ///< by slot of the body
  std::vector<PathEnd<D>> path_ends;                     ///< by slot of the body
  std::vector<std::int32_t> followed;                    ///< bodies whose paths have a reach
  std::vector<ContactWatch> watches;                     ///< by place in ContactStore::awake, or empty: look at all
  std::vector<typename D::Bounds> old_bounds;       ///< by place in `moved`: fat bounds when pairs were last looked for
  std::vector<std::int32_t> moved_place;            ///< by slot of the shape: place in old_bounds, or −1
  std::vector<std::int32_t> moved;                  ///< shapes whose fat bounds changed
  std::vector<std::vector<FoundPair>> found_pairs;  ///< by worker
  std::vector<std::vector<SensorMeeting>> met_sensors;  ///< by worker
  std::vector<FoundPair> pairs;
  std::vector<SweepStart<D>> swept;                            ///< by place in BodyStore::awake
  std::vector<std::int32_t> fast;                              ///< places in BodyStore::awake
  std::vector<std::int32_t> broken;                            ///< bodies to be quarantined
  std::vector<std::uint8_t> body_changes;                      ///< by place in BodyStore::awake
  std::vector<std::uint8_t> contact_changes;                   ///< by place in ContactStore::awake
  std::vector<std::vector<FoundManifold<D>>> found_manifolds;  ///< by worker
  std::vector<FoundManifold<D>> manifolds;
  std::vector<std::int32_t> island_parent, island_list, island_bodies, island_ends, doomed_contacts, new_touches;
  std::vector<std::uint8_t> island_restless;

  std::vector<ContactBeginEvent> contact_begin;
  std::vector<ContactEndEvent> contact_end, pending_contact_end;  ///< pending: from calls between steps
  std::vector<ContactHitEvent<D>> contact_hit;
  std::vector<SensorEvent> sensor_begin, sensor_end, pending_sensor_end;
  std::vector<SleepEvent> fell_asleep, quarantined;
  std::vector<MoveEvent<D>> body_moves;
  std::vector<JointBreakEvent<D>> joint_break;
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
}

}  // namespace carom::rigid::detail
