// A step of cloths and soft bodies, alone or together.
#include "carom/particles/detail/soft_thing.h"

#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_meeting.h"

namespace carom::particles::detail {

namespace {

core::SerialScheduler soft_serial;

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
    for (SoftThing* thing : things) again |= revise_touches(thing->touching(), h, thing->obstacles, thing->solver);
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
  int substeps = 1;
  for (const SoftThing* thing : things) substeps = math::max(substeps, thing->substeps);
  const float h = float(dt / substeps);
  const Vec3f gravity = world.definition().gravity;
  const core::ParallelRegion region(things.front()->tasks());
  for (SoftThing* thing : things) thing->begin_step(world, dt);
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
