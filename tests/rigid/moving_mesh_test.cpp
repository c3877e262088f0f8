// Meshes on bodies that move: carried, tipped and turned things, dynamic meshes, what flies at them.
#include <gtest/gtest.h>

#include "carom/geometry/height_field.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/rotation.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

geometry::Shape3 mesh_of(const geometry::Triangles& t) {
  return geometry::make_triangle_mesh(t.positions, t.indices).value();
}
/// An open bowl with walls 0.2 m thick: 2 m wide inside, 0.8 m deep.
geometry::Shape3 bowl() {
  std::vector<Vec2f> profile;
  for (int i = 0; i <= 8; ++i) {
    const float a = float(i) / 8 * 1.35f, s = float(math::sin(double(a))), c = float(math::cos(double(a)));
    profile.push_back({1.2f * s, -1.2f * c});
  }
  for (int i = 8; i >= 0; --i) {
    const float a = float(i) / 8 * 1.35f, s = float(math::sin(double(a))), c = float(math::cos(double(a)));
    profile.push_back({s, -c});
  }
  return mesh_of(geometry::make_lathe_mesh(profile, 40));
}
BodyId add_kinematic(World3& world, const geometry::Shape3& shape, Vec3d position, Vec3f velocity = {},
                     Vec3f angular = {}) {
  const BodyId id = world
                        .create_body({.type = BodyType::kinematic,
                                      .position = position,
                                      .linear_velocity = velocity,
                                      .angular_velocity = angular})
                        .value();
  world.add_shape(id, shape, {.material = {.friction = 0.8f}}).value();
  return id;
}

TEST(MovingMesh, ABowlHoldsItsBallsUntilItTips) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world);
  const BodyId b = add_kinematic(world, bowl(), {0, 3, 0});
  std::vector<BodyId> balls;
  for (int i = 0; i < 12; ++i)
    balls.push_back(add_ball<Dim3>(world, {0.25 * (i % 3 - 1), 2.6 + 0.25 * (i / 3), 0.1 * (i % 2)}, 0.12f));
  run(world, 240);
  for (const BodyId ball : balls) {
    const Vec3d p = world.state(ball).value().pose.position - Vec3d{0, 3, 0};
    EXPECT_LT(math::length(p), 1.0) << "within the bowl";
    EXPECT_LT(p.y, -0.3);
  }
  // Carried along, without slipping out of it: 1 m/s across and up for a second.
  world.set_velocity(b, {1, 0.5f, 0}, {}).value();
  run(world, 120);
  world.set_velocity(b, {}, {}).value();
  run(world, 120);
  for (const BodyId ball : balls)
    EXPECT_LT(math::length(world.state(ball).value().pose.position - Vec3d{2, 4, 0}), 1.0);
  // Over in three seconds: all of them fall out, none through the wall.
  world.set_velocity(b, {}, {0, 0, float(math::pi) / 3}).value();
  for (int i = 0; i < 180; ++i) {
    world.step(frame).value();
    for (const BodyId ball : balls) {
      const Pose3 bowl_pose = world.state(b).value().pose;
      const Vec3d p = world.state(ball).value().pose.position - bowl_pose.position;
      const double up = dot(p, Vec3d(rotate(bowl_pose.rotation, Vec3f{0, 1, 0})));
      if (up < -0.3) {
        EXPECT_TRUE(math::length(p) < 1.0 || math::length(p) > 1.2) << "inside the wall";
      }
    }
  }
  world.set_velocity(b, {}, {}).value();
  run(world, 120);
  for (const BodyId ball : balls) EXPECT_NEAR(world.state(ball).value().pose.position.y, 0.12, 0.005);
}

TEST(MovingMesh, ATurningBowlTakesItsBallAlong) {
  World3 world(world_with<Dim3>());
  const BodyId b = add_kinematic(world, bowl(), {0, 2, 0}, {}, {0, 1, 0});
  const BodyId box = add_box<Dim3>(world, {0, 1.2, 0}, 0.15f, {.friction = 0.8f});
  run(world, 300);
  EXPECT_NEAR(world.state(box).value().angular_velocity.y, 1.0f, 0.02f);
  EXPECT_TRUE(world.contains(b));
}

