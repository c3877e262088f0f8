// Characters walk, climb, ride and push, in the plane and in space.
#include "carom/rigid/character.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carom/geometry/triangle_mesh.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace character_test {

template <class D>
class Characters : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Characters, Dimensions);

template <class D>
typename D::Rotation leaning(double angle) {
  return turned<D>(angle);
}
template <class D>
Character<D> make(World<D>& world, typename D::Position feet, const CharacterDef<D>& d = {}) {
  return Character<D>::create(world, d, feet).value();
}
template <class D>
void walk(World<D>& world, Character<D>& c, typename D::Vector velocity, int steps) {
  for (int i = 0; i < steps; ++i) {
    c.move(world, velocity, frame).value();
    world.step(frame).value();
  }
}

TYPED_TEST(Characters, WalksExactlyAsFarAsItSays) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 0.01));
  walk(world, c, {}, 10);
  ASSERT_EQ(c.ground().state, GroundState::on_ground);
  const auto begin = c.feet();
  walk(world, c, along<D>(3, 0), 120);
  EXPECT_NEAR(c.feet().x - begin.x, 6, 1e-5);
  EXPECT_NEAR(c.feet().y, 0.01, 1e-4) << "the skin above the ground";
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
  EXPECT_NEAR(c.velocity().x, 3, 1e-4);
}

TYPED_TEST(Characters, FallsAsABodyFalls) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 20));
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.feet().y, 20 - 0.5 * 9.81, 1e-3);
  EXPECT_EQ(c.ground().state, GroundState::in_air);
  walk(world, c, {}, 120);
  EXPECT_NEAR(c.feet().y, 0.01, 1e-4);
}

// A jump of v rises to v²/2g.
TYPED_TEST(Characters, JumpsToItsHeight) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 0.01));
  walk(world, c, {}, 5);
  double top = 0;
  for (int i = 0; i < 90; ++i) {
    walk(world, c, along<D>(1, i == 0 ? 5.0f : 0.0f), 1);
    top = std::max(top, c.feet().y);
  }
  EXPECT_NEAR(top - 0.01, 25 / (2 * 9.81), 0.005);
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
  EXPECT_NEAR(c.feet().x, 1.5, 1e-3);
}

TYPED_TEST(Characters, ClimbsStairsOfThirtyCentimetresAndNotOfSixty) {
  using D = TypeParam;
  for (const double rise : {0.3, 0.6}) {
    World<D> world(world_with<D>());
    add_ground(world);
    for (int i = 0; i < 5; ++i)  // treads of .5 m
      add_body<D>(world, BodyType::fixed, box_shape<D>(5, 0.5f, 2), at<D>(6 + 0.5 * i, -0.5 + rise * (i + 1)));
    auto c = make<D>(world, at<D>(0, 0.01));
    walk(world, c, along<D>(2, 0), 240);
    if (rise < 0.5) {
      EXPECT_NEAR(c.feet().y, 1.51, 0.01) << "on the top";
      EXPECT_NEAR(c.feet().x, 8, 0.15) << "hardly slower than on the flat";
      walk(world, c, along<D>(-2, 0), 270);
      EXPECT_NEAR(c.feet().y, 0.01, 0.01) << "and down again";
    } else {
      EXPECT_NEAR(c.feet().y, 0.01, 0.01);
      EXPECT_NEAR(c.feet().x, 1 - 0.31, 1e-3) << "stands at the first";
    }
  }
}

TYPED_TEST(Characters, StaysOnTheGroundDownStairsAndSlopes) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  for (int i = 0; i < 8; ++i)
    add_body<D>(world, BodyType::fixed, box_shape<D>(0.5f, 5, 2), at<D>(double(i), -5 - 0.3 * i));
  auto c = make<D>(world, at<D>(0, 0.01));
  walk(world, c, {}, 5);
  for (int i = 0; i < 120; ++i) {
    walk(world, c, along<D>(3, 0), 1);
    ASSERT_EQ(c.ground().state, GroundState::on_ground) << "step " << i;
  }
}

