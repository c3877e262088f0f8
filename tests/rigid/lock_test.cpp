// Locked degrees of freedom stay still, whatever pushes.
#include <gtest/gtest.h>

#include "carom/carom.h"

namespace carom::test::locks {

TEST(MotionLocks, ASphereWithLockedXOnASlopeHasNoVelocityAlongX) {
  World3 world;
  const float angle = 0.3f;
  const auto slope = world.create_body({.type = rigid::BodyType::fixed}).value();
  world.add_shape(slope, geometry::Plane{math::normalize(math::Vec3f{angle, 1, 0})}).value();
  const auto ball = world.create_body({.position = {0, 0.55, 0}, .locks = {.x = true}}).value();
  world.add_shape(ball, geometry::Sphere{0.5f}).value();
  for (int step = 0; step < 60; ++step) {
    world.step(1.0f / 60.0f).value();
    const auto state = world.state(ball).value();
    ASSERT_EQ(state.linear_velocity.x, 0.0f) << "step " << step;
    ASSERT_EQ(state.pose.position.x, 0.0) << "step " << step;
  }
}

TEST(MotionLocks, ABoxWithLockedTurningStandsOnItsEdge) {
  World2 world;
  const auto ground = world.create_body({.type = rigid::BodyType::fixed}).value();
  world.add_shape(ground, geometry::make_box2({10, 1})).value();
  const auto box =
      world.create_body({.position = {0, 1.8}, .rotation = {0.8f, 0.6f}, .locks = {.rotation_z = true}}).value();
  world.add_shape(box, geometry::make_box2({0.5f, 0.5f})).value();
  for (int step = 0; step < 60; ++step) world.step(1.0f / 60.0f).value();
  const auto state = world.state(box).value();
  EXPECT_EQ(state.angular_velocity, 0.0f);
  EXPECT_EQ(state.pose.rotation, (math::Rot2f{0.8f, 0.6f}));
}

}  // namespace carom::test::locks