TEST(MovingMesh, APlatformCarriesWhatStandsOnIt) {
  World3 world(world_with<Dim3>());
  add_kinematic(world, mesh_of(geometry::make_box_mesh({3, 0.2f, 3})), {0, 0, 0}, {1.2f, 0, -0.5f});
  const BodyId box = add_box<Dim3>(world, {0.3, 0.45, 0.2}, 0.25f);
  run(world, 90);
  const BodyState<Dim3> s = world.state(box).value();
  EXPECT_NEAR(s.linear_velocity.x, 1.2f, 5e-3f);
  EXPECT_NEAR(s.linear_velocity.z, -0.5f, 5e-3f);
  EXPECT_NEAR(s.pose.position.y, 0.45, 2e-3);
}

TEST(MovingMesh, HasTheMassOfWhatItEncloses) {
  World3 world(world_with<Dim3>());
  const geometry::Triangles t = geometry::make_torus_mesh(1, 0.25f, 96, 64);
  const BodyId torus = add_body<Dim3>(world, BodyType::dynamic, mesh_of(t), {0, 5, 0}, {.density = 700});
  // Of a solid torus: m = 2π² R r² ρ, about its axis m (R² + ¾ r²), about a diameter m (½ R² + ⅝ r²).
  const double volume = 2 * math::pi * math::pi * 0.0625, m = 700 * volume;
  const geometry::MassProperties3 p = world.mass_properties3(torus).value();
  EXPECT_NEAR(p.mass, m, 0.004 * m);
  EXPECT_NEAR(p.inertia.cz.z, m * (1 + 0.75 * 0.0625), 0.006 * m);
  EXPECT_NEAR(p.inertia.cx.x, m * (0.5 + 0.625 * 0.0625), 0.004 * m);
  EXPECT_LT(math::length(p.center), 1e-5);
}

TEST(MovingMesh, ATorusFallsOnAPegAndHangsThere) {
  World3 world(world_with<Dim3>());
  add_ground<Dim3>(world);
  // A peg 0.2 m high and wide, along z: its top is at 4 m. The torus stands in the plane z = 0, round the peg.
  add_body<Dim3>(world, BodyType::fixed, geometry::Box{{0.1f, 0.1f, 1}}, {0, 3.9, 0});
  const BodyId torus = add_body<Dim3>(world, BodyType::dynamic, mesh_of(geometry::make_torus_mesh(1, 0.25f, 48, 24)),
                                      {0.05, 3.6, 0}, {.friction = 0.6f, .density = 500});
  world.set_damping(torus, 0, 0.5f).value();
  double lowest = 10;
  for (int i = 0; i < 900; ++i) {
    world.step(frame).value();
    lowest = std::min(lowest, world.state(torus).value().pose.position.y);
  }
  const BodyState<Dim3> s = world.state(torus).value();
  // Its inner side rests on the two upper edges of the peg, 0.2 m apart, on a circle of 0.75 m.
  const double depth = math::sqrt(0.75 * 0.75 - 0.01);
  EXPECT_NEAR(s.pose.position.y, 4 - depth, 0.015);
  EXPECT_NEAR(s.pose.position.x, 0, 0.1);
  EXPECT_LT(math::length(s.linear_velocity), 0.03f);
  EXPECT_GT(lowest, 4 - depth - 0.06) << "it never slipped through";
}

TEST(MovingMesh, LiesOnPlanesBoxesAndInWater) {
  World3 world(world_with<Dim3>());
  const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
  world.add_shape(ground, geometry::Plane{}).value();
  add_body<Dim3>(world, BodyType::fixed, geometry::Box{{3, 0.5f, 3}}, {10, 0.5, 0});
  const geometry::Shape3 torus = mesh_of(geometry::make_torus_mesh(1, 0.25f, 32, 16));
  std::vector<BodyId> bodies;
  for (const double x : {0.0, 10.0}) {
    const BodyId id = world
                          .create_body({.position = {x, x > 5 ? 1.6 : 0.6, 0},
                                        .rotation = math::from_axis_angle(Vec3f{1, 0, 0}, float(math::pi) / 2 + 0.2f)})
                          .value();
    world.add_shape(id, torus, {.density = 400, .filter = {.category = 2, .mask = 1}}).value();
    bodies.push_back(id);
  }
  run(world, 300);
  EXPECT_NEAR(world.state(bodies[0]).value().pose.position.y, 0.25, 0.005);
  EXPECT_NEAR(world.state(bodies[1]).value().pose.position.y, 1.25, 0.005);
  for (const BodyId id : bodies) EXPECT_FALSE(world.state(id).value().awake);
  // Archimedes: half as heavy as water, it floats half below, lying flat.
  World3 sea(world_with<Dim3>());
  const BodyId boat = sea.create_body({.rotation = math::from_axis_angle(Vec3f{1, 0, 0}, float(math::pi) / 2)}).value();
  sea.add_shape(boat, torus, {.density = 500}).value();
  Buoyancy<Dim3> water;
  water.density = 1000;
  water.linear_drag = 4;
  water.angular_drag = 4;
  sea.add_effector(water).value();
  run(sea, 900);
  EXPECT_NEAR(sea.state(boat).value().pose.position.y, 0, 0.01) << "half of it is below";
}