TYPED_TEST(Characters, SlopesUpToTheLimitCarry) {
  using D = TypeParam;
  for (const double degrees_ : {30.0, 45.0, 55.0, 70.0}) {
    World<D> world(world_with<D>());
    add_ground(world);
    const double a = math::radians(degrees_);
    // A ramp whose upper face passes through (2, 0).
    BodyDef<D> ramp;
    ramp.type = BodyType::fixed;
    ramp.position = at<D>(2 + 10 * std::cos(a) + std::sin(a), 10 * std::sin(a) - std::cos(a));
    ramp.rotation = leaning<D>(a);
    const BodyId id = world.create_body(ramp).value();
    world.add_shape(id, box_shape<D>(12, 1, 5)).value();
    auto c = make<D>(world, at<D>(0, 0.01));
    walk(world, c, along<D>(2, 0), 240);
    if (degrees_ < 50) {
      EXPECT_GT(c.feet().y, 2.0) << degrees_;
      EXPECT_EQ(c.ground().state, GroundState::on_ground) << degrees_;
      EXPECT_NEAR(c.ground().slope, a, 0.01) << degrees_;
      const auto rest = c.feet();
      walk(world, c, {}, 120);
      EXPECT_LT(math::length(c.feet() - rest), 1e-4) << "stands on the slope";
    } else {
      EXPECT_LT(c.feet().y, 0.2) << degrees_;
    }
  }
}

TYPED_TEST(Characters, SlidesOffWhatIsTooSteep) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const double a = math::radians(65.0);
  BodyDef<D> ramp;
  ramp.type = BodyType::fixed;
  ramp.position = at<D>(std::sin(a), -std::cos(a));
  ramp.rotation = leaning<D>(a);
  const BodyId id = world.create_body(ramp).value();
  world.add_shape(id, box_shape<D>(12, 1, 5)).value();
  auto c = make<D>(world, at<D>(-0.5, 0.3));
  walk(world, c, {}, 30);
  const double y = c.feet().y;
  EXPECT_EQ(c.ground().state, GroundState::on_steep);
  walk(world, c, {}, 30);
  EXPECT_LT(c.feet().y, y - 0.3);
}

// A wall at 30° to the way leaves v cos 30° along it.
TEST(Characters3, SlidesAlongAWallAtTheRightSpeed) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  BodyDef<Dim3> wall;
  wall.type = BodyType::fixed;
  wall.position = {5, 0, 0};
  const double a = math::radians(60.0);  // the wall's normal is turned so far from −x
  wall.rotation = {float(std::cos(a / 2)), 0, float(std::sin(a / 2)), 0};
  const BodyId id = world.create_body(wall).value();
  world.add_shape(id, geometry::Box{{0.5f, 3, 50}}).value();
  auto c = make<Dim3>(world, {0, 0.01, 0});
  walk(world, c, {3, 0, 0}, 120);
  const Vec3d begin = c.feet();
  walk(world, c, {3, 0, 0}, 60);
  EXPECT_NEAR(math::length(c.feet() - begin), 3 * std::sin(a), 1e-3);
}

TEST(Characters3, StandsStillInACornerOfThreeWalls) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  for (const double turn : {0.0, 70.0, -65.0}) {
    BodyDef<Dim3> wall;
    wall.type = BodyType::fixed;
    const double a = math::radians(turn);
    wall.position = {2 * std::cos(a), 0, -2 * std::sin(a)};
    wall.rotation = {float(std::cos(a / 2)), 0, float(std::sin(a / 2)), 0};
    const BodyId id = world.create_body(wall).value();
    world.add_shape(id, geometry::Box{{0.5f, 3, 5}}).value();
  }
  auto c = make<Dim3>(world, {0, 0.01, 0});
  walk(world, c, {4, 0, 0.7f}, 120);
  for (int i = 0; i < 120; ++i) {
    const Vec3d before = c.feet();
    walk(world, c, {4, 0, 0.7f}, 1);
    EXPECT_LT(math::length(c.feet() - before), 1e-4) << "step " << i;
  }
}

