// Characters among one-way platforms, belts and what the game's own filter lets them through.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "carom/geometry/triangle_mesh.h"
#include "carom/rigid/character.h"
#include "carom/rigid/dynamic_character.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace platform_game_test {

template <class D>
class PlatformGame : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(PlatformGame, Dimensions);

constexpr float g = 9.81f, skin = 0.01f;

/// A world with ground, whose upper face lies at 0.
template <class D>
World<D> level() {
  World<D> world(world_with<D>(g));
  add_ground(world);
  return world;
}
/// A plate whose upper face lies at `top`.
template <class D>
ShapeId add_plate(World<D>& world, double top, const ShapeDef<D>& d, BodyType type = BodyType::fixed, double x = 0) {
  BodyDef<D> body;
  body.type = type;
  body.position = at<D>(x, top - 0.1);
  const BodyId id = world.create_body(body).value();
  return world.add_shape(id, box_shape<D>(3, 0.1f, 3), d).value();
}
template <class D>
ShapeId add_one_way(World<D>& world, double top, BodyType type = BodyType::fixed, double x = 0) {
  ShapeDef<D> d;
  d.one_way = along<D>(0, 1);
  return add_plate(world, top, d, type, x);
}
template <class D>
Character<D> stand_at(World<D>& world, double x, double y) {
  auto c = Character<D>::create(world, {}, at<D>(x, y + skin)).value();
  c.move(world, {}, frame).value();
  world.step(frame).value();
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
  return c;
}
template <class D>
void walk(World<D>& world, Character<D>& c, typename D::Vector velocity, int steps) {
  for (int i = 0; i < steps; ++i) {
    c.move(world, velocity, frame).value();
    world.step(frame).value();
  }
}

// A jump of v rises to v²/2g, whether or not a one-way platform lies on the way, and ends on the platform.
TYPED_TEST(PlatformGame, JumpsThroughAPlatformFromBelowAndStandsOnIt) {
  using D = TypeParam;
  for (const double top : {0.6, 1.9, 2.2, 2.45}) {
    World<D> world = level<D>();
    add_one_way(world, top);
    auto c = stand_at(world, 0, 0);
    double highest = 0;
    for (int i = 0; i < 120; ++i) {
      walk(world, c, along<D>(0, i == 0 ? 7.0f : 0.0f), 1);
      highest = std::max(highest, c.feet().y);
    }
    EXPECT_NEAR(highest, 49 / (2 * double(g)) + double(skin), 0.01) << top;
    EXPECT_NEAR(c.feet().y, top + double(skin), 2e-3) << top;
    EXPECT_EQ(c.ground().state, GroundState::on_ground) << top;
  }
}

TYPED_TEST(PlatformGame, WhatIsNotReachedLetsItDownAgain) {
  using D = TypeParam;
  World<D> world = level<D>();
  add_one_way(world, 2.6);  // the feet rise to 2.51
  auto c = stand_at(world, 0, 0);
  for (int i = 0; i < 120; ++i) walk(world, c, along<D>(0, i == 0 ? 7.0f : 0.0f), 1);
  EXPECT_NEAR(c.feet().y, double(skin), 2e-3);
}

TYPED_TEST(PlatformGame, SolidPlatformsStopTheHead) {
  using D = TypeParam;
  World<D> world = level<D>();
  const ShapeId plate = add_one_way(world, 2.5);
  world.set_one_way(plate, {}).value();
  auto c = stand_at(world, 0, 0);
  double highest = 0;
  for (int i = 0; i < 60; ++i) {
    walk(world, c, along<D>(0, i == 0 ? 7.0f : 0.0f), 1);
    highest = std::max(highest, c.feet().y);
  }
  EXPECT_NEAR(highest, 2.3 - 1.8 - double(skin), 2e-3);
}

TYPED_TEST(PlatformGame, WalksPastTheSidesOfAPlatformAndThroughThem) {
  using D = TypeParam;
  World<D> world = level<D>();
  add_one_way(world, 1.0, BodyType::fixed, 4);
  auto c = stand_at(world, 0, 0);
  walk(world, c, along<D>(3, 0), 120);
  EXPECT_NEAR(c.feet().x, 6, 1e-4);
  EXPECT_NEAR(c.feet().y, double(skin), 1e-4);
}

