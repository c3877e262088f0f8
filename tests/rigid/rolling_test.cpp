// Rolling resistance of what is not round, the sleep of what is long, and resistance to spin about the normal.
#include <gtest/gtest.h>

#include "carom/geometry/hull.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/rotation.h"
#include "scene_pieces.h"

namespace carom::rigid::test {
namespace {

/// A log of `sides` faces about z, one of them below.
geometry::Shape3 log_of(int sides, float radius, float half_length) {
  std::vector<Vec3f> points;
  for (int i = 0; i < sides; ++i) {
    const double angle = (2 * i + 1) * math::pi / sides - math::pi / 2;
    for (const float z : {-half_length, half_length})
      points.push_back({radius * float(math::cos(angle)), radius * float(math::sin(angle)), z});
  }
  return geometry::make_hull(points).value();
}

/// How far (m) a log rolls in 3 s on a slope of `degrees`.
double way_down(float degrees, float resistance) {
  constexpr int sides = 32;
  WorldDef<Dim3> def;
  const double slope = double(degrees) * math::pi / 180;
  def.gravity = {float(9.81 * math::sin(slope)), float(-9.81 * math::cos(slope)), 0};
  World3 world(def);
  add_ground<Dim3>(world);
  const double inner = 0.3 * math::cos(math::pi / sides);
  const BodyId log = add_body<Dim3>(world, BodyType::dynamic, log_of(sides, 0.3f, 1.5f), {0, inner, 0},
                                    {.friction = 0.9f, .rolling_resistance = resistance});
  run(world, 180);
  return world.state(log).value().pose.position.x;
}

// It stands on a face up to tan(π/32), 5.6°; the lever of 0.2 inner radii adds 11.3° to that.
TEST(Rolling, ALogOfManySidesIsHeldByItsResistance) {
  EXPECT_LT(way_down(4, 0), 0.005);
  EXPECT_GT(way_down(10, 0), 1);
  EXPECT_LT(way_down(10, 0.2f), 0.005);
  EXPECT_LT(way_down(14, 0.2f), 0.005);
  EXPECT_GT(way_down(20, 0.2f), 1);
}

// Its ends are 10 m from its middle, yet no point of it moves faster than twice 1 cm/s.
TEST(Rolling, WhatIsLongAndRollsSlowlyFallsAsleep) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world);
  const BodyId pole = add_body<Dim3>(world, BodyType::dynamic, geometry::Capsule3{10, 0.3f}, {0, 0.3, 0});
  world.set_pose(pole, {0, 0.3, 0}, math::from_axis_angle(Vec3f{1, 0, 0}, 0.5f * float(math::pi))).value();
  world.set_velocity(pole, {0.01f, 0, 0}, {0, 0, -0.01f / 0.3f}).value();
  run(world, 120);
  EXPECT_FALSE(world.state(pole).value().awake);
}

// Nothing resists what rolls: it goes on, however small it is. What was a few millimetres thin had its anchors of
// friction turn round with it, and spun up in its place to a hundred radians a second; what was a cylinder lost or
// gained a third of its speed by contacts with a wide box that were not where it was.
TEST(Rolling, SmallRoundThingsRollOn) {
  const Quatf lies = math::from_axis_angle(Vec3f{1, 0, 0}, 0.5f * float(math::pi));
  const float speed = 0.2f;
  for (const float radius : {0.05f, 0.02f, 0.01f, 0.005f, 0.0025f}) {
    const geometry::Shape3 shapes[] = {geometry::Cylinder{5 * radius, radius},
                                       geometry::Cylinder{0.2f * radius, radius},
                                       geometry::Capsule3{5 * radius, radius}};
    for (std::size_t k = 0; k < std::size(shapes); ++k) {
      World3 world(world_with<Dim3>());
      add_ground<Dim3>(world);
      const BodyId id = add_body<Dim3>(world, BodyType::dynamic, shapes[k], {});
      world.set_pose(id, {0, double(radius), 0}, lies).value();
      world.set_velocity(id, {speed, 0, 0}, {0, 0, -speed / radius}).value();
      run(world, 300);
      const BodyState<Dim3> s = world.state(id).value();
      EXPECT_NEAR(s.linear_velocity.x, speed, 0.01f * speed) << "radius " << radius << " shape " << k;
      EXPECT_NEAR(-s.angular_velocity.z * radius, speed, 0.015f * speed) << "radius " << radius << " shape " << k;
    }
  }
}

