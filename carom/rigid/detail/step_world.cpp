// The step as a named sequence of stages.
#include <atomic>
#include <optional>

#include "carom/core/profiler.h"
#include "carom/math/cpu.h"
#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/load_account.h"
#include "carom/rigid/detail/memory.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

/// Times the stages for `World::profile` and the caller's profiler; nothing in a world depends on it.
class Stopwatch {
 public:
  explicit Stopwatch(core::Profiler* profiler) : profiler_(profiler) {}
  /// ms since the last lap.
  double lap(const char* stage) { return measure(stage, last_); }
  /// ms since the start.
  double whole(const char* name) { return measure(name, start_); }

 private:
  double measure(const char* name, std::int64_t since) {
    const std::int64_t now = core::Profiler::now();
    if (profiler_ != nullptr) profiler_->record(name, 0, since, now);
    last_ = now;
    return 1e-6 * double(now - since);
  }

  core::Profiler* profiler_;
  std::int64_t start_ = core::Profiler::now(), last_ = start_;
};

/// Tells handles of different worlds apart. The only thing that worlds share; no result depends on it.
std::uint16_t next_world_number() {
  static std::atomic<std::uint32_t> last{0};
  return std::uint16_t(last.fetch_add(1, std::memory_order_relaxed) % 0xFFFF + 1);
}

template <class T>
void release_memory(std::vector<T>& v) {
  std::vector<T>().swap(v);
}
/// vector::shrink_to_fit does nothing where exceptions are off.
template <class T>
void fit_memory(std::vector<T>& v) {
  std::vector<T> exact;
  exact.reserve(v.size());
  for (T& x : v) exact.push_back(std::move(x));
  exact.swap(v);
}

template <class D>
void begin_events(WorldImplementation<D>& world) {
  StepScratch<D>& s = world.scratch;
  if (world.bodies.awake.empty() && !world.reserved) release_memory(s.fell_asleep);
  forget_events(s);
  // What ended by calls between the steps is told with this one.
  s.contact_end.swap(s.pending_contact_end);
  s.sensor_end.swap(s.pending_sensor_end);
}
/// What ended while the stages ran (contacts whose bounds parted) belongs to this step too.
template <class D>
void end_events(WorldImplementation<D>& world) {
  StepScratch<D>& s = world.scratch;
  s.contact_end.insert(s.contact_end.end(), s.pending_contact_end.begin(), s.pending_contact_end.end());
  s.sensor_end.insert(s.sensor_end.end(), s.pending_sensor_end.begin(), s.pending_sensor_end.end());
  s.pending_contact_end.clear();
  s.pending_sensor_end.clear();
}

/// Gives back what only steps need, and what vectors hold beyond their content.
struct MemoryRelease {
  template <class T>
  void state(T&) {}
  template <class T>
  void state(std::vector<T>& v) {
    if (v.empty())
      release_memory(v);
    else if (v.capacity() > v.size())
      fit_memory(v);
  }
  template <class T>
  void state(core::Column<T>& v) {
    v.fit();
  }
  template <class S, class P, class M>
  void bodies(core::Column<S>& solver, core::Column<P>& pose, core::Column<M>& motion,
              core::Column<BodyRecord>& record) {
    state(solver), state(pose), state(motion), state(record);
  }
  void begins(StatePart) {}
  template <class T>
  void manifolds(core::Column<T>& v) {
    state(v);
  }
  template <class T>
  void scratch(core::Column<T>& v) {
    v.clear(), v.fit();
  }
  template <class T>
  void scratch(std::vector<T>& v) {
    release_memory(v);
  }
  template <class T>
  void events(std::vector<T>& v) {
    if (v.empty()) release_memory(v);
  }
  template <class T>
  void definition(const T&) {}
  template <class T>
  void shapes(std::vector<T>& v) {
    state(v);
  }
  void names(std::vector<std::string>& v) { state(v); }
  template <class T>
  void effectors(std::vector<T>&) {}
};

/// A world in which everything sleeps gives back what only steps need. The first step after it allocates again.
template <class D>
void release_scratch(WorldImplementation<D>& world) {
  world.arena = core::Arena();
  visit_world(world, MemoryRelease{});
  for (auto& tree : world.shapes.trees) tree.release_scratch();
}

