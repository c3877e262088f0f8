// Coulomb's law on planes (mechanics.md 3, 4; rigid-body.md 6.1, 4–8).
// Short forms: the gates at full length, in every direction, are in tests/quality/friction_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

constexpr double g = 9.81;

template <class D>
class FrictionBoth : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(FrictionBoth, Dimensions);

/// Gravity leans instead of the ground: a slope of angle a, downhill in the direction th.
WorldDef<Dim3> slope(double a, double th) {
  WorldDef<Dim3> d;
  d.gravity = {float(g * std::sin(a) * std::cos(th)), float(-g * std::cos(a)), float(g * std::sin(a) * std::sin(th))};
  d.allow_sleep = false;
  return d;
}

TEST(Friction, HoldsBelowTheCriticalAngle) {
  for (int k = 0; k < 4; ++k) {
    World3 world(slope(std::atan(0.98 * 0.5), k * pi / 8));
    add_ground(world, {0.5f, 0, 1000, 0});
    const BodyId box = add_box<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.5f, 0, 1000, 0});
    run(world, 60);
    const Vec3d begin = world.state(box).value().pose.position;
    run(world, 600);
    const Vec3d moved = world.state(box).value().pose.position - begin;
    EXPECT_LT(math::length(moved), 1e-4) << "direction " << k;
  }
}

TEST(Friction, SlidesAboveTheCriticalAngleWithTheRightAcceleration) {
  const double a = std::atan(1.02 * 0.5), expected = g * (std::sin(a) - 0.5 * std::cos(a));
  for (int k = 0; k < 4; ++k) {
    World3 world(slope(a, k * pi / 8));
    add_ground(world, {0.5f, 0, 1000, 0});
    const BodyId box = add_box<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.5f, 0, 1000, 0});
    run(world, 60);
    const float v1 = speed(world, box);
    run(world, 240);
    EXPECT_NEAR((speed(world, box) - v1) / 4, expected, 0.01 * expected) << "direction " << k;
  }
}

// x = v²/(2 μ g), the same in every direction.
TEST(Friction, StopDistance) {
  double least = 1e9, most = 0;
  for (int k = 0; k < 5; ++k) {
    const double th = k * pi / 8;
    World3 world(world_with<Dim3>());
    add_ground(world, {0.5f, 0, 1000, 0});
    const BodyId box = add_box<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.5f, 0, 1000, 0});
    run(world, 60);
    const Vec3d begin = world.state(box).value().pose.position;
    ASSERT_TRUE(world.set_velocity(box, {float(5 * std::cos(th)), 0, float(5 * std::sin(th))}, {}).ok());
    run(world, 180);
    const Vec3d way = world.state(box).value().pose.position - begin;
    const double along_way = way.x * std::cos(th) + way.z * std::sin(th),
                 side = way.x * std::sin(th) - way.z * std::cos(th);
    EXPECT_NEAR(along_way, 25 / (2 * 0.5 * g), 0.01 * 2.548);
    EXPECT_NEAR(side, 0, 2e-3);
    least = std::min(least, along_way);
    most = std::max(most, along_way);
  }
  EXPECT_LT(most - least, 0.002 * 2.548);
}

TEST(Friction, StopDistanceInThePlane) {
  World2 world(world_with<Dim2>());
  add_ground(world, {0.5f, 0, 1000, 0});
  const BodyId box = add_box<Dim2>(world, {0, 0.5}, 0.5f, {0.5f, 0, 1000, 0});
  run(world, 60);
  const double begin = world.state(box).value().pose.position.x;
  ASSERT_TRUE(world.set_velocity(box, {5, 0}, 0).ok());
  run(world, 180);
  EXPECT_NEAR(world.state(box).value().pose.position.x - begin, 25 / (2 * 0.5 * g), 0.01 * 2.548);
}

// A sphere that skids comes to roll at 5/7 of its speed.
TEST(Friction, SkidToRoll) {
  World3 world(world_with<Dim3>());
  add_ground(world, {0.2f, 0, 1000, 0});
  const BodyId ball = add_ball<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.2f, 0, 1000, 0});
  run(world, 30);
  ASSERT_TRUE(world.set_velocity(ball, {5, 0, 0}, {}).ok());
  run(world, 90);
  const BodyState<Dim3> s = world.state(ball).value();
  EXPECT_NEAR(s.linear_velocity.x, 5.0 * 5 / 7, 0.005 * 3.5714);
  EXPECT_NEAR(s.angular_velocity.z, -s.linear_velocity.x / 0.5f, 0.02);
}