TYPED_TEST(Characters, RidesPlatforms) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  BodyDef<D> d;
  d.type = BodyType::kinematic;
  d.position = at<D>(0, -0.5);
  const BodyId lift = world.create_body(d).value();
  world.add_shape(lift, box_shape<D>(3, 0.5f, 3)).value();
  auto c = make<D>(world, at<D>(0.5, 0.01));
  walk(world, c, {}, 5);
  const auto place = [&] { return c.feet() - world.state(lift).value().pose.position; };
  for (const auto& velocity : {along<D>(2, 0), along<D>(0, 1.5f), along<D>(-1, -2), along<D>(0, -4)}) {
    world.set_velocity(lift, velocity, {}).value();
    const auto before = place();
    walk(world, c, {}, 60);
    EXPECT_LT(math::length(place() - before), 0.01);
    EXPECT_EQ(c.ground().state, GroundState::on_ground);
    EXPECT_LT(math::length(c.ground().velocity - velocity), 1e-3f);
  }
}

TEST(Characters3, RidesATurntable) {
  World3 world(world_with<Dim3>());
  BodyDef<Dim3> d;
  d.type = BodyType::kinematic;
  d.position = {0, -0.5, 0};
  d.angular_velocity = {0, 1, 0};
  const BodyId table = world.create_body(d).value();
  world.add_shape(table, geometry::Cylinder{0.5f, 4}).value();
  auto c = make<Dim3>(world, {2, 0.01, 0});
  walk(world, c, {}, 120);
  EXPECT_NEAR(std::hypot(c.feet().x, c.feet().z), 2, 0.01) << "on its circle";
  const double angle = std::atan2(-c.feet().z, c.feet().x);
  EXPECT_NEAR(angle, 2 - 1.0 / 60, 0.02) << "one move stands before it knows its ground";
}

// F t/m on ice, and no motion where friction μ m g holds F.
TYPED_TEST(Characters, PushesWithItsForce) {
  using D = TypeParam;
  for (const bool ice : {true, false}) {
    World<D> world(world_with<D>());
    const float friction = ice ? 0.0f : 0.6f;
    add_ground(world, {friction, 0, 1000, 0});
    const BodyId box = add_box<D>(world, at<D>(1, 0.5), 0.5f, {friction, 0, 200, 0});
    auto c = make<D>(world, at<D>(0.15, 0.01));
    const float mass = world.state(box).value().mass;
    ASSERT_NEAR(mass, 200, 1);
    walk(world, c, {}, 30);
    walk(world, c, along<D>(3, 0), 30);
    const float v1 = world.state(box).value().linear_velocity.x;
    const double x1 = world.state(box).value().pose.position.x;
    walk(world, c, along<D>(3, 0), 30);
    const float v2 = world.state(box).value().linear_velocity.x;
    if (ice) {
      EXPECT_NEAR((v2 - v1) / 0.5f, 500 / mass, 0.02f * 500 / mass);
      walk(world, c, along<D>(3, 0), 120);
      EXPECT_NEAR(world.state(box).value().linear_velocity.x, 3, 0.05) << "no faster than it walks";
    } else {
      EXPECT_NEAR(world.state(box).value().pose.position.x, x1, 1e-3) << "500 N against 1 177 N of friction";
    }
    EXPECT_LT(c.feet().x, world.state(box).value().pose.position.x - 0.75) << "never inside";
  }
}

