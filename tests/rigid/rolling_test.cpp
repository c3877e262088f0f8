// Rolling resistance of what is not round, and the sleep of what is long.
#include <gtest/gtest.h>

#include "carom/geometry/hull.h"
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

}  // namespace
}  // namespace carom::rigid::test
