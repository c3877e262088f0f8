// Characters that are bodies: they walk, climb, ride, push and are pushed, in the plane and in space.
#include "carom/rigid/dynamic_character.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace dynamic_character_test {

template <class D>
class DynamicCharacters : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(DynamicCharacters, Dimensions);

template <class D>
DynamicCharacter<D> make(World<D>& world, typename D::Position feet, const DynamicCharacterDef<D>& d = {}) {
  return DynamicCharacter<D>::create(world, d, feet).value();
}
template <class D>
void walk(World<D>& world, DynamicCharacter<D>& c, typename D::Vector velocity, int steps) {
  for (int i = 0; i < steps; ++i) {
    c.move(world, velocity, frame).value();
    world.step(frame).value();
  }
}
template <class D>
BodyId add_ramp(World<D>& world, double angle) {
  BodyDef<D> ramp;
  ramp.type = BodyType::fixed;
  ramp.position = at<D>(std::sin(angle), -std::cos(angle));  // its upper face passes through the origin
  ramp.rotation = turned<D>(angle);
  const BodyId id = world.create_body(ramp).value();
  world.add_shape(id, box_shape<D>(60, 1, 5)).value();
  return id;
}

TYPED_TEST(DynamicCharacters, ReachesItsSpeedByTheForceOfItsLegs) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  DynamicCharacterDef<D> d;
  d.leg_force = 400;  // 5 m/s² for 80 kg
  auto c = make<D>(world, at<D>(0, 0), d);
  walk(world, c, {}, 20);
  ASSERT_EQ(c.ground().state, GroundState::on_ground);
  walk(world, c, along<D>(3, 0), 18);
  EXPECT_NEAR(c.velocity(world).x, 5 * 18 * frame, 0.02);
  walk(world, c, along<D>(3, 0), 60);
  const auto begin = c.feet(world);
  walk(world, c, along<D>(3, 0), 120);
  EXPECT_NEAR(c.feet(world).x - begin.x, 6, 0.01);
  EXPECT_NEAR(c.feet(world).y, 0, 0.005);
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.velocity(world).x, 0, 1e-3) << "and stands";
}

// A jump of v rises to v²/2g.
TYPED_TEST(DynamicCharacters, JumpsToItsHeight) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 0));
  walk(world, c, {}, 20);
  const double low = c.feet(world).y;
  double top = 0;
  for (int i = 0; i < 90; ++i) {
    walk(world, c, along<D>(0, i == 0 ? 5.0f : 0.0f), 1);
    top = std::max(top, c.feet(world).y);
  }
  EXPECT_NEAR(top - low, 25 / (2 * 9.81), 0.02 * 25 / (2 * 9.81));
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
}

TYPED_TEST(DynamicCharacters, ClimbsStairsOfThirtyCentimetresAndNotOfSixty) {
  using D = TypeParam;
  for (const double rise : {0.15, 0.3, 0.6}) {
    World<D> world(world_with<D>());
    add_ground(world);
    for (int i = 0; i < 5; ++i)  // treads of .5 m
      add_body<D>(world, BodyType::fixed, box_shape<D>(5, 0.5f, 2), at<D>(6 + 0.5 * i, -0.5 + rise * (i + 1)));
    auto c = make<D>(world, at<D>(0, 0));
    walk(world, c, along<D>(2, 0), 420);
    if (rise < 0.5) {
      EXPECT_NEAR(c.feet(world).y, 5 * rise, 0.01) << "on the top";
      EXPECT_GT(c.feet(world).x, 4);
      walk(world, c, along<D>(-2, 0), 480);
      EXPECT_NEAR(c.feet(world).y, 0, 0.01) << "and down again";
      EXPECT_LT(c.feet(world).x, 0.5);
    } else {
      EXPECT_NEAR(c.feet(world).y, 0, 0.01);
      EXPECT_LT(c.feet(world).x, 0.71) << "stands at the first";
    }
  }
}

TYPED_TEST(DynamicCharacters, StaysOnTheGroundDownStairsAndSlopes) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  for (int i = 0; i < 12; ++i)
    add_body<D>(world, BodyType::fixed, box_shape<D>(0.5f, 5, 2), at<D>(double(i), -5 - 0.2 * i));
  auto c = make<D>(world, at<D>(0, 0));
  walk(world, c, {}, 20);
  for (int i = 0; i < 150; ++i) {
    walk(world, c, along<D>(3, 0), 1);
    ASSERT_EQ(c.ground().state, GroundState::on_ground) << "step " << i;
  }
  EXPECT_GT(c.feet(world).x, 5);
}