TYPED_TEST(Characters, WeighsOnWhatItStandsOn) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId plank = add_body<D>(world, BodyType::dynamic, box_shape<D>(2, 0.1f, 2), at<D>(0, 5), {0.6f, 0, 50, 0});
  DistanceJointDef<D> spring;
  spring.body_b = plank;
  spring.frame_a.p = along<D>(0, 10);
  spring.length = 5;
  spring.spring = {2, 0.7f};
  world.create_joint(spring).value();
  MotionLocks locks;
  locks.rotation_x = locks.rotation_y = locks.rotation_z = true;
  world.set_locks(plank, locks).value();
  run(world, 300);
  const double empty = world.state(plank).value().pose.position.y;
  auto c = make<D>(world, at<D>(0, empty + 0.2));
  walk(world, c, {}, 400);
  const double stiffness = double(world.state(plank).value().mass) * std::pow(2 * pi * 2, 2);
  EXPECT_NEAR(empty - world.state(plank).value().pose.position.y, 80 * 9.81 / stiffness, 0.05 * 80 * 9.81 / stiffness);
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
}

TYPED_TEST(Characters, StopsBelowACeiling) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_body<D>(world, BodyType::fixed, box_shape<D>(5, 0.5f, 5), at<D>(0, 2.6));
  auto c = make<D>(world, at<D>(0, 0.01));
  walk(world, c, {}, 5);
  double top = 0;
  for (int i = 0; i < 60; ++i) {
    walk(world, c, along<D>(0, i == 0 ? 6.0f : 0.0f), 1);
    top = std::max(top, c.feet().y);
  }
  EXPECT_NEAR(top, 2.1 - 1.8 - 0.01, 2e-3);
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
}

// Fifty one way, fifty the other: all arrive, none inside another.
TEST(Characters3, AHundredCross) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  std::vector<Character3> all;
  for (int i = 0; i < 100; ++i) {
    const bool right = i % 2 == 0;
    const int k = i / 2;
    all.push_back(make<Dim3>(
        world, {(right ? -8.0 : 8.0) + 0.9 * (k / 10) * (right ? -1 : 1), 0.01, 1.6 * (k % 10) + (right ? 0 : 0.3)}));
  }
  double closest = 1e9;
  for (int step = 0; step < 900; ++step) {
    for (int i = 0; i < 100; ++i) all[std::size_t(i)].move(world, {i % 2 == 0 ? 3.0f : -3.0f, 0, 0}, frame).value();
    world.step(frame).value();
    if (step % 10 == 0)
      for (int i = 0; i < 100; ++i)
        for (int j = i + 1; j < 100; ++j)
          closest = std::min(closest, math::length(all[std::size_t(i)].center() - all[std::size_t(j)].center()));
  }
  EXPECT_GT(closest, 0.6);
  for (int i = 0; i < 100; ++i) {
    const double x = all[std::size_t(i)].feet().x;
    EXPECT_GT(i % 2 == 0 ? x : -x, 8.0) << "character " << i;
  }
}

geometry::Shape3 hills() {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  const int n = 41;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      vertices.push_back({float(i - 20), 0.5f * std::sin(0.5f * float(i)) * std::cos(0.5f * float(j)), float(j - 20)});
  for (std::uint32_t j = 0; j + 1 < n; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t a = j * n + i, b = a + n;
      for (const std::uint32_t k : {a, b + 1, a + 1, a, b, b + 1}) indices.push_back(k);
    }
  return geometry::make_triangle_mesh(vertices, indices).value();
}

// What it keeps of the triangles around it is not part of its state and must not show.
TEST(Characters3, GoesTheSameWayAgainOnAMesh) {
  World3 world(world_with<Dim3>());
  add_body<Dim3>(world, BodyType::fixed, hills(), {0, 0, 0});
  add_body<Dim3>(world, BodyType::fixed, hills(), {0.3, 0.02, 0.4});
  auto c = make<Dim3>(world, {-15, 1, 0.3});
  walk(world, c, {}, 60);
  Snapshot<Dim3> snapshot;
  world.snapshot(snapshot);
  const CharacterState<Dim3> state = c.state();
  for (int start = 0; start < 8; ++start) {  // from other places, with other triangles at hand
    std::vector<Vec3d> ways[2];
    for (auto& way : ways) {
      for (int i = 0; i < 60; ++i) {
        walk(world, c, {3, i % 30 == 7 ? 4.0f : 0.0f, 1}, 1);
        way.push_back(c.feet());
      }
      ASSERT_TRUE(world.restore(snapshot).ok());
      c.restore(state);
      if (&way == ways) walk(world, c, {float(start - 4), 0, float(start % 3)}, 5 * start);
      ASSERT_TRUE(world.restore(snapshot).ok());
      c.restore(state);
    }
    ASSERT_EQ(ways[0], ways[1]) << start;
  }
}