TYPED_TEST(PlatformGame, DropsThroughThePlatformItStandsOnAndNoOther) {
  using D = TypeParam;
  World<D> world = level<D>();
  add_one_way(world, 2.0);
  add_one_way(world, 4.0);
  auto c = stand_at(world, 0, 4.0);
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.feet().y, 4 + double(skin), 2e-3) << "it holds until told otherwise";
  c.drop_through();
  walk(world, c, {}, 10);
  EXPECT_FALSE(c.state().dropping) << "within the platform it needs no further telling";
  walk(world, c, {}, 80);
  EXPECT_NEAR(c.feet().y, 2 + double(skin), 2e-3);
  c.drop_through();
  walk(world, c, {}, 90);
  EXPECT_NEAR(c.feet().y, double(skin), 2e-3);
  c.drop_through();
  walk(world, c, {}, 5);
  EXPECT_NEAR(c.feet().y, double(skin), 2e-3) << "ground is not one-way";
  EXPECT_FALSE(c.state().dropping);
}

// A fall from h takes √(2h/g); what was dropped through does not slow it.
TYPED_TEST(PlatformGame, ARollbackInTheMiddleOfADropGoesOnAsItDid) {
  using D = TypeParam;
  World<D> world = level<D>();
  add_one_way(world, 4.0);
  auto c = stand_at(world, 0, 4.0);
  c.drop_through();
  walk(world, c, {}, 2);
  EXPECT_TRUE(c.state().dropping);
  const Snapshot<D> kept = world.snapshot();
  const CharacterState<D> state = c.state();
  walk(world, c, {}, 40);
  const auto end = c.feet();
  EXPECT_LT(end.y, 2.5);
  world.restore(kept).value();
  c.restore(state);
  walk(world, c, {}, 40);
  EXPECT_EQ(c.feet(), end);
}

TYPED_TEST(PlatformGame, RidesALiftThatIsOneWay) {
  using D = TypeParam;
  World<D> world = level<D>();
  const ShapeId plate = add_one_way(world, 0.5, BodyType::kinematic);
  auto c = stand_at(world, 0, 0.5);
  const BodyId lift = world.body_of(plate).value();
  world.set_velocity(lift, along<D>(0.5f, 1), {}).value();
  for (int i = 0; i < 120; ++i) {
    walk(world, c, {}, 1);
    ASSERT_EQ(c.ground().state, GroundState::on_ground) << i;
  }
  EXPECT_NEAR(c.feet().y, 2.5 + double(skin), 3e-3);
  EXPECT_NEAR(c.feet().x, 1, 0.01);
}

TYPED_TEST(PlatformGame, BeltsCarryIt) {
  using D = TypeParam;
  World<D> world = level<D>();
  ShapeDef<D> d;
  d.surface_velocity = along<D>(1.5f, 0);
  const ShapeId belt = add_plate(world, 0.5, d);
  auto c = stand_at(world, -2, 0.5);
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.feet().x, -0.5, 1e-3);
  EXPECT_NEAR(c.ground().velocity.x, 1.5, 1e-5);
  EXPECT_NEAR(c.ground().belt.x, 1.5, 1e-5);
  EXPECT_NEAR(c.velocity().x, 1.5, 1e-3);
  const double before = c.feet().x;
  walk(world, c, along<D>(-1.5f, 0), 60);
  EXPECT_NEAR(c.feet().x, before, 1e-3) << "walks on the spot";
  world.set_surface_velocity(belt, {}).value();
  walk(world, c, {}, 1);
  walk(world, c, {}, 60);
  EXPECT_LT(std::abs(c.feet().x - before), 0.05) << "the belt stands";
}

// On a moving body both speeds add up.
TYPED_TEST(PlatformGame, ABeltOnAMovingBody) {
  using D = TypeParam;
  World<D> world = level<D>();
  ShapeDef<D> d;
  d.surface_velocity = along<D>(1, 0);
  const ShapeId belt = add_plate(world, 0.5, d, BodyType::kinematic);
  world.set_velocity(world.body_of(belt).value(), along<D>(-0.25f, 0), {}).value();
  auto c = stand_at(world, 0, 0.5);
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.feet().x, 0.75, 0.02);
  EXPECT_NEAR(c.ground().velocity.x, 0.75, 1e-4);
}