TYPED_TEST(DynamicCharacters, SlopesUpToTheLimitCarry) {
  using D = TypeParam;
  for (const double degrees_ : {20.0, 45.0}) {
    World<D> world(world_with<D>());
    const double a = math::radians(degrees_);
    add_ramp(world, a);
    auto c = make<D>(world, at<D>(0, 0.2));
    walk(world, c, {}, 60);
    EXPECT_EQ(c.ground().state, GroundState::on_ground) << degrees_;
    EXPECT_NEAR(c.ground().slope, a, 0.01);
    const auto rest = c.feet(world);
    walk(world, c, {}, 180);
    EXPECT_LT(math::length(c.feet(world) - rest), 2e-3) << "stands on the slope " << degrees_;
    walk(world, c, along<D>(2, 0), 60);
    const auto begin = c.feet(world);
    walk(world, c, along<D>(2, 0), 60);
    EXPECT_NEAR(math::length(c.feet(world) - begin), 2, 0.02) << "the speed is that along the slope";
    EXPECT_GT(c.feet(world).y, begin.y);
  }
}

// Without friction a body on a slope gains g sin α along it.
TYPED_TEST(DynamicCharacters, SlidesDownWhatIsTooSteep) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const double a = math::radians(60.0);
  add_ramp(world, a);
  auto c = make<D>(world, at<D>(10, 10 * std::tan(a) + 0.4));
  walk(world, c, {}, 30);
  EXPECT_EQ(c.ground().state, GroundState::on_steep);
  const auto v0 = c.velocity(world);
  walk(world, c, along<D>(2, 0), 30);  // nor does it help to walk against it
  const float gained = math::length(c.velocity(world)) - math::length(v0);
  EXPECT_NEAR(gained, 0.5 * 9.81 * std::sin(a), 0.05 * 0.5 * 9.81 * std::sin(a));
  EXPECT_LT(c.velocity(world).y, v0.y);
}

TYPED_TEST(DynamicCharacters, RidesPlatformsAndLifts) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  BodyDef<D> d;
  d.type = BodyType::kinematic;
  d.position = at<D>(0, -0.5);
  const BodyId lift = world.create_body(d).value();
  world.add_shape(lift, box_shape<D>(3, 0.5f, 3)).value();
  auto c = make<D>(world, at<D>(0.5, 0));
  walk(world, c, {}, 20);
  const auto place = [&] { return c.feet(world) - world.state(lift).value().pose.position; };
  for (const auto& velocity : {along<D>(2, 0), along<D>(0, 1.5f), along<D>(-1, -2), along<D>(0, -3)}) {
    world.set_velocity(lift, velocity, {}).value();
    walk(world, c, {}, 30);  // it takes the legs a moment
    const auto before = place();
    walk(world, c, {}, 60);
    EXPECT_LT(math::length(place() - before), 0.01);
    EXPECT_EQ(c.ground().state, GroundState::on_ground);
    EXPECT_LT(math::length(c.velocity(world) - velocity), 0.02f);
  }
}

TEST(DynamicCharacters3, RidesATurntable) {
  World3 world(world_with<Dim3>());
  BodyDef<Dim3> d;
  d.type = BodyType::kinematic;
  d.position = {0, -0.5, 0};
  d.angular_velocity = {0, 1, 0};
  const BodyId table = world.create_body(d).value();
  world.add_shape(table, geometry::Cylinder{0.5f, 4}).value();
  auto c = make<Dim3>(world, {2, 0, 0});
  walk(world, c, {}, 120);
  EXPECT_NEAR(std::hypot(c.feet(world).x, c.feet(world).z), 2, 0.15) << "nearly on its circle";
  EXPECT_NEAR(math::length(c.velocity(world)), 2, 0.15);
}

// A belt of 1.5 m/s carries what stands on it.
TYPED_TEST(DynamicCharacters, IsCarriedByABelt) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId ground = world.create_body({.type = BodyType::fixed, .position = at<D>(0, -1)}).value();
  ShapeDef<D> belt;
  belt.surface_velocity = along<D>(1.5f, 0);
  world.add_shape(ground, box_shape<D>(100, 1, 5), belt).value();
  auto c = make<D>(world, at<D>(0, 0));
  walk(world, c, {}, 90);
  EXPECT_NEAR(c.velocity(world).x, 1.5, 0.01);
}

// Perfectly inelastic on ice: 100 kg at 3 m/s and 80 kg at rest go on together at 300/180 m/s. With legs it is pushed
// back too, and then holds.
TYPED_TEST(DynamicCharacters, IsPushedByABoxOfAHundredKilograms) {
  using D = TypeParam;
  for (const bool braces : {false, true}) {
    World<D> world(world_with<D>());
    add_ground(world, {0, 0, 1000, 0});
    // 1 m wide: 100 kg in either dimension.
    const BodyId box = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.5f, 0.5f), at<D>(-2, 0.5),
                                   {0, 0, 100, 0}, along<D>(3, 0));
    ASSERT_NEAR(world.state(box).value().mass, 100, 0.1);
    MotionLocks upright;
    upright.rotation_x = upright.rotation_y = upright.rotation_z = true;
    world.set_locks(box, upright).value();
    DynamicCharacterDef<D> d;
    d.leg_force = braces ? 600 : 0;
    auto c = make<D>(world, at<D>(0, 0), d);
    walk(world, c, {}, 120);
    const float v = c.velocity(world).x;
    if (braces) {
      // From 300 N·s the legs take 600 N for as long as it lasts: it stands again after half a second.
      EXPECT_NEAR(v, 0, 0.02);
      EXPECT_GT(c.feet(world).x, 0.2) << "it was pushed back";
      EXPECT_LT(c.feet(world).x, 1.0);
    } else {
      EXPECT_NEAR(v, 300.0 / 180, 0.02);
      EXPECT_NEAR(world.state(box).value().linear_velocity.x, 300.0 / 180, 0.02);
    }
  }
}

