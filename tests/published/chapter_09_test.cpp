// Chapter 9, the hovercraft of the plane: turning, running straight, drifting. Source: mechanics.md chapter 9.2 (C).
#include <gtest/gtest.h>

#include "carom/forces/drag.h"
#include "carom/math/elementary.h"
#include "carom/rigid/world.h"

namespace carom::published {
namespace chapter_09_test {

using namespace carom::rigid;
constexpr float frame = 1.0f / 60;

struct Hovercraft {
  World2 world;
  BodyId body;
  double mass = 0, inertia = 0;
  Hovercraft() : world({.gravity = {}, .allow_sleep = false}) {
    body = world.create_body({}).value();
    world.add_shape(body, geometry::make_box2({1.5f, 0.75f}), {.density = 100}).value();
    const auto m = world.mass_properties2(body).value();
    mass = m.mass;
    inertia = m.inertia;
  }
  void thrust(Vec2f point, Vec2f force) {
    Thrust<Dim2> e;
    e.body = body;
    e.point = point;
    e.force = force;
    world.add_effector(e).value();
  }
  double heading() const {
    const Rot2f q = world.state(body).value().pose.rotation;
    return math::atan2(double(q.s), double(q.c));
  }
  void run(double seconds) {
    for (int i = 0; i < int(seconds * 60 + 0.5); ++i) world.step(frame).value();
  }
};

TEST(Chapter09, ConstantCoupleTurnsByHalfNOverITSquared) {
  Hovercraft craft;
  craft.thrust({1, 0}, {0, 20});
  craft.thrust({-1, 0}, {0, -20});  // N = 40 N·m, no net force
  craft.run(2);
  const double expected = 0.5 * (40 / craft.inertia) * 4;
  ASSERT_LT(expected, 3);
  // Substeps of 1/240 s turn with the new velocity: ψ is (1 + h/t) of the closed form.
  EXPECT_NEAR(craft.heading(), expected, 0.003 * expected);
  EXPECT_NEAR(craft.world.state(craft.body).value().angular_velocity, 40 / craft.inertia * 2, 1e-4);
  EXPECT_NEAR(math::length(craft.world.state(craft.body).value().linear_velocity), 0, 1e-4);
}

TEST(Chapter09, StraightThrustWithLinearDragFollowsChapter4) {
  Hovercraft craft;
  craft.thrust({-1.5f, 0}, {900, 0});
  LinearDrag<Dim2> drag;
  drag.body = craft.body;
  drag.coefficient = 60;
  craft.world.add_effector(drag).value();
  craft.run(10);
  const forces::Run run = forces::thrust_against_linear_drag(craft.mass, 900, 60, 0, 10);
  const BodyState<Dim2> state = craft.world.state(craft.body).value();
  EXPECT_NEAR(state.linear_velocity.x, run.speed, 1e-4 * run.speed);
  EXPECT_NEAR(state.pose.position.x, run.distance, 1e-4 * run.distance);
  EXPECT_NEAR(craft.heading(), 0, 1e-9);
}

TEST(Chapter09, WithoutLateralForceHeadingIsNotTrack) {
  Hovercraft craft;
  craft.world.set_velocity(craft.body, {10, 0}, 0).value();
  craft.thrust({1, 0}, {0, 30});
  craft.thrust({-1, 0}, {0, -30});
  craft.run(1);
  const BodyState<Dim2> state = craft.world.state(craft.body).value();
  const double track = math::atan2(double(state.linear_velocity.y), double(state.linear_velocity.x));
  EXPECT_NEAR(track, 0, 1e-5) << "nothing pushes sideways, so it flies on as it flew";
  EXPECT_GT(craft.heading(), 0.05) << "while the bow turns";
}

}  // namespace chapter_09_test
}  // namespace carom::published
