// Ellipsoids in motion: rolling, rocking, coming to rest.
#include <gtest/gtest.h>

#include "carom/math/rotation.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

// A spheroid that rolls about its axis of symmetry has I = 2/5 m r² there, as a sphere: a = 5/7 g sin β.
TEST(EllipsoidBody, RollsDownASlopeAsASphereDoes) {
  const float beta = 0.15f;
  WorldDef<Dim3> def = world_with<Dim3>();
  def.gravity = {9.81f * float(math::sin(double(beta))), -9.81f * float(math::cos(double(beta))), 0};
  World3 world(def);
  add_ground<Dim3>(world);
  const BodyId ball = add_body<Dim3>(world, BodyType::dynamic, geometry::Ellipsoid{{0.3f, 0.3f, 0.5f}}, {0, 0.3, 0},
                                     {.friction = 0.8f});
  run(world, 30);
  const float v0 = speed(world, ball);
  run(world, 60);
  const float a = 5.0f / 7.0f * def.gravity.x;
  EXPECT_NEAR(speed(world, ball) - v0, a, 0.01f * a);
  EXPECT_NEAR(world.state(ball).value().angular_velocity.z, -speed(world, ball) / 0.3f,
              0.01f * speed(world, ball) / 0.3f);
}

// Rocking without slip about the lowest point: ω² = g (a² − b²)/b / (k² + b²), k² = (a² + b²)/5, from the height of the
// centre √(b² cos²θ + a² sin²θ) ≈ b + (a² − b²)/2b θ².
TEST(EllipsoidBody, RocksWithItsPeriod) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world, {.friction = 2});
  const double a = 0.6, b = 0.3, angle = 0.08;
  const double height = math::sqrt(b * b * square(math::cos(angle)) + a * a * square(math::sin(angle)));
  const BodyId egg = world
                         .create_body({.position = {0, height, 0},
                                       .rotation = math::from_axis_angle(Vec3f{0, 0, 1}, float(angle)),
                                       .sleep_speed = 0})
                         .value();
  world.add_shape(egg, geometry::Ellipsoid{{float(a), float(b), 0.45f}}, {.material = {.friction = 2}}).value();
  std::vector<double> crossings;
  double before = 1;
  for (int i = 0; i < 300; ++i) {
    world.step(frame).value();
    const double tilt = double(rotate(world.state(egg).value().pose.rotation, Vec3f{1, 0, 0}).y);
    if (before > 0 && tilt <= 0) crossings.push_back(world.time() - double(frame) * tilt / (tilt - before));
    before = tilt;
  }
  ASSERT_GE(crossings.size(), 4u);
  const double period = (crossings[3] - crossings[0]) / 3;
  const double k2 = (a * a + b * b) / 5, omega = math::sqrt(9.81 * (a * a - b * b) / b / (k2 + b * b));
  EXPECT_NEAR(period, 2 * math::pi / omega, 0.03 * period);
}

TEST(EllipsoidBody, ComesToRestOnItsFlatSideAndStays) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 6; ++i) {
    const BodyId id = world
                          .create_body({.position = {2.0 * i, 1.5, 0},
                                        .rotation = math::from_axis_angle(
                                            math::normalize(Vec3f{1, 0.2f * float(i), 0.5f}), 0.4f * float(i))})
                          .value();
    world
        .add_shape(id, geometry::Ellipsoid{{0.5f, 0.25f, 0.4f}},
                   {.material = {.friction = 0.6f, .rolling_resistance = 0.05f}})
        .value();
    bodies.push_back(id);
  }
  run(world, 900);
  for (const BodyId id : bodies) {
    EXPECT_NEAR(world.state(id).value().pose.position.y, 0.25, 0.004);
    EXPECT_FALSE(world.state(id).value().awake);
  }
}

TEST(EllipsoidBody, FloatsHalfBelowAtHalfTheDensity) {
  World3 world(world_with<Dim3>());
  const BodyId egg = world.create_body({.position = {0, 0.1, 0}}).value();
  world.add_shape(egg, geometry::Ellipsoid{{0.5f, 0.3f, 0.7f}}, {.density = 500}).value();
  Buoyancy<Dim3> water;
  water.density = 1000;
  water.linear_drag = 4;
  water.angular_drag = 4;
  world.add_effector(water).value();
  run(world, 900);
  EXPECT_NEAR(world.state(egg).value().pose.position.y, 0, 0.002);
}

TEST(EllipsoidBody, AHeapComesToRest) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 30; ++i)
    bodies.push_back(add_body<Dim3>(world, BodyType::dynamic, geometry::Ellipsoid{{0.3f, 0.2f, 0.4f}},
                                    {0.35 * (i % 3), 0.4 + 0.5 * (i / 3), 0.2 * (i % 2)},
                                    {.friction = 0.6f, .rolling_resistance = 0.1f}));
  run(world, 900);
  for (const BodyId id : bodies) {
    EXPECT_GT(world.state(id).value().pose.position.y, 0.19);
    EXPECT_LT(speed(world, id), 0.05f);
  }
  EXPECT_LT(world.worst_penetration(), 0.01f);
}

}  // namespace
}  // namespace carom::rigid::test
