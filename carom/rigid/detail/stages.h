// The step, stage by stage, in the order in which world_step runs them.
#pragma once

#include "carom/rigid/detail/bodies.h"

namespace carom::rigid::detail {

/// New pairs of shapes whose fat bounds came to overlap get a contact.
template <class D>
void find_pairs(WorldImplementation<D>& world);
/// Manifolds of all awake contacts; begin and end events; contacts that drifted apart are destroyed.
template <class D>
void update_contacts(WorldImplementation<D>& world);
/// One-way surfaces and the caller's contact modifier, in the order of the contacts, on the calling thread.
template <class D>
void modify_contacts(WorldImplementation<D>& world);
/// Pairs whose rule has a friction of rest: that one where they stuck in the last step.
template <class D>
void choose_friction(WorldImplementation<D>& world);
/// May the moving shape pass the one-way surface `other` on its way by `travel` (world)?
template <class D>
bool passes_one_way(const WorldImplementation<D>& world, std::int32_t other, const typename D::Vector& travel);
/// First impulses and masses of what was set down at rest in contact.
template <class D>
void hand_down_loads(StepContext<D>& context);
/// Nothing is pressed together by its weight: what pushes bodies out of each other is all that contacts do.
template <class D>
bool is_weightless(const StepContext<D>& context) {
  return context.world.definition.gravity == typename D::Vector{};
}
/// Has the solver any contact in this step?
template <class D>
bool any_contacts(const WorldImplementation<D>& world) {
  for (const GraphColor& color : world.graph.colors)
    if (!color.manifolds.empty()) return true;
  return false;
}
/// Now and then: the contacts of each colour in the order of their places, so that a thread, which has a run of each
/// colour, mostly finds bodies that it wrote itself. No result depends on their order.
template <class D>
void order_by_place(WorldImplementation<D>& world);
/// Contact blocks from manifolds, and back.
template <class D>
void prepare_contacts(StepContext<D>& context);
template <class D>
void store_contacts(StepContext<D>& context);
/// Impacts at their moment (stage_impact.cpp): which may happen in this step, and those of a substep: after its forces
/// acted, before its end (the relaxing pass looks a substep ahead: what strikes there strikes first), and the last
/// time.
enum class ImpactMoment : std::uint8_t { after_forces, end_of_substep, end_of_step };
template <class D>
void find_impacts(StepContext<D>& context);
template <class D>
void solve_impacts(StepContext<D>& context, ImpactMoment moment);
/// m/s at which two bodies begin to bounce: the world's, in the time of the slower of those that move.
template <class D>
float bounce_threshold(const WorldImplementation<D>& world, std::int32_t a, std::int32_t b) {
  const BodyStore<D>& bodies = world.bodies;
  if (bodies.time_scale.empty()) return world.definition.restitution_threshold;
  const float fast = 1e3f,
              pace = min(bodies.is_dynamic(a) ? bodies.pace(a) : fast, bodies.is_dynamic(b) ? bodies.pace(b) : fast);
  return world.definition.restitution_threshold * pace;
}
/// Where a manifold's points are now, in the world.
template <class D>
void contact_points_now(const WorldImplementation<D>& world, const ManifoldRecord<D>& manifold,
                        typename D::Position (&points)[D::max_points], float (&separations)[D::max_points],
                        typename D::Vector& normal);
/// Calls solve for each number of substeps that islands have: the world's alone where no body asks for more. While it
/// runs, the graph and the list of awake bodies hold only those islands.
template <class D>
void for_each_substep_group(WorldImplementation<D>& world, core::FunctionRef<void(int substeps)> solve);
/// Everything with a substep in it.
template <class D>
void solve_constraints(StepContext<D>& context);
template <class D>
void restitute_contacts(StepContext<D>& context);
/// What integration needs of bodies through all substeps.
template <class D>
void prepare_drives(StepContext<D>& context);
/// All substeps of those bodies in places [begin, end) of the list of awake bodies that nothing touches.
void fly_through(StepContext<Dim3>& context, int begin, int end);
void bound_spins(StepContext<Dim3>& context);
/// Lists bodies whose inertia turns much with them: contacts are to see it in every substep. Those that turn already
/// take impulses again, because what contacts did to a body that stood otherwise is something else now. Returns whether
/// there are any of these.
bool list_slender(StepContext<Dim3>& context);
/// The inertia of slender bodies that have turned in this step, and the masses of their contacts; of many, those are
/// left to turn_masses, for blocks [begin, end) of a colour.
void turn_slender(StepContext<Dim3>& context);
void turn_masses(const StepContext<Dim3>& context, int color, int begin, int end);
/// What contacts of slender bodies that whirl on joints gave in the last substep is not what they begin with. A contact
/// sees one body, the joint gives its blow to others too, and what was too much of it is then not taken back.
void forget_blows(const StepContext<Dim3>& context);
/// Of the others there, by one substep.
template <class D>
void integrate_velocities(StepContext<D>& context, int begin, int end, bool carry_on);
template <class D>
void integrate_positions(StepContext<D>& context, int begin, int end);
/// New poses from displacements; bounds; sleep timers; quarantine; who is fast.
template <class D>
void finalize_bodies(StepContext<D>& context);
/// Who may count for more, and who is its own self again, as finalize_bodies found (load_account.h).
template <class D>
void grant_loads(StepContext<D>& context);
/// Marks the shapes that no longer fit their fat bounds.
template <class D>
bool leave_bounds(WorldImplementation<D>& world, std::int32_t body);
/// Takes force and speed from a body whose numbers broke: it will be told and released.
template <class D>
void quarantine(WorldImplementation<D>& world, std::int32_t body);
/// Bodies whose state became NaN or infinite are frozen and taken out of everything.
template <class D>
void release_broken_bodies(WorldImplementation<D>& world);
/// Fast bodies stop where they first meet fixed geometry (bullets: any).
template <class D>
void stop_fast_bodies(StepContext<D>& context);
/// What is welded to a body that was stopped stops with it, and slender bodies on pins; scratch.fast grows by those
/// that were slow.
template <class D>
void stop_what_is_tied(StepContext<D>& context);
/// Is it a weld without springs?
template <class D>
bool is_welded(const JointData<D>& data);
/// Trees take over the bounds that changed.
template <class D>
void update_trees(WorldImplementation<D>& world);
/// Islands that have been slow for long enough fall asleep.
template <class D>
void sleep_islands(StepContext<D>& context);
/// The number of islands: awake ones are counted afresh.
template <class D>
int count_islands(const WorldImplementation<D>& world);
/// Hit events of this step, after the impulses are known.
template <class D>
void gather_hit_events(StepContext<D>& context);

/// What is wrong with a definition, beginning with `call`.
template <class D>
Status check_definition(std::string_view call, const WorldDef<D>& definition);
template <class D>
Status step_world(WorldImplementation<D>& world, float dt);

}  // namespace carom::rigid::detail
