// Bodies that nothing touches (mechanics.md 2, 4, 11; rigid-body.md 6.1, 9, 20, 21).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class FreeMotion : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(FreeMotion, Dimensions);

// s = v t + ½ a t², to rounding, for any step and number of substeps.
TYPED_TEST(FreeMotion, FallIsExact) {
  using D = TypeParam;
  for (const int substeps : {1, 4, 7}) {
    WorldDef<D> d = world_with<D>(10);
    d.substeps = substeps;
    World<D> world(d);
    const BodyId ball = add_ball<D>(world, at<D>(0, 100), 0.5f, {}, along<D>(3, 5));
    for (int i = 0; i < 128; ++i) world.step(1.0f / 64).value();
    const BodyState<D> s = world.state(ball).value();
    EXPECT_NEAR(s.pose.position.x, 6, 2e-5);
    EXPECT_NEAR(s.pose.position.y, 100 + 5 * 2 - 0.5 * 10 * 4, 5e-5);
    EXPECT_NEAR(s.linear_velocity.y, 5 - 20, 1e-4);  // 896 roundings of the sum
  }
}

TYPED_TEST(FreeMotion, ForceOfOneStepGivesItsImpulse) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const BodyId box = add_box<D>(world, at<D>(0, 0), 0.5f, {0.6f, 0, 8, 0});
  const float mass = world.state(box).value().mass;
  ASSERT_TRUE(world.add_force(box, along<D>(mass * 6, 0)).ok());
  world.step(0.5f).value();
  EXPECT_NEAR(world.state(box).value().linear_velocity.x, 3, 1e-5);
  EXPECT_NEAR(world.state(box).value().pose.position.x, 0.5 * 6 * 0.25, 1e-6);
  world.step(0.5f).value();  // forces last for one step
  EXPECT_NEAR(world.state(box).value().linear_velocity.x, 3, 1e-5);
}

TYPED_TEST(FreeMotion, ImpulseAtAPointTurnsAndPushes) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const BodyId box = add_box<D>(world, at<D>(1e6, 2), 0.5f, {0.6f, 0, 1, 0});
  ASSERT_TRUE(world.add_impulse_at(box, along<D>(0, 1), at<D>(1e6 + 0.5, 2)).ok());
  const Totals<D> t = world.totals();
  EXPECT_NEAR(t.momentum.y, 1, 1e-6);
  const BodyState<D> s = world.state(box).value();
  if constexpr (D::dimension == 2)
    EXPECT_NEAR(s.angular_velocity, 0.5 * 6, 1e-5);
  else
    EXPECT_NEAR(s.angular_velocity.z, 0.5 * 6, 1e-5);
}

TYPED_TEST(FreeMotion, LockedAxesStandStill) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId box = add_box<D>(world, at<D>(0, 10));
  MotionLocks locks;
  locks.y = locks.rotation_z = true;
  ASSERT_TRUE(world.set_locks(box, locks).ok());
  ASSERT_TRUE(world.add_impulse_at(box, along<D>(1000, 0), at<D>(0, 10.4)).ok());
  run(world, 60);
  const BodyState<D> s = world.state(box).value();
  EXPECT_EQ(s.pose.position.y, 10);
  EXPECT_GT(s.pose.position.x, 0.5);
  if constexpr (D::dimension == 2)
    EXPECT_EQ(s.pose.rotation, Rot2f());
  else
    EXPECT_EQ(s.pose.rotation, Quatf());
}

// A fast wheel turns by exactly ω t: no small-angle error.
TEST(FreeRotation, FastSpinKeepsItsAngle) {
  World3 world(world_with<Dim3>(0));
  const BodyId ball = add_ball<Dim3>(world, {0, 0, 0}, 0.5f);
  const float w = 60;
  ASSERT_TRUE(world.set_velocity(ball, {}, {0, w, 0}).ok());
  run(world, 60);
  const Quatf q = world.state(ball).value().pose.rotation;
  EXPECT_NEAR(std::abs(q.w * std::cos(w / 2) + q.y * std::sin(w / 2)), 1, 1e-6);
}