/// Is there enough to do that keeping the workers at hand pays? A small step wakes nobody.
template <class D>
bool worth_a_region(const WorldImplementation<D>& world) {
  return world.scheduler->thread_count() > 1 && world.bodies.awake.size() + world.contacts.awake.size() >= 256;
}

template <class D>
void tell_moves(WorldImplementation<D>& world) {
  if (!world.definition.move_events) return;
  for (const std::int32_t body : world.bodies.awake)
    world.scratch.body_moves.push_back({world.bodies.slots.handle_at(body), world.bodies.pose[std::size_t(body)]});
}

/// Sixteen lanes pay where there is much to solve: blocks of few contacts stay half empty, and registers so wide slow
/// down what is not in lanes beside them. Results are the same in bits.
template <class D>
void choose_kernels(WorldImplementation<D>& world) {
  if (world.definition.simd_width != 0) return;
  constexpr std::size_t much = D::dimension == 2 ? 16384 : 2048;
  const bool widest = world.contacts.awake.size() + 2 * world.bodies.awake.size() >= much;
  const auto set = math::choose_instruction_set(widest ? math::InstructionSet::avx512 : math::InstructionSet::avx2);
  if (world.kernels.width != math::simd_width(set)) world.kernels = kernels_of<D>(set);
}

template <class D>
StepContext<D> make_context(WorldImplementation<D>& world, float dt, int substeps) {
  StepContext<D> context{world, *world.scheduler, world.arena};
  const WorldDef<D>& definition = world.definition;
  context.dt = dt;
  context.inverse_dt = 1 / dt;
  context.substeps = substeps;
  context.h = dt / float(substeps);
  context.inverse_h = float(substeps) * context.inverse_dt;
  const float stiffer = float(substeps) / float(definition.substeps);  // than the world's: BodyDef::substeps
  const float hertz = contact_hertz(definition, substeps, context.inverse_h);
  context.contact_stiffness = stiffness_of(hertz);
  context.contact_softness.free = make_softness(hertz, definition.contact_damping_ratio, context.h);
  context.contact_softness.firm = make_softness(2 * hertz, definition.contact_damping_ratio, context.h);
  const auto joint_softness = [&](float most_turns) {
    return make_softness(min(stiffer * definition.joint_hertz, most_turns * context.inverse_h),
                         definition.joint_damping_ratio, context.h);
  };
  context.joint_softness = joint_softness(most_turns_of_joints(definition.joint_solver));
  context.coupling_softness = joint_softness(most_coupling_turns);
  context.push_speed = definition.contact_push_speed;
  context.rest_speed = rest_speed(definition, dt);
  context.bodies = world.bodies.solver.data();
  if (world.scratch.loads.size() < world.bodies.record.size()) world.scratch.loads.resize(world.bodies.record.size());
  world.scratch.flights.resize(world.bodies.awake.size());
  context.flights = world.scratch.flights.data();
  return context;
}

}  // namespace

template <class D>
WorldImplementation<D>::WorldImplementation(const WorldDef<D>& d)
    : definition(d),
      world_number(next_world_number()),
      bodies(world_number),
      shapes(world_number),
      joints(world_number),
      effectors(world_number),
      kernels(kernels_of<D>(d.simd_width == 0
                                ? math::detect_instruction_set()
                                : math::choose_instruction_set(math::instruction_set_of_width(d.simd_width)))) {
  scheduler = d.scheduler;
  if (scheduler == nullptr) {
    own_scheduler = core::make_thread_pool(d.threads);
    scheduler = own_scheduler.get();
  }
  scratch.found_outgrown.resize(std::size_t(scheduler->thread_count()));
  scratch.found_pairs.resize(std::size_t(scheduler->thread_count()));
  scratch.met_sensors.resize(std::size_t(scheduler->thread_count()));
  scratch.found_bullet_pairs.resize(std::size_t(scheduler->thread_count()));
  scratch.load_wishes.resize(std::size_t(scheduler->thread_count()));
  scratch.found_strays.resize(std::size_t(scheduler->thread_count()));
  scratch.found_manifolds.resize(std::size_t(scheduler->thread_count()));
}