TEST(Characters3, WalksOnAMesh) {
  World3 world(world_with<Dim3>());
  add_body<Dim3>(world, BodyType::fixed, hills(), {0, 0, 0});
  auto c = make<Dim3>(world, {-15, 1, 0.3});
  walk(world, c, {}, 60);
  int off = 0;
  const Vec3d begin = c.feet();
  for (int i = 0; i < 480; ++i) {
    walk(world, c, {3, 0, 0}, 1);
    off += c.ground().state != GroundState::on_ground;
  }
  EXPECT_EQ(off, 0);
  EXPECT_GT(c.feet().x - begin.x, 22) << "24 m along the hills";
}

TYPED_TEST(Characters, SameBitsWhateverTheThreads) {
  using D = TypeParam;
  std::uint64_t hash[2];
  for (const int threads : {1, 2}) {
    WorldDef<D> d = world_with<D>();
    d.threads = threads;
    World<D> world(d);
    add_ground(world);
    add_heap(world, 3);
    auto c = make<D>(world, at<D>(-6, 0.01));
    walk(world, c, along<D>(2.5f, 0), 240);
    hash[threads - 1] = world.state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TYPED_TEST(Characters, RollsBackWithItsWorld) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_heap(world, 2);
  auto c = make<D>(world, at<D>(-6, 0.01));
  const auto go = [&](int i) { walk(world, c, along<D>(3, i % 40 == 20 ? 4.0f : 0.0f), 1); };
  for (int i = 0; i < 60; ++i) go(i);
  Snapshot<D> snapshot;
  world.snapshot(snapshot);
  const CharacterState<D> state = c.state();
  std::uint64_t hash[2];
  typename D::Position feet[2];
  for (int k = 0; k < 2; ++k) {
    for (int i = 60; i < 180; ++i) go(i);
    hash[k] = world.state_hash();
    feet[k] = c.feet();
    ASSERT_TRUE(world.restore(snapshot).ok());
    c.restore(state);
  }
  EXPECT_EQ(hash[0], hash[1]);
  EXPECT_EQ(feet[0], feet[1]);
}

TYPED_TEST(Characters, RefusesWhatIsNotANumber) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  auto c = make<D>(world, at<D>(0, 0.01));
  const auto before = c.feet();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(c.move(world, along<D>(nan, 0), frame).ok());
  EXPECT_FALSE(c.move(world, along<D>(1, 0), 0).ok());
  EXPECT_FALSE(c.move(world, along<D>(1, 0), nan).ok());
  EXPECT_FALSE(c.teleport(world, at<D>(double(nan), 0)).ok());
  EXPECT_EQ(c.feet(), before);
  CharacterDef<D> bad;
  bad.radius = -1;
  EXPECT_FALSE(Character<D>::create(world, bad, at<D>(0, 0)).ok());
  bad = {};
  bad.up = along<D>(0, 2);
  EXPECT_FALSE(Character<D>::create(world, bad, at<D>(0, 0)).ok());
  World<D> other(world_with<D>());
  EXPECT_FALSE(c.move(other, along<D>(1, 0), frame).ok()) << "a world that it does not live in";
  c.destroy(world).value();
  EXPECT_FALSE(c.move(world, along<D>(1, 0), frame).ok());
}

}  // namespace character_test
}  // namespace carom::rigid::test