// The intermediate-axis flip: I ∝ (.03333, .08667, .11333), ω (.01, 5, .01). By elliptic functions ω_y changes sign
// first at 2.8426 s and then every 5.02479 s: 12 times in a minute. Energy and angular momentum are constant.
TEST(FreeRotation, IntermediateAxisFlip) {
  World3 world(world_with<Dim3>(0));
  BodyDef<Dim3> d;
  d.angular_velocity = {0.01f, 5, 0.01f};
  const BodyId body = world.create_body(d).value();
  // Sides 1 × .6 × .2 about axes so that the moments rise x, y, z.
  ASSERT_TRUE(world.add_shape(body, geometry::Box{{0.5f, 0.3f, 0.1f}}).ok());
  const Totals<Dim3> before = world.totals();
  double first = 0;
  int flips = 0;
  float last = 5;
  double lowest = 1e30, highest = 0, worst_angle = 0;
  for (int i = 0; i < 3600; ++i) {
    world.step(frame).value();
    const BodyState<Dim3> s = world.state(body).value();
    const float wy = inverse_rotate(s.pose.rotation, s.angular_velocity).y;
    if (wy * last < 0) {
      if (++flips == 1) first = (i + 1) / 60.0;
    }
    last = wy;
    const Totals<Dim3> t = world.totals();
    lowest = std::min(lowest, t.kinetic_energy);
    highest = std::max(highest, t.kinetic_energy);
    worst_angle = std::max(worst_angle, math::length(cross(t.angular_momentum, before.angular_momentum)) /
                                            (math::length(t.angular_momentum) * math::length(before.angular_momentum)));
  }
  EXPECT_EQ(flips, 12);
  EXPECT_NEAR(first, 2.8426, 0.03);
  EXPECT_LT((highest - lowest) / before.kinetic_energy, 2e-3);
  EXPECT_LT(worst_angle, 1e-3);
}

// Bodies of the plane go through a substep side by side where there are enough of them: each as if it were alone, to
// the bit, also the fastest, who is damped, who is moved by hand and who stands beside one with a lock.
TEST(FreeMotionInLanes, CompanyChangesNothing) {
  const auto definition = [](int i) {
    BodyDef<Dim2> d;
    d.type = i % 11 == 5 ? BodyType::kinematic : BodyType::dynamic;
    d.position = {3, 100.0 * i};  // nobody comes near anybody
    d.linear_velocity = {i == 7 ? 900.0f : 0.3f * float(i), 2 - 0.1f * float(i)};
    d.angular_velocity = i == 9 ? 4000.0f : 0.7f * float(i - 20);
    d.linear_damping = i % 3 == 0 ? 0.2f : 0;
    d.angular_damping = i % 4 == 0 ? 0.3f : 0;
    d.locks.x = i == 40;
    return d;
  };
  WorldDef<Dim2> world_definition = world_with<Dim2>();
  world_definition.maximum_linear_speed = 300;
  constexpr int count = 50;  // three times sixteen and two, of which a lock spoils one sixteen
  World<Dim2> all(world_definition);
  std::vector<BodyId> bodies;
  const auto add = [](World<Dim2>& world, const BodyDef<Dim2>& d) {
    const BodyId body = world.create_body(d).value();
    world.add_shape(body, box_shape<Dim2>(0.5f, 0.25f, 0)).value();
    return body;
  };
  for (int i = 0; i < count; ++i) bodies.push_back(add(all, definition(i)));
  for (int step = 0; step < 30; ++step) all.step(frame).value();
  for (int i = 0; i < count; ++i) {
    World<Dim2> alone(world_definition);
    const BodyId body = add(alone, definition(i));
    for (int step = 0; step < 30; ++step) alone.step(frame).value();
    const BodyState<Dim2> one = alone.state(body).value(), other = all.state(bodies[std::size_t(i)]).value();
    EXPECT_EQ(one.pose, other.pose) << i;
    EXPECT_EQ(one.linear_velocity, other.linear_velocity) << i;
    EXPECT_EQ(one.angular_velocity, other.angular_velocity) << i;
  }
}

}  // namespace
}  // namespace carom::rigid::test
