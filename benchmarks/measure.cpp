#include "benchmarks/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace carom::bench {
namespace {

using Stages = double rigid::StepProfile::*;
constexpr Stages stages[] = {
    &rigid::StepProfile::total,        &rigid::StepProfile::effectors, &rigid::StepProfile::broad_phase,
    &rigid::StepProfile::narrow_phase, &rigid::StepProfile::prepare,   &rigid::StepProfile::solve,
    &rigid::StepProfile::restitution,  &rigid::StepProfile::finalize,  &rigid::StepProfile::continuous,
    &rigid::StepProfile::sensors,      &rigid::StepProfile::sleep};

/// Resident memory of this process, and its high-water mark since the last call of start().
class Resident {
 public:
  void start() {
#if defined(__GLIBC__)
    malloc_trim(0);
    if (std::FILE* file = std::fopen("/proc/self/clear_refs", "w")) std::fputs("5", file), std::fclose(file);
#endif
    before_ = read("VmRSS:");
  }
  std::size_t peak() const {
    const std::size_t now = read("VmHWM:");
    return now > before_ ? now - before_ : 0;
  }

 private:
  static std::size_t read(const char* field) {
    std::size_t bytes = 0;
#if defined(__linux__)
    if (std::FILE* file = std::fopen("/proc/self/status", "r")) {
      char line[256], name[64];
      unsigned long kilobytes = 0;
      while (std::fgets(line, sizeof line, file))
        if (std::sscanf(line, "%63s %lu", name, &kilobytes) == 2 && std::string(name) == field) bytes = kilobytes << 10;
      std::fclose(file);
    }
#else
    (void)field;
#endif
    return bytes;
  }
  std::size_t before_ = 0;
};

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

template <class D>
void judge(Outcome& outcome, const rigid::World<D>& world, const std::vector<rigid::BodyId>& bodies,
           const std::vector<typename D::Position>& built) {
  double sum = 0;
  int moving = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto state = world.state(bodies[i]);
    if (!state || state->type != rigid::BodyType::dynamic) continue;
    const double speed = math::length(state->linear_velocity);
    ++moving;
    sum += speed * speed;
    outcome.worst_speed = std::max(outcome.worst_speed, speed);
    outcome.worst_drift = std::max(outcome.worst_drift, math::distance(state->pose.position, built[i]));
    if (math::length(state->pose.position) > 10000 || state->pose.position.y < -150) ++outcome.escaped;
  }
  outcome.rms_speed = std::sqrt(sum / std::max(1, moving));
  outcome.worst_penetration = world.worst_penetration();
  outcome.worst_joint_gap = world.worst_joint_error();
  outcome.hash = world.state_hash();
}

}  // namespace

template <class D>
Outcome run_scene(Scene<D>& scene, rigid::WorldDef<D> definition, int steps, const Settings& settings) {
  Outcome outcome;
  Resident resident;
  resident.start();
  definition.substeps = settings.substeps;
  definition.threads = settings.threads;
  definition.simd_width = settings.simd_width;
  scene.define(definition);
  auto begin = std::chrono::steady_clock::now();
  rigid::World<D> world(definition);
  scene.build(world);
  outcome.create_ms = milliseconds_since(begin);

  std::vector<rigid::BodyId> bodies;
  std::vector<typename D::Position> built;
  world.bodies(bodies);
  for (const rigid::BodyId body : bodies) built.push_back(world.state(body)->pose.position);

  if (settings.steps > 0) steps = settings.steps;
  outcome.steps.reserve(std::size_t(steps));
  outcome.step_ms.reserve(std::size_t(steps));
  int samples = 0;
  for (int i = 0; i < steps; ++i) {
    begin = std::chrono::steady_clock::now();
    scene.before_step(world, i);
    outcome.action_ms += milliseconds_since(begin) / steps;
    if (!settings.timed_actions) begin = std::chrono::steady_clock::now();
    const core::Status stepped = world.step(1.0f / 60.0f);
    outcome.step_ms.push_back(milliseconds_since(begin));
    stepped.value();
    outcome.steps.push_back(world.profile());
    // Seldom: counting walks through all contacts, and the next step would wait for its memory.
    if (i % 32 != 31 && i + 1 != steps) continue;
    ++samples;
    outcome.counters = world.counters();
    outcome.mean_awake += outcome.counters.awake_bodies;
    outcome.mean_contacts += outcome.counters.contacts;
    outcome.mean_touching += outcome.counters.touching_contacts;
    outcome.peak_bytes = std::max(outcome.peak_bytes, outcome.counters.bytes);
  }
  outcome.mean_awake /= std::max(1, samples);
  outcome.mean_contacts /= std::max(1, samples);
  outcome.mean_touching /= std::max(1, samples);
  outcome.peak_resident = resident.peak();
  judge(outcome, world, bodies, built);
  return outcome;
}
template Outcome run_scene(Scene<rigid::Dim2>&, rigid::WorldDef<rigid::Dim2>, int, const Settings&);
template Outcome run_scene(Scene<rigid::Dim3>&, rigid::WorldDef<rigid::Dim3>, int, const Settings&);

Outcome run_scene(const SceneInfo& info, const Settings& chosen) {
  Settings settings = chosen;
  settings.timed_actions = info.acts;
  const auto run = [&](auto make, auto definition) {
    define_suite(info.suite, definition);
    return run_scene(*make(), definition, info.steps, settings);
  };
  return info.make2 != nullptr ? run(info.make2, rigid::WorldDef<rigid::Dim2>{})
                               : run(info.make3, rigid::WorldDef<rigid::Dim3>{});
}

void take_minima(Outcome& best, Outcome&& next) {
  if (best.steps.empty()) {
    best = std::move(next);
    return;
  }
  for (std::size_t i = 0; i < std::min(best.steps.size(), next.steps.size()); ++i) {
    best.step_ms[i] = std::min(best.step_ms[i], next.step_ms[i]);
    for (const Stages stage : stages) best.steps[i].*stage = std::min(best.steps[i].*stage, next.steps[i].*stage);
  }
  best.create_ms = std::min(best.create_ms, next.create_ms);
  best.action_ms = std::min(best.action_ms, next.action_ms);
}

double mean_after_first(const std::vector<double>& ms) {
  double sum = 0;
  for (std::size_t i = 1; i < ms.size(); ++i) sum += ms[i];
  return sum / double(std::max<std::size_t>(1, ms.size() - 1));
}

rigid::StepProfile mean_stages(const Outcome& outcome) {
  rigid::StepProfile mean;
  const std::size_t n = outcome.steps.size();
  for (std::size_t i = 1; i < n; ++i)
    for (const Stages stage : stages) mean.*stage += outcome.steps[i].*stage / double(std::max<std::size_t>(1, n - 1));
  return mean;
}

}  // namespace carom::bench
