// A step of cloths and soft bodies, alone or together.
#include "carom/particles/detail/soft_thing.h"

#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_meeting.h"

namespace carom::particles::detail {

namespace {

core::SerialScheduler soft_serial;

constexpr float meeting_stride = 0.5f;  // of an edge
constexpr int most_meeting_substeps = 16;
constexpr int most_fast_substeps = 64;  // of a step, while something fast comes; after them each is
constexpr int late_fast_substeps = 32;  // at least one of so many of a step
constexpr int most_fast_rounds = 8;     // of solves, in which who touches is found
constexpr int touch_chunk = 128;

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
  int iterations = 0, rounds = 3;
  for (const SoftThing* thing : things)
    if (thing->obstacles.fast) rounds = most_fast_rounds;
  for (int round = 0; round < rounds; ++round) {
    bool bears = false;
    for (SoftThing* thing : things) {
      tie_touches(thing->touching(), thing->obstacles, thing->solver);
      bears |= !thing->solver.ties.empty();
    }
    if (meeting != nullptr) meeting->enter();
    // What a solve leaves undone of a stiff solid's forces would throw a light body that lies on it.
    iterations += solve_system(things, meeting, bears ? 5e-5 : 2e-3, h * (bears ? 0.1f : 2.0f), 200, round > 0);
    if (round + 1 == rounds) break;
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

void SoftThing::hold(float h) {
  hold_pins(touching(), solver);
  face_touches.clear();
  if (!collide || obstacles.empty()) {
    for (SoftTouch& touch : touches) touch = {};
    return;
  }
  const int count = int(position.size());
  tasks().parallel_for(count, touch_chunk, [&](int from, int to, int) {
    for (std::size_t i = std::size_t(from); i < std::size_t(to); ++i)
      touches[i].near =
          (outside.empty() || outside[i] != 0) && pin_of[i] < 0 &&
          obstacles.nearest(position[i], apart, apart + 2 * double(h) * (double(length(velocity[i])) + double(h) * 20),
                            double(h), touches[i].plane);
  });
  find_sides(*this);
  if (obstacles.fast) find_face_touches(*this, h);
  meet_faces(*this, h);
  tasks().parallel_for(count, touch_chunk, [&](int from, int to, int) {
    for (std::size_t i = std::size_t(from); i < std::size_t(to); ++i)
      if (touches[i].near)
        hold_touch(touches[i], i, velocity[i], friction, h, obstacles, solver);
      else
        touches[i] = {};
  });
}

float step_together(std::span<SoftThing* const> things, SoftMeeting* meeting, rigid::World3& world, double dt) {
  const Vec3f gravity = world.definition().gravity;
  const core::ParallelRegion region(things.front()->tasks());
  for (SoftThing* thing : things) thing->begin_step(world, dt);
  const int substeps = substeps_of(things, meeting != nullptr, dt);
  float h = 0;
  int taken = 0;
  for (int s = 0; s < substeps; ++s)
    for (double left = dt / substeps; left > 0; ++taken) {
      double part = left;
      const double least = taken < most_fast_substeps ? 0 : dt / late_fast_substeps;
      for (const SoftThing* thing : things) part = stride(*thing, part, least);
      const double parts = math::ceil(left / part);
      h = float(left / parts);
      left = parts > 1 ? left - double(h) : 0;
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
  return h;
}

}  // namespace carom::particles::detail
