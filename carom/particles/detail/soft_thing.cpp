// A step of cloths and soft bodies, alone or together.
#include "carom/particles/detail/soft_thing.h"

#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_meeting.h"

namespace carom::particles::detail {

namespace {

core::SerialScheduler soft_serial;

constexpr float meeting_stride = 0.5f;  // of an edge
constexpr int most_meeting_substeps = 16;

/// Things that meet, and what they are near, pass by each other by a part of an edge a substep at most: what goes
/// deeper is through before it is seen, or crushes an element in one go.
int substeps_of(std::span<SoftThing* const> things, bool meet, double dt) {
  int substeps = 1;
  for (const SoftThing* thing : things) substeps = math::max(substeps, thing->substeps);
  if (!meet) return substeps;
  Vec3f low = things[0]->velocity[0], high = low;
  float edge = things[0]->mean_edge;
  for (const SoftThing* thing : things) {
    edge = math::min(edge, thing->mean_edge);
    for (const Vec3f v : thing->velocity) {
      low = min(low, v);
      high = max(high, v);
    }
    if (!thing->obstacles.empty()) {
      low = min(low, Vec3f{});
      high = max(high, Vec3f{});
    }
  }
  const float needed = math::ceil(float(dt) * length(high - low) / (meeting_stride * edge));
  return math::max(substeps, int(math::min(needed, float(most_meeting_substeps))));
}

/// Solves with contacts that begin and end.
void solve_together(std::span<SoftThing* const> things, SoftMeeting* meeting, float h) {
  int iterations = 0;
  for (int round = 0; round < 3; ++round) {
    bool bears = false;
    for (SoftThing* thing : things) {
      tie_touches(thing->touching(), thing->obstacles, thing->solver);
      bears |= !thing->solver.ties.empty();
    }
    if (meeting != nullptr) meeting->enter();
    // What a solve leaves undone of a stiff solid's forces would throw a light body that lies on it.
    iterations += solve_system(things, meeting, bears ? 5e-5 : 2e-3, h * (bears ? 0.1f : 2.0f), 200, round > 0);
    if (round == 2) break;
    bool again = false;
    for (SoftThing* thing : things) again |= thing->revise(h);
    if (meeting != nullptr) again |= meeting->revise(h);
    if (!again) break;
  }
  for (SoftThing* thing : things) {
    thing->solver.finish(thing->matrix, thing->tasks());
    thing->iterations += iterations;
  }
}

}  // namespace

core::TaskScheduler& SoftThing::tasks() const { return scheduler != nullptr ? *scheduler : soft_serial; }

void SoftThing::begin_step(rigid::World3& world, double dt) {
  obstacles.clear();
  place_pins(pins, pinned, pin_of, world, obstacles, position, velocity);
  if (collide) gather_near(apart, dt, world, filter, pins, position, velocity, obstacles);
  obstacles.find_pulls(world, dt);
  iterations = 0;
}

void SoftThing::end_step(rigid::World3& world, double dt) {
  obstacles.hand_over(world, dt, double(length(world.definition().gravity)));
}

int step_together(std::span<SoftThing* const> things, SoftMeeting* meeting, rigid::World3& world, double dt) {
  const Vec3f gravity = world.definition().gravity;
  const core::ParallelRegion region(things.front()->tasks());
  for (SoftThing* thing : things) thing->begin_step(world, dt);
  const int substeps = substeps_of(things, meeting != nullptr, dt);
  const float h = float(dt / substeps);
  for (int s = 0; s < substeps; ++s) {
    for (SoftThing* thing : things) thing->begin_substep(h, gravity);
    if (meeting != nullptr) meeting->find(things, h);
    solve_together(things, meeting, h);
    if (meeting != nullptr) meeting->remember(h);
    for (SoftThing* thing : things) {
      thing->end_substep(h);
      thing->obstacles.advance(double(h), thing->solver);
    }
  }
  for (SoftThing* thing : things) thing->end_step(world, dt);
  return substeps;
}

}  // namespace carom::particles::detail