// A log that rolls at 4 cm/s is as slow as a ball that does, though its ends are four radii from its middle; one at
// 10 cm/s settles first (settling_speed). Neither came to rest.
TEST(Rolling, LogsThatRollSlowlyFallAsleep) {
  const Quatf lies = math::from_axis_angle(Vec3f{1, 0, 0}, 0.5f * float(math::pi));
  for (const float speed : {0.04f, 0.1f}) {
    World3 world(world_with<Dim3>());
    add_ground<Dim3>(world);
    const BodyId log = add_body<Dim3>(world, BodyType::dynamic, geometry::Cylinder{0.5f, 0.125f}, {});
    world.set_pose(log, {0, 0.125, 0}, lies).value();
    world.set_velocity(log, {speed, 0, 0}, {0, 0, -speed / 0.125f}).value();
    run(world, 240);
    EXPECT_FALSE(world.state(log).value().awake) << speed;
  }
}

// A coin that leans on another rolls on both rims to and fro, and loses nothing by it: of 200 a fifth were still awake
// after a minute.
TEST(Rolling, ACoinThatLeansRocksToRest) {
  Draw draw{1};
  int awake = 0;
  for (int k = 0; k < 40; ++k) {
    World3 world(world_with<Dim3>());
    add_ground<Dim3>(world);
    const geometry::Shape3 coin = geometry::Cylinder{0.1f / 60, 0.05f};
    const auto turned = [&](float lean) {
      const float x = lean * draw(), y = draw(), z = lean * draw();
      return normalize(Quatf{1, x, y, z});
    };
    const double up = 0.01 + 0.01 * double(draw()), aside = 0.05 + 0.03 * double(draw()), along = 0.03 * double(draw());
    const BodyId below = add_body<Dim3>(world, BodyType::fixed, coin, {});
    world.set_pose(below, {0, up, 0}, turned(0.1f)).value();
    const BodyId above = add_body<Dim3>(world, BodyType::dynamic, coin, {});
    world.set_pose(above, {aside, 0.05, along}, turned(0.3f)).value();
    run(world, 1800);
    awake += world.state(above).value().awake ? 1 : 0;
  }
  EXPECT_LE(awake, 2);
}

/// How fast (rad/s) a ball of radius 0.5 m that spins at 20 rad/s on its spot is after 2 s.
double spin_left(const Material& ball, const Material& ground, const PairRule* rule = nullptr, float half = 0) {
  World3 world(world_with<Dim3>());
  const BodyId floor = world.create_body({.type = BodyType::fixed, .position = {0, -1, 0}}).value();
  world.add_shape(floor, geometry::Box{{20, 1, 20}}, {.material = ground}).value();
  const BodyId body = world.create_body({.position = {0, 0.5, 0}}).value();
  world
      .add_shape(body, half > 0 ? geometry::Shape3(geometry::Box{{half, 0.5f, half}}) : geometry::Sphere{0.5f},
                 {.material = ball})
      .value();
  if (rule != nullptr) world.set_pair_rule(ball.user_id, ground.user_id, rule).value();
  run(world, 30);
  world.set_velocity(body, {}, {0, 20, 0}).value();
  run(world, 120);
  EXPECT_NEAR(world.state(body).value().linear_velocity.x, 0, half > 0 ? 0.01 : 1e-4);
  return double(world.state(body).value().angular_velocity.y);
}