// F = (m + M) a on ice, and none where friction holds more than the legs can do.
TYPED_TEST(DynamicCharacters, PushesWithItsForce) {
  using D = TypeParam;
  for (const bool ice : {true, false}) {
    World<D> world(world_with<D>());
    const float friction = ice ? 0.0f : 0.6f;
    add_ground(world, {friction, 0, 1000, 0});
    const BodyId box = add_box<D>(world, at<D>(1, 0.5), 0.5f, {friction, 0, 200, 0});
    DynamicCharacterDef<D> d;
    d.leg_force = 500;
    auto c = make<D>(world, at<D>(0.19, 0), d);
    walk(world, c, along<D>(3, 0), 30);
    const double x = world.state(box).value().pose.position.x;
    const float v1 = world.state(box).value().linear_velocity.x;
    walk(world, c, along<D>(3, 0), 30);
    const float v2 = world.state(box).value().linear_velocity.x;
    if (ice) {
      EXPECT_NEAR((v2 - v1) / 0.5f, 500.0 / 280, 0.03 * 500 / 280);
      walk(world, c, along<D>(3, 0), 240);
      EXPECT_NEAR(world.state(box).value().linear_velocity.x, 3, 0.05) << "no faster than it walks";
    } else {
      EXPECT_NEAR(world.state(box).value().pose.position.x, x, 2e-3) << "500 N against 1 177 N of friction";
    }
  }
}

// Who walks on a cart that rolls freely pushes it back: the momentum of both stays nought.
TYPED_TEST(DynamicCharacters, TheGroundGetsTheOppositeForce) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world, {0, 0, 1000, 0});
  const BodyId cart =
      add_body<D>(world, BodyType::dynamic, box_shape<D>(4, 0.25f, 0.5f), at<D>(0, 0.25), {0, 0, 50, 0});
  const float mass = world.state(cart).value().mass;
  auto c = make<D>(world, at<D>(0, 0.5));
  walk(world, c, {}, 30);
  walk(world, c, along<D>(2, 0), 40);
  const float v = c.velocity(world).x, back = world.state(cart).value().linear_velocity.x;
  EXPECT_NEAR(v - back, 2, 0.05) << "relative to the cart it walks 2 m/s";
  EXPECT_NEAR(80 * v + mass * back, 0, 1);
  EXPECT_LT(back, -0.3f);
}

TYPED_TEST(DynamicCharacters, SameBitsWhateverTheThreadsAndAfterARollback) {
  using D = TypeParam;
  std::uint64_t hash[3];
  for (const int threads : {1, 2}) {
    WorldDef<D> d = world_with<D>();
    d.threads = threads;
    World<D> world(d);
    add_ground(world);
    add_heap(world, 3);
    auto c = make<D>(world, at<D>(-6, 0));
    walk(world, c, along<D>(2.5f, 0), 120);
    Snapshot<D> snapshot;
    world.snapshot(snapshot);
    const DynamicCharacterState<D> state = c.state();
    walk(world, c, along<D>(2.5f, 0), 120);
    hash[threads - 1] = world.state_hash();
    ASSERT_TRUE(world.restore(snapshot).ok());
    c.restore(state);
    walk(world, c, along<D>(2.5f, 0), 120);
    hash[2] = world.state_hash();
    EXPECT_EQ(hash[2], hash[threads - 1]);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TYPED_TEST(DynamicCharacters, RefusesWhatIsNotANumber) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 0));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(c.move(world, along<D>(nan, 0), frame).ok());
  EXPECT_FALSE(c.move(world, along<D>(1, 0), 0).ok());
  EXPECT_FALSE(c.teleport(world, at<D>(double(nan), 0)).ok());
  DynamicCharacterDef<D> bad;
  bad.mass = 0;
  EXPECT_FALSE(DynamicCharacter<D>::create(world, bad, at<D>(0, 0)).ok());
  bad = {};
  bad.up = along<D>(0, 2);
  EXPECT_FALSE(DynamicCharacter<D>::create(world, bad, at<D>(0, 0)).ok());
  c.destroy(world).value();
  EXPECT_FALSE(c.move(world, along<D>(1, 0), frame).ok());
}

}  // namespace dynamic_character_test
}  // namespace carom::rigid::test