TEST(PlatformGame2, TheSpeedAlongASurfaceOfTheMaterialCarriesToo) {
  World2 world = level<Dim2>();
  ShapeDef<Dim2> d;
  d.material.tangent_speed = -1.5f;
  add_plate(world, 0.5, d);
  auto c = stand_at(world, -2, 0.5);
  walk(world, c, {}, 60);
  EXPECT_NEAR(c.feet().x, -0.5, 1e-3);
  c.destroy(world).value();
  const BodyId box = add_box<Dim2>(world, {-2, 0.7}, 0.2f);
  auto walker = DynamicCharacter2::create(world, {}, {-2.8, 0.5}).value();
  const auto step = [&] {
    walker.move(world, {}, frame).value();
    world.step(frame).value();
  };
  for (int i = 0; i < 40; ++i) step();
  const double from = world.state(box).value().pose.position.x, start = walker.feet(world).x;
  for (int i = 0; i < 60; ++i) step();
  EXPECT_NEAR(world.state(box).value().pose.position.x - from, 1.5, 0.01) << "as a box";
  EXPECT_NEAR(walker.feet(world).x - start, 1.5, 0.02) << "and as a character that is a body";
}

// Of a mesh whose triangles run differently, those under its feet carry it.
TEST(PlatformGame3, PartsOfAMeshRunAsBelts) {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> materials;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) vertices.push_back({float(i - 4), 0, float(j - 4)});
  for (std::uint32_t i = 0; i < 8; ++i)
    for (std::uint32_t j = 0; j < 8; ++j) {
      const std::uint32_t a = 9 * i + j, b = a + 1, c = a + 9, d = c + 1;
      for (const std::uint32_t k : {a, b, d, a, d, c}) indices.push_back(k);
      materials.insert(materials.end(), 2, std::uint8_t(j < 4 ? 0 : 1));
    }
  World3 world(world_with<Dim3>(g));
  const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
  ShapeDef<Dim3> d;
  d.surfaces = {{{}, {1, 0, 0}}, {{}, {0, 0, -0.5f}}};
  world.add_shape(ground, geometry::make_triangle_mesh(vertices, indices, materials).value(), d).value();
  auto first = Character3::create(world, {}, {-2, skin, -2}).value();
  auto second = Character3::create(world, {}, {2, skin, 2}).value();
  walk(world, first, {}, 61);
  walk(world, second, {}, 61);
  EXPECT_NEAR(first.feet().x, -1, 0.01);
  EXPECT_NEAR(first.feet().z, -2, 1e-3);
  EXPECT_NEAR(second.feet().x, 2, 1e-3);
  EXPECT_NEAR(second.feet().z, 1.5, 0.01);
}

TYPED_TEST(PlatformGame, TheWorldsFilterIsAsked) {
  using D = TypeParam;
  World<D> world = level<D>();
  const auto add_wall = [&](double x) {
    const BodyId wall = add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 2, 3), at<D>(x, 2));
    std::vector<ShapeId> shapes;
    world.shapes(wall, shapes);
    return shapes.front();
  };
  const ShapeId open = add_wall(1.5), shut = add_wall(3);
  auto c = stand_at(world, 0, 0);
  int asked = 0;
  world.set_contact_filter([&](ShapeId a, ShapeId b) {
    ++asked;
    return a != open && b != open;
  });
  walk(world, c, along<D>(2, 0), 120);
  EXPECT_GT(asked, 0);
  EXPECT_NEAR(c.feet().x, 3 - 0.1 - 0.3 - double(skin), 2e-3) << "at the second wall";
  world.set_contact_filter([&](ShapeId a, ShapeId b) { return a != shut && b != shut; });
  walk(world, c, along<D>(2, 0), 60);
  EXPECT_GT(c.feet().x, 4);
}

// Characters that are bodies meet one-way platforms as bodies do.
TYPED_TEST(PlatformGame, BodiesThatWalkJumpThroughAndStandToo) {
  using D = TypeParam;
  World<D> world = level<D>();
  add_one_way(world, 1.9);
  auto c = DynamicCharacter<D>::create(world, {}, at<D>(0, 0)).value();
  double highest = 0;
  for (int i = 0; i < 150; ++i) {
    c.move(world, along<D>(0, i == 10 ? 7.0f : 0.0f), frame).value();
    world.step(frame).value();
    highest = std::max(highest, c.feet(world).y);
  }
  EXPECT_NEAR(highest, 49 / (2 * double(g)), 0.05);
  EXPECT_NEAR(c.feet(world).y, 1.9, 0.01);
  EXPECT_EQ(c.ground().state, GroundState::on_ground);
  for (int i = 0; i < 60; ++i) {
    c.move(world, along<D>(1, 0), frame).value();
    world.step(frame).value();
  }
  EXPECT_NEAR(c.feet(world).x, 1, 0.1);
  EXPECT_NEAR(c.feet(world).y, 1.9, 0.01);
}

}  // namespace platform_game_test
}  // namespace carom::rigid::test