// I dω/dt = −c r N about the normal: with ⅖ m r², ω₀ − (5/2) c g t/r.
TEST(Spinning, SlowsByItsResistance) {
  const auto left = [](double c) { return 20 - 2.5 * c * 9.81 * 2 / 0.5; };
  const double none = spin_left({}, {});
  EXPECT_GT(none, 19);
  EXPECT_NEAR(spin_left({.spinning_resistance = 0.1f}, {}), left(0.1), 0.02);
  EXPECT_NEAR(spin_left({.spinning_resistance = 0.05f}, {.spinning_resistance = 0.1f}), left(0.1), 0.02)
      << "the larger";
  EXPECT_NEAR(spin_left({.friction = 0.1f, .spinning_resistance = 0.1f}, {}), left(0.1), 0.02) << "whatever friction";
  EXPECT_NEAR(spin_left({.friction = 0, .spinning_resistance = 0.1f}, {}), 20, 1e-3) << "none without friction";
  EXPECT_NEAR(spin_left({.rolling_resistance = 0.05f}, {}), left(0.05), 0.02) << "rolling resistance holds too,";
  EXPECT_NEAR(spin_left({.rolling_resistance = 0.05f, .spinning_resistance = 0.1f}, {}), left(0.1), 0.02)
      << "and counts within it";
  EXPECT_NEAR(spin_left({.rolling_resistance = 0.1f, .spinning_resistance = 0.05f}, {}), left(0.1), 0.02);
  const PairRule rule{.spinning_resistance = 0.02f};
  EXPECT_NEAR(spin_left({.spinning_resistance = 0.2f, .user_id = 1}, {.user_id = 2}, &rule), left(0.02), 0.02);
}

// On a face it adds to what friction turns on: a difference of c (half the thickness) N/I.
TEST(Spinning, AddsToTheFrictionOfAFace) {
  const double plain = spin_left({.friction = 0.05f}, {.friction = 0.05f}, nullptr, 0.5f),
               more = spin_left({.friction = 0.05f, .spinning_resistance = 0.02f}, {.friction = 0.05f}, nullptr, 0.5f);
  EXPECT_NEAR(plain - more, 0.02 * 0.5 * 9.81 * 2 / (1.0 / 6), 0.01);
}

TEST(Spinning, IsRefusedWhereItCannotBe) {
  World3 world(world_with<Dim3>());
  const BodyId body = world.create_body({}).value();
  const auto shape = world.add_shape(body, geometry::Sphere{1}, {.material = {.spinning_resistance = -1}});
  ASSERT_FALSE(shape.ok());
  EXPECT_NE(shape.error().message.find("material.spinning_resistance"), std::string::npos) << shape.error().message;
  const PairRule rule{.spinning_resistance = std::numeric_limits<float>::infinity()};
  const Status ruled = world.set_pair_rule(0, 1, &rule);
  ASSERT_FALSE(ruled.ok());
  EXPECT_NE(ruled.error().message.find("spinning_resistance"), std::string::npos) << ruled.error().message;
}

// A log that rolls over its edges strikes with a face and rocks to rest. All four corners of the face hold it, and what
// comes down next is met in time (it went 1.8 cm deep, and rocked from one diagonal to the other for ten seconds).
TEST(Rolling, AHexagonalLogRocksToRestOnAMesh) {
  for (const float cell : {1.0f, 0.5f, 0.25f})
    for (const float spin : {2.0f, 4.0f}) {
      World3 world(world_with<Dim3>());
      const int cells = int(20 / cell);
      const geometry::Triangles grid = geometry::make_grid_mesh(cells, cells, {cell, cell});
      add_body<Dim3>(world, BodyType::fixed,
                     geometry::Shape3(geometry::make_triangle_mesh(grid.positions, grid.indices).value()), {});
      const double inner = 0.75 * math::cos(math::pi / 6);
      const BodyId log = add_body<Dim3>(world, BodyType::dynamic, log_of(6, 0.75f, 1.5f), {5, inner, 10.3},
                                        {.friction = 0.9f, .rolling_resistance = 0.05f});
      world.set_velocity(log, {0.75f * spin, 0, 0}, {0, 0, -spin}).value();
      float deepest = 0;
      for (int i = 0; i < 300; ++i) {
        run(world, 1);
        deepest = math::max(deepest, world.worst_penetration());
      }
      EXPECT_LT(deepest, 0.01f) << "cells of " << cell << " m, " << spin << " rad/s";
      EXPECT_FALSE(world.state(log).value().awake) << "cells of " << cell << " m, " << spin << " rad/s";
    }
}

}  // namespace
}  // namespace carom::rigid::test