template <class D>
Status check_definition(std::string_view call, const WorldDef<D>& d) {
  Complaint c(call);
  c.vector("gravity", d.gravity);
  const auto range = [&](std::string_view field, double x, double low, double high) {
    if (!(x >= low && x <= high)) c.say(core::refused(field, x, core::text("a number from ", low, " to ", high)));
  };
  range("|gravity|", double(math::length(d.gravity)), 0, 1e6);
  range("substeps", d.substeps, 1, 64);
  range("threads", d.threads, 1, 64);
  if (d.simd_width != 0 && d.simd_width != 4 && d.simd_width != 8 && d.simd_width != 16)
    c.say(core::text("simd_width is ", d.simd_width, ", expected 0, 4, 8 or 16"));
  range("restitution_threshold", d.restitution_threshold, 0, 1e6);
  range("contact_hertz", d.contact_hertz, 0, 1e6);
  range("contact_damping_ratio", d.contact_damping_ratio, 0, 1e6);
  range("contact_push_speed", d.contact_push_speed, 0, 1e6);
  range("joint_hertz", d.joint_hertz, 0, 1e6);
  range("joint_damping_ratio", d.joint_damping_ratio, 0, 1e6);
  range("maximum_linear_speed", d.maximum_linear_speed, 1e-3, 1e6);
  range("sleep_time", d.sleep_time, 0, 1e6);
  if (c.none_yet()) return {};
  return c.error();
}

template <class D>
Status step_world(WorldImplementation<D>& world, float dt) {
  if (!(dt > 0 && dt <= 1))
    return core::Error{core::text("World::step: ", core::refused("dt", dt, "a time above 0 and at most 1 s"))};
  if (world.step_count == 0) {
    const Status status = check_definition<D>("World::step: definition", world.definition);
    if (!status.ok()) return status.error();
  }
  Stopwatch watch(world.definition.profiler);
  StepProfile profile;
  begin_events(world);
  world.arena.reset();
  world.last_dt = dt;
  learn_bounce(world);

  std::optional<core::ParallelRegion> region;
  if (worth_a_region(world)) region.emplace(*world.scheduler);
  apply_effectors(world, dt);
  release_broken_bodies(world);  // what a caller's effector broke never meets another body
  profile.effectors = watch.lap("effectors");
  find_pairs(world);
  profile.broad_phase = watch.lap("broad phase");
  update_contacts(world);
  drop_loads(world, world.scratch.dropped);
  choose_friction(world);
  modify_contacts(world);
  profile.narrow_phase = watch.lap("narrow phase");

  choose_kernels(world);
  if (!world.scratch.new_touches.empty()) {
    StepContext<D> all = make_context(world, dt, world.definition.substeps);
    hand_down_loads(all);
  }
  order_by_place(world);
  for_each_substep_group<D>(world, [&](int substeps) {
    StepContext<D> group = make_context(world, dt, substeps);
    prepare_joints(group);
    prepare_contacts(group);
    find_impacts(group);
    profile.prepare += watch.lap("prepare");
    solve_constraints(group);
    profile.solve += watch.lap("solve");
    restitute_contacts(group);
    if constexpr (D::dimension == 3) bound_spins(group);
    profile.restitution += watch.lap("restitution");
    store_joints(group);
    store_contacts(group);
    test_joints(world);
  });
  StepContext<D> context = make_context(world, dt, world.definition.substeps);
  finalize_bodies(context);
  gather_hit_events(context);
  profile.finalize = watch.lap("finalize");
  stop_fast_bodies(context);
  profile.continuous = watch.lap("continuous");
  tell_moves(world);
  update_trees(world);
  release_broken_bodies(world);
  break_joints(world);
  profile.broad_phase += watch.lap("trees");
  ++world.step_count;
  world.time += double(dt);
  const bool moved = !world.bodies.awake.empty();
  if (moved) ++world.moves;
  sleep_islands(context);
  end_events(world);
  world.peak_bytes = max(world.peak_bytes, bytes_of_world(world));
  if (!world.reserved && moved && world.bodies.awake.empty() && world.contacts.awake.empty() &&
      world.scratch.moved.empty())
    release_scratch(world);
  profile.sleep = watch.lap("events and sleep");
  profile.total = watch.whole("World::step");
  world.profile = profile;
  return {};
}

template struct WorldImplementation<Dim2>;
template struct WorldImplementation<Dim3>;
template Status check_definition<Dim2>(std::string_view, const WorldDef<Dim2>&);
template Status check_definition<Dim3>(std::string_view, const WorldDef<Dim3>&);
template Status step_world<Dim2>(WorldImplementation<Dim2>&, float);
template Status step_world<Dim3>(WorldImplementation<Dim3>&, float);

}  // namespace carom::rigid::detail
