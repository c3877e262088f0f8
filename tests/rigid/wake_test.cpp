// Sleepers wake when something reaches them.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Wake : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Wake, Dimensions);

// A pendulum stands still at its turning points, a hinge's motor turns slowly, and a box on a slope just beyond its
// angle of friction begins by creeping: none of them may freeze.
TYPED_TEST(Wake, WhatGoesOnStaysAwake) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId post = add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 0.1f, 0.1f), at<D>(0, 9));
  const auto hang = [&](double x, float speed) {
    const BodyId bob = add_box<D>(world, at<D>(x, 8), 0.1f);
    HingeJointDef<D> def;
    def.body_a = post;
    def.body_b = bob;
    def.frame_a.p = along<D>(float(x), 0);
    def.frame_b.p = along<D>(0, 1);
    if (speed > 0) def.motor = {true, speed, 1e4f};
    world.create_joint(def).value();
    return bob;
  };
  const BodyId pendulum = hang(-4, 0), slow = hang(4, 0.2f);
  world.set_velocity(pendulum, along<D>(0.6f, 0), {}).value();
  WorldDef<D> tilted = world_with<D>();
  tilted.gravity = along<D>(9.81f * math::sin(0.55f), -9.81f * math::cos(0.55f));  // tan .55 = .613
  World<D> slope(tilted);
  add_ground(slope);
  const BodyId sliding = add_box<D>(slope, at<D>(0, 0.5));
  for (int i = 0; i < 600; ++i) {
    run(world, 1);
    run(slope, 1);
    ASSERT_TRUE(world.state(pendulum).value().awake) << i;
    ASSERT_TRUE(world.state(slow).value().awake) << i;
    ASSERT_TRUE(slope.state(sliding).value().awake) << i;
  }
  EXPECT_GT(slope.state(sliding).value().pose.position.x, 1);
}

// A neighbour within the margin has a manifold before it touches: it falls asleep by itself, and must still wake when
// the other comes on.
TYPED_TEST(Wake, ByANeighborThatWasCloseAllAlong) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.gravity = {};
  World<D> world(d);
  const BodyId sleeper = add_box<D>(world, at<D>(0, 0));
  BodyDef<D> restless;
  restless.position = at<D>(1.012, 0);
  restless.allow_sleep = false;
  const BodyId other = world.create_body(restless).value();
  world.add_shape(other, box_shape<D>(0.5f, 0.5f, 0.5f)).value();
  run(world, 60);
  ASSERT_FALSE(world.state(sleeper).value().awake);
  ASSERT_TRUE(world.state(other).value().awake);
  typename D::Vector v{};
  v.x = -0.1f;
  world.set_velocity(other, v, {}).value();
  run(world, 120);
  // Without restitution they go on together, and keep the momentum.
  EXPECT_TRUE(world.state(sleeper).value().awake);
  EXPECT_NEAR(world.state(sleeper).value().linear_velocity.x, -0.05, 3e-3);
  EXPECT_NEAR(world.state(other).value().linear_velocity.x, -0.05, 3e-3);
  EXPECT_LT(world.worst_penetration(), 0.006f);
}

}  // namespace
}  // namespace carom::rigid::test