TEST(MovingMesh, StopsWhatFliesAtIt) {
  // A hollow box of 0.05 m walls that comes along at 5 m/s: not a bullet, 200 m/s against it, from outside.
  const geometry::Shape3 wall = mesh_of(geometry::make_box_mesh({0.025f, 2, 2}));
  const geometry::Shape3 shapes[] = {geometry::Sphere{0.1f}, geometry::Box{{0.1f, 0.1f, 0.1f}},
                                     geometry::Capsule3{0.1f, 0.05f}, geometry::Cylinder{0.1f, 0.1f}};
  int passed = 0;
  for (int i = 0; i < 200; ++i) {
    WorldDef<Dim3> def = world_with<Dim3>(0);
    World3 world(def);
    const BodyId w = add_kinematic(world, wall, {0, 0, 0}, {-5, 0, 0}, {0, 0, 0.2f});
    const BodyId ball = add_body<Dim3>(world, BodyType::dynamic, shapes[i % 4],
                                       {-10 - 0.017 * i, 0.8 * (i % 5 - 2) / 2.0, 0.3 * (i % 3 - 1)}, {}, {200, 0, 0});
    run(world, 12);
    passed += world.state(ball).value().pose.position.x > world.state(w).value().pose.position.x ? 1 : 0;
  }
  EXPECT_EQ(passed, 0);
}

TEST(MovingMesh, WhatCannotBeIsRefused) {
  World3 world(world_with<Dim3>());
  const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
  const geometry::Shape3 terrain = geometry::make_height_field(3, 3, {1, 1}, std::vector<float>(9, 0.0f)).value();
  world.add_shape(ground, terrain, {.filter = {.category = 2}}).value();
  const BodyId body = world.create_body({}).value();
  const geometry::Shape3 torus = mesh_of(geometry::make_torus_mesh(1, 0.25f));
  const auto message = [](const auto& result) {
    return result.ok() ? std::string("accepted") : result.error().message;
  };
  EXPECT_NE(message(world.add_shape(body, torus)).find("do not collide with each other"), std::string::npos);
  const ShapeId kept = world.add_shape(body, torus, {.filter = {.mask = ~std::uint64_t{2}}}).value();
  EXPECT_NE(message(world.set_filter(kept, {})).find("World::set_filter"), std::string::npos);
  // And the other way round: terrain that comes later.
  EXPECT_NE(message(world.add_shape(ground, terrain)).find("do not collide"), std::string::npos);
  EXPECT_EQ(message(world.add_shape(ground, terrain, {.filter = {.category = 2}})), "accepted");
  // Open meshes have no inside.
  const geometry::Shape3 sheet = mesh_of(geometry::make_grid_mesh(2, 2, {1, 1}));
  const BodyId other = world.create_body({}).value();
  const ShapeDef<Dim3> apart{.filter = {.mask = 0}};
  EXPECT_NE(message(world.add_shape(other, sheet, apart)).find("must be closed"), std::string::npos);
  ShapeDef<Dim3> weightless = apart;
  weightless.density = 0;
  EXPECT_EQ(message(world.add_shape(other, sheet, weightless)), "accepted");
  const BodyId fixed = world.create_body({.type = BodyType::fixed}).value();
  world.add_shape(fixed, sheet, apart).value();
  EXPECT_NE(message(world.set_type(fixed, BodyType::dynamic)).find("must be closed"), std::string::npos);
  EXPECT_TRUE(world.set_type(fixed, BodyType::kinematic).ok());
}

}  // namespace
}  // namespace carom::rigid::test
