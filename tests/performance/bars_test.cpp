// Bars of speed that hold on any recent machine with room to spare. Times are minima over many repetitions, and each
// test may try again, so that what else the machine does cannot fail it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "benchmarks/measure.h"
#include "benchmarks/scene_pieces.h"
#include "carom/math/random.h"
#include "tests/rigid/scene_pieces.h"

namespace {
using namespace carom;
using namespace carom::bench;

double microseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

// The reference of a game at 60 Hz: 5 000 bodies that touch within one frame of 16 ms, on one thread.
TEST(Bars, FiveThousandBodiesInAFrame) {
  for (const char* name : {"box3d/large_pyramid", "box2d/large_pyramid"}) {
    const std::vector<const SceneInfo*> scenes = find_scenes(name);
    ASSERT_EQ(scenes.size(), 1u);
    Settings settings;
    settings.steps = 60;
    double best = 1e9;
    int bodies = 0;
    for (int attempt = 0; attempt < 4 && best >= 16; ++attempt) {
      const Outcome outcome = run_scene(*scenes[0], settings);
      best = std::min(best, mean_after_first(outcome.step_ms));
      bodies = outcome.counters.bodies;
    }
    EXPECT_GE(bodies, 5000) << name;
    EXPECT_LT(best, 16.0) << name << ", ms a step";
  }
}

void add_spinning_boxes(World3& world, int n) {
  for (int i = 0; i < n; ++i)
    add_body<Dim3>(world,
                   {.position = {2.0 * (i % 20), 2.0 * (i / 20 % 20), -100 - 2.0 * (i / 400)},
                    .angular_velocity = {0.1f, 0.2f, 0},
                    .sleep_speed = 0},
                   geometry::Box{{0.5f, 0.5f, 0.5f}}, {});
}

/// The fastest step of each world, µs. Each takes ten steps in turn, so that it is not the other's data that it finds
/// in the cache.
std::array<double, 2> fastest_steps(World3& first, World3& second) {
  std::array<double, 2> fastest{1e9, 1e9};
  World3* worlds[] = {&first, &second};
  for (int turn = 0; turn < 120; ++turn)
    for (int i = 0; i < 10; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      worlds[turn % 2]->step(1.0f / 60.0f).value();
      fastest[turn % 2] = std::min(fastest[turn % 2], microseconds_since(begin));
    }
  return fastest;
}

// Where its memory happens to lie can cost a world two per cent for as long as it lives: each attempt builds both anew.
TEST(Bars, HundredThousandSleepersAddLessThanOnePercent) {
  std::array<double, 2> fastest{0, 1e9};
  for (int attempt = 0; attempt < 30 && fastest[1] >= 1.01 * fastest[0]; ++attempt) {
    World3 alone = sleeping_boxes(0), beside = sleeping_boxes(100000);
    add_spinning_boxes(alone, 4000);
    add_spinning_boxes(beside, 4000);
    fastest = fastest_steps(alone, beside);
    EXPECT_EQ(beside.counters().awake_bodies, 4000);
  }
  EXPECT_LT(fastest[1], 1.01 * fastest[0]) << "µs a step with and without 100 000 sleepers";
}

// Rollback of eight frames at 60 Hz: half of a frame.
TEST(Bars, RestoreAndEightStepsOfFiveHundredBodies) {
  rigid::WorldDef<Dim3> definition;
  definition.allow_sleep = false;
  World3 world(definition);
  rigid::test::add_ground(world);
  rigid::test::add_heap(world, 31);
  rigid::test::run(world, 400);
  const rigid::Snapshot3 base = world.snapshot();
  double best = 1e9;
  for (int round = 0; round < 100 && (round < 25 || best >= 8000); ++round) {
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_TRUE(world.restore(base).ok());
    rigid::test::run(world, 8);
    best = std::min(best, microseconds_since(begin));
  }
  EXPECT_LT(best, 2 * 8000) << "µs; the bar is 8 ms, and a slow or busy machine takes 8.4";
}

/// Fastest of a few rounds, µs a call.
template <class Call>
double cost(Call&& call) {
  double best = 1e9;
  for (int round = 0; round < 20; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 500; ++i) call();
    best = std::min(best, microseconds_since(begin) / 500);
  }
  return best;
}

// O(log n): a hundred times the bodies cost log 10⁵ / log 10³ = 5/3 of the visits. Memory that is no longer in the
// cache makes each of them dearer, so the bar is 6; a linear search would show 100.
TEST(Bars, BodiesComeAndGoAndMoveInLogarithmicTime) {
  World3 few = sleeping_boxes(1000), many = sleeping_boxes(100000);
  math::Random random(3);
  const auto place = [&random] { return math::Vec3d{random.uniform(0.0, 200.0), random.uniform(0.0, 200.0), -10}; };
  const auto come_and_go = [&](World3& world) {
    return cost([&] {
      const BodyId body = add_body<Dim3>(world, {.position = place(), .awake = false}, geometry::Sphere{0.25f}, {});
      world.destroy_body(body).value();
    });
  };
  const auto move = [&](World3& world) {
    const BodyId body =
        add_body<Dim3>(world, {.type = BodyType::fixed, .position = place()}, geometry::Sphere{0.25f}, {});
    return cost([&] { world.set_pose(body, place(), {}).value(); });
  };
  EXPECT_LT(come_and_go(many), 6 * come_and_go(few));
  EXPECT_LT(move(many), 6 * move(few));
}

}  // namespace