// Rolling down without slip: 5/7 g sin α.
TEST(Friction, SphereRollsDownAnIncline) {
  const double a = radians(15.0);
  World3 world(slope(a, 0));
  add_ground(world);
  const BodyId ball = add_ball<Dim3>(world, {0, 0.5, 0}, 0.5f);
  run(world, 30);
  const float v1 = speed(world, ball);
  run(world, 120);
  const double expected = 5.0 / 7 * g * std::sin(a);
  EXPECT_NEAR((speed(world, ball) - v1) / 2, expected, 0.005 * expected);
}

/// What a blow that takes off all of the speed `down` takes off the speed along the ground, over μ times `down`: for a
/// box that does not turn and slides all the while. `phase`: part of a step's way by which it starts higher.
template <class D>
float rubbed_off(float down, float phase) {
  constexpr float friction = 0.5f;
  World<D> world(world_with<D>(0));
  add_ground(world, {friction, 0, 1000, 0});
  const BodyId box = add_box<D>(world, at<D>(0, 2 + down / 60 * phase), 0.5f, {friction, 0, 1000, 0});
  MotionLocks locks;
  locks.rotation_x = locks.rotation_y = D::dimension == 3;
  locks.rotation_z = true;
  world.set_locks(box, locks).value();
  const float along_ground = down + 5;
  world.set_velocity(box, along<D>(along_ground, -down), {}).value();
  run(world, 60);
  EXPECT_NEAR(world.state(box).value().linear_velocity.y, 0, 0.02f * down);
  return (along_ground - world.state(box).value().linear_velocity.x) / (friction * down);
}

// Coulomb's law in impulses (mechanics.md 5.2): whenever in a step the blow falls, the ground rubs with μ times it.
TYPED_TEST(FrictionBoth, BlowsRub) {
  for (float down : {3.0f, 10.0f, 30.0f, 60.0f})
    for (int k = 0; k < 24; ++k)
      EXPECT_NEAR(rubbed_off<TypeParam>(down, k / 24.0f), 1, 0.1f) << down << " m/s, phase " << k;
}

// A disc spinning on its face under uniform pressure stops after 3 R ω₀/(4 μ g).
TEST(Friction, SpinningDiscStops) {
  World3 world(world_with<Dim3>());
  add_ground(world, {0.5f, 0, 1000, 0});
  const BodyId disc =
      add_body<Dim3>(world, BodyType::dynamic, geometry::Cylinder{0.1f, 1.0f}, {0, 0.1, 0}, {0.5f, 0, 1000, 0});
  run(world, 60);
  ASSERT_TRUE(world.set_velocity(disc, {}, {0, 20, 0}).ok());
  int steps = 0;
  while (steps < 600 && world.state(disc).value().angular_velocity.y > 0.02f) {
    world.step(frame).value();
    ++steps;
  }
  EXPECT_NEAR(steps / 60.0, 3.058, 0.03 * 3.058);
}

TEST(Friction, ConveyorCarriesAtItsSpeed) {
  World2 world(world_with<Dim2>());
  const BodyId belt = add_ground(world, {0.5f, 0, 1000, 0});
  std::vector<ShapeId> shapes;
  world.shapes(belt, shapes);
  Material m = world.shape_definition(shapes[0]).value().material;
  m.tangent_speed = 2;
  ASSERT_TRUE(world.set_material(shapes[0], m).ok());
  const BodyId box = add_box<Dim2>(world, {0, 0.5}, 0.5f, {0.5f, 0, 1000, 0});
  run(world, 10);
  const float v1 = speed(world, box);
  run(world, 12);
  EXPECT_NEAR((speed(world, box) - v1) / 0.2, 0.5 * g, 0.01 * 0.5 * g);
  run(world, 60);
  EXPECT_NEAR(speed(world, box), 2, 0.01);
}

}  // namespace
}  // namespace carom::rigid::test
