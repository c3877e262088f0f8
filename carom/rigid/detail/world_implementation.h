// All of a world's state, and the few operations on it that every part of the room shares.
#pragma once

#include <memory>

#include "carom/core/hash.h"
#include "carom/rigid/detail/color_parts.h"
#include "carom/rigid/detail/contact_store.h"
#include "carom/rigid/detail/effector_store.h"
#include "carom/rigid/detail/joint_store.h"
#include "carom/rigid/detail/kernels.h"
#include "carom/rigid/detail/pair_set.h"
#include "carom/rigid/detail/query_trees.h"
#include "carom/rigid/detail/shape_store.h"
#include "carom/rigid/detail/sleeping_islands.h"
#include "carom/rigid/detail/step_context.h"
#include "carom/rigid/detail/step_scratch.h"
#include "carom/rigid/world.h"

namespace carom::rigid::detail {

struct PairRuleEntry {
  std::uint64_t key = 0;
  PairRule rule{};
  std::uint32_t unused = 0;  ///< snapshots copy entries: no byte is without a value
  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
  }
};
static_assert(sizeof(PairRuleEntry) == sizeof(std::uint64_t) + sizeof(PairRule) + sizeof(std::uint32_t));

template <class D>
struct WorldImplementation {
  explicit WorldImplementation(const WorldDef<D>& definition);

  WorldDef<D> definition;
  std::uint16_t world_number;  ///< in every handle

  BodyStore<D> bodies;
  ShapeStore<D> shapes;
  JointStore<D> joints;
  EffectorStore<D> effectors;
  ContactStore<D> contacts;
  PairSet pairs;          ///< keys of all contacts
  ConstraintGraph graph;  ///< of awake constraints
  SleepingIslands sleeping;

  std::unique_ptr<core::TaskScheduler> own_scheduler;
  core::TaskScheduler* scheduler = nullptr;
  core::Arena arena;
  StepScratch<D> scratch;
  Kernels<D> kernels;

  int hit_event_shapes = 0;  ///< shapes that want hit events
  std::uint64_t step_count = 0, births = 0;
  double time = 0;
  float last_dt = 1.0f / 60;              ///< s; before the first step, what it is likely to be
  std::size_t peak_bytes = 0;             ///< the most memory held after any step
  bool reserved = false;                  ///< the caller asked for room: it is not given back when all sleeps
  std::vector<PairRuleEntry> pair_rules;  ///< in the order of their keys
  typename World<D>::ContactFilter contact_filter;
  typename World<D>::ContactModifier contact_modifier;
  StepProfile profile{};
  std::uint64_t moves = 0;  ///< steps in which anything was awake
  mutable QueryTrees<typename D::Position> query_trees;
};

// bodies.cpp ------------------------------------------------------------------------------------------------------
/// Makes an enabled body awake, with all of its sleeping island, and resets its sleep timer.
template <class D>
void wake_body(WorldImplementation<D>& world, std::int32_t body);
/// Recomputes mass, centre and inertia from the shapes (or from what was given), keeping the velocity of the origin.
template <class D>
void update_mass(WorldImplementation<D>& world, std::int32_t body);

// contacts.cpp ----------------------------------------------------------------------------------------------------
/// Destroys all contacts between two bodies (after a joint that forbids them was made).
template <class D>
void destroy_contacts_between(WorldImplementation<D>& world, std::int32_t a, std::int32_t b);
/// Lets the broad phase look for the body's pairs again (after such a joint was destroyed, or a filter changed).
template <class D>
void find_pairs_again(WorldImplementation<D>& world, std::int32_t body);

// joint_links.cpp -------------------------------------------------------------------------------------------------
/// Puts the joint into the lists of its bodies, wakes them, and puts it into the graph. Drops contacts between them
/// if they are not to collide.
template <class D>
void attach_joint(WorldImplementation<D>& world, std::int32_t joint);
/// The opposite. Wakes both bodies.
template <class D>
void detach_joint(WorldImplementation<D>& world, std::int32_t joint);
/// True if a joint between the bodies says that they do not collide.
template <class D>
bool joints_forbid_collision(const WorldImplementation<D>& world, std::int32_t a, std::int32_t b);

// joint_solve.cpp, effect.cpp (the joints' and effectors' part) ----------------------------------------------------
template <class D>
void prepare_joints(StepContext<D>& context);
/// Into so many pieces of about the work of a block of contacts the joints of a colour can be cut.
template <class D>
int joint_units(const WorldImplementation<D>& world, int color);
template <class D>
void warm_start_joints(StepContext<D>& context, int color, ThreadShare share);
template <class D>
void solve_joints(StepContext<D>& context, int color, bool use_bias, ThreadShare share);
template <class D>
void store_joints(StepContext<D>& context);
/// Destroys joints that were loaded above what they bear, and tells of it.
template <class D>
void test_joints(WorldImplementation<D>& world);
template <class D>
void break_joints(WorldImplementation<D>& world);
/// Calls f(joint, side of the body, the other body or `none`) for the joints of a body, the last made first.
template <class D, class F>
void for_each_joint(const WorldImplementation<D>& world, std::int32_t body, F&& f) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_joint; key != none;) {
    const JointHeader& header = world.joints.headers[std::size_t(key >> 1)];
    f(key >> 1, key & 1, header.body[1 - (key & 1)]);
    key = header.next[key & 1];
  }
}
/// Destroys every joint of a body (detaching each), before the body goes.
template <class D>
void destroy_joints_of(WorldImplementation<D>& world, std::int32_t body);
/// Adds to the bodies' forces and torques, once a step. Does not wake anyone.
template <class D>
void apply_effectors(WorldImplementation<D>& world, float dt);
/// Lets effectors and joints forget a body that is about to be destroyed.
template <class D>
void forget_body_in_effectors(WorldImplementation<D>& world, BodyId body);

}  // namespace carom::rigid::detail

namespace carom::rigid {
template <class D>
struct World<D>::Implementation : detail::WorldImplementation<D> {
  using detail::WorldImplementation<D>::WorldImplementation;
};
}  // namespace carom::rigid
