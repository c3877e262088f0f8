// Terrain that changes while things lie on it: height fields and voxels.
#include <gtest/gtest.h>

#include "carom/geometry/height_field.h"
#include "carom/geometry/voxels.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

struct Land {
  World3 world;
  ShapeId shape;
  std::shared_ptr<const geometry::HeightField> field;
  explicit Land(int threads = 1, int side = 41, std::vector<SurfaceMaterial<Dim3>> surfaces = {})
      : world([&] {
          WorldDef<Dim3> d = world_with<Dim3>();
          d.threads = threads;
          return d;
        }()) {
    std::vector<std::uint8_t> materials;
    if (!surfaces.empty()) materials.assign(std::size_t(side - 1) * std::size_t(side - 1), 0);
    field = geometry::make_height_field(side, side, {0.5f, 0.5f}, std::vector<float>(std::size_t(side) * side, 0.0f),
                                        {}, materials)
                .value();
    const BodyId ground =
        world.create_body({.type = BodyType::fixed, .position = {-0.25 * (side - 1), 0, -0.25 * (side - 1)}}).value();
    shape = world.add_shape(ground, field, {.surfaces = std::move(surfaces)}).value();
  }
  double height(double x, double z) { return world.ray_cast({x, 50, z}, {0, -100, 0}).value().point.y; }
};

TEST(Terrain, WhatIsDugAwayWakesWhoLayOnIt) {
  Land land;
  const BodyId near = add_box<Dim3>(land.world, {0, 0.3, 0}, 0.3f), far = add_box<Dim3>(land.world, {6, 0.3, 6}, 0.3f);
  run(land.world, 120);
  ASSERT_FALSE(land.world.state(near).value().awake);
  ASSERT_FALSE(land.world.state(far).value().awake);
  const std::vector<float> pit(11 * 11, -1.0f);
  land.world.set_heights(land.shape, {15, 15, 11, 11}, pit).value();
  EXPECT_TRUE(land.world.state(near).value().awake);
  EXPECT_FALSE(land.world.state(far).value().awake) << "nothing changed there";
  EXPECT_EQ(land.field->heights[20 * 41 + 20], 0.0f) << "the caller's field stays as it was";
  run(land.world, 180);
  EXPECT_NEAR(land.world.state(near).value().pose.position.y, -0.7, 0.005);
  EXPECT_FALSE(land.world.state(near).value().awake);
  // And up again, at no more than the push speed.
  land.world.set_heights(land.shape, {15, 15, 11, 11}, std::vector<float>(11 * 11, 0.4f)).value();
  float fastest = 0;
  for (int i = 0; i < 240; ++i) {
    land.world.step(frame).value();
    fastest = std::max(fastest, speed(land.world, near));
  }
  EXPECT_NEAR(land.world.state(near).value().pose.position.y, 0.7, 0.005);
  EXPECT_LT(fastest, land.world.definition().contact_push_speed * 1.5f);
  EXPECT_NEAR(land.height(1.5, 1.5), 0.4, 1e-6);
  EXPECT_NEAR(land.height(5, -5), 0, 1e-6);
}

TEST(Terrain, HolesLetThroughAndMaterialsHold) {
  Land land(1, 41, {{{.friction = 1}, {}}, {{.friction = 0}, {}}});
  const BodyId falls = add_ball<Dim3>(land.world, {0.25, 0.2, 0.25}, 0.2f);
  const BodyId slides =
      add_body<Dim3>(land.world, BodyType::dynamic, box_shape<Dim3>(0.2f, 0.2f, 0.2f), {-4, 0.2, 4}, {.friction = 1});
  run(land.world, 90);
  const std::vector<std::uint8_t> nine(9, 1);
  land.world.set_holes(land.shape, {19, 19, 3, 3}, nine).value();
  land.world.set_cell_materials(land.shape, {0, 0, 40, 40}, std::vector<std::uint8_t>(1600, 1)).value();
  land.world.set_velocity(slides, {2, 0, 0}, {}).value();
  run(land.world, 60);
  EXPECT_LT(land.world.state(falls).value().pose.position.y, -1);
  EXPECT_NEAR(speed(land.world, slides), 2, 2e-3f) << "on ice now";
  land.world.set_holes(land.shape, {19, 19, 3, 3}, std::vector<std::uint8_t>(9, 0)).value();
  EXPECT_NEAR(land.height(0.25, 0.25), 0, 1e-6);
}

TEST(Terrain, SnapshotsCarryWhatWasChanged) {
  Land land(1, 257), other(1, 257);
  const BodyId ball = add_ball<Dim3>(land.world, {0.1, 1, 0}, 0.3f);
  add_ball<Dim3>(other.world, {0.1, 1, 0}, 0.3f);
  run(land.world, 30);
  const Snapshot<Dim3> before = land.world.snapshot();
  land.world.set_heights(land.shape, {126, 126, 5, 5}, std::vector<float>(25, -2.0f)).value();
  run(land.world, 30);
  const Snapshot<Dim3> after = land.world.snapshot();
  run(land.world, 60);
  const std::uint64_t expected = land.world.state_hash();
  land.world.set_heights(land.shape, {100, 100, 60, 60}, std::vector<float>(3600, 3.0f)).value();
  run(land.world, 10);
  // Back to after the pit, in this world and, as bytes, in one that never saw it.
  land.world.restore(after).value();
  EXPECT_NEAR(land.height(0.7, 0.7), -2, 1e-6);
  run(land.world, 60);
  EXPECT_EQ(land.world.state_hash(), expected);
  other.world.restore(Snapshot<Dim3>::decode(after.encode(), {}).value()).value();
  EXPECT_NEAR(other.height(0.7, 0.7), -2, 1e-6);
  run(other.world, 60);
  EXPECT_EQ(other.world.state_hash(), expected);
  // A difference holds the pit, not the field.
  const std::vector<std::byte> difference = after.encode(before);
  EXPECT_LT(difference.size(), 1500u);
  const Snapshot<Dim3> again = Snapshot<Dim3>::decode(difference, before).value();
  land.world.restore(again).value();
  EXPECT_NEAR(land.height(0.7, 0.7), -2, 1e-6);
  // And to before it, also from bytes, which name the field as it was made.
  land.world.restore(before).value();
  EXPECT_NEAR(land.height(0.7, 0.7), 0, 1e-6);
  land.world.restore(after).value();
  land.world.restore(Snapshot<Dim3>::decode(before.encode(), {}).value()).value();
  EXPECT_NEAR(land.height(0.7, 0.7), 0, 1e-6);
  EXPECT_TRUE(land.world.contains(ball));
}

TEST(Terrain, ChangesAreTheSameOnTwoThreads) {
  std::uint64_t hashes[2];
  for (const int threads : {1, 2}) {
    Land land(threads);
    for (int i = 0; i < 40; ++i)
      add_box<Dim3>(land.world, {0.7 * (i % 7) - 2, 0.4 + 0.65 * (i / 20), 0.7 * (i / 7 % 3) - 1}, 0.25f);
    for (int i = 0; i < 120; ++i) {
      if (i % 10 == 0) {
        const float h = 0.1f * float(i % 30 / 10) - 0.1f;
        land.world.set_heights(land.shape, {16 + i / 20, 18, 3, 3}, std::vector<float>(9, h)).value();
      }
      land.world.step(frame).value();
    }
    hashes[threads - 1] = land.world.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Terrain, WhatDoesNotFitIsNamed) {
  Land land;
  const auto message = [](const Status& s) { return s.ok() ? std::string("accepted") : s.error().message; };
  const std::vector<float> four(4, 1.0f);
  EXPECT_NE(message(land.world.set_heights(land.shape, {40, 0, 2, 2}, four)).find("column 40 and has 2 columns"),
            std::string::npos);
  EXPECT_NE(message(land.world.set_heights(land.shape, {0, 0, 2, 3}, four)).find("4 heights for a rectangle of 6"),
            std::string::npos);
  const std::vector<float> bad{0, 0, 1e30f, 0};
  EXPECT_NE(message(land.world.set_heights(land.shape, {3, 5, 2, 2}, bad)).find("column 3, row 6"), std::string::npos);
  const BodyId box = add_box<Dim3>(land.world, {0, 3, 0});
  std::vector<ShapeId> shapes;
  land.world.shapes(box, shapes);
  EXPECT_NE(message(land.world.set_heights(shapes[0], {0, 0, 2, 2}, four)).find("expected a height field"),
            std::string::npos);
  EXPECT_NE(message(land.world.set_cells(land.shape, {}, std::vector<std::uint8_t>{1})).find("expected a voxel grid"),
            std::string::npos);
  EXPECT_EQ(land.height(3, 3), 0);
}

// Voxels -----------------------------------------------------------------------------------------------------------

/// 40 × 6 × 16 cells of 0.5 m, the lower three layers filled: the ground is at 1.5 m.
struct Cubes {
  World3 world{world_with<Dim3>()};
  ShapeId shape;
  explicit Cubes(int layers = 3) {
    std::vector<std::uint8_t> cells;
    for (int k = 0; k < 16; ++k)
      for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 40; ++i) cells.push_back(std::uint8_t(j < layers ? 1 : 0));
    const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
    shape = world
                .add_shape(ground, geometry::make_voxel_grid(40, 6, 16, 0.5f, cells).value(),
                           {.material = {.friction = 0.6f}})
                .value();
  }
};

// The bar of the gates for flush tiles: nothing loses more than a thousandth of its speed to the seams.
TEST(Voxels, NothingCatchesOnTheSeams) {
  const geometry::Shape3 shapes[] = {geometry::Sphere{0.3f}, geometry::Box{{0.3f, 0.2f, 0.25f}},
                                     geometry::Capsule3{0.3f, 0.2f}, geometry::Cylinder{0.2f, 0.3f},
                                     geometry::Ellipsoid{{0.3f, 0.2f, 0.25f}}};
  for (const geometry::Shape3& shape : shapes) {
    Cubes cubes;
    const geometry::Bounds3f b = geometry::bounds(shape, {});
    const BodyId body = add_body<Dim3>(cubes.world, BodyType::dynamic, shape, {1, 1.5 + double(b.high.y), 4.13},
                                       {.friction = 0}, {9, 0, 0.4f});
    run(cubes.world, 100);
    const BodyState<Dim3> s = cubes.world.state(body).value();
    EXPECT_GT(s.pose.position.x, 15.5);
    EXPECT_NEAR(s.linear_velocity.x, 9, 0.009f) << int(shape.type);
    EXPECT_NEAR(s.linear_velocity.z, 0.4, 0.009f) << int(shape.type);
    EXPECT_NEAR(s.pose.position.y, 1.5 + double(b.high.y), 0.005) << int(shape.type);
  }
}

TEST(Voxels, AreDugAndFilled) {
  Cubes cubes;
  const BodyId box = add_box<Dim3>(cubes.world, {5.25, 1.7, 4.25}, 0.2f);
  const BodyId ball = add_ball<Dim3>(cubes.world, {12.25, 1.7, 4.25}, 0.2f, {.rolling_resistance = 0.1f});
  run(cubes.world, 120);
  ASSERT_FALSE(cubes.world.state(box).value().awake);
  const std::uint64_t rests = cubes.world.state_hash();
  // A shaft of 1 × 2 × 1 cells under the box.
  cubes.world.set_cells(cubes.shape, {10, 1, 8, 1, 2, 1}, std::vector<std::uint8_t>(2, 0)).value();
  run(cubes.world, 120);
  EXPECT_NEAR(cubes.world.state(box).value().pose.position.y, 0.7, 0.005);
  EXPECT_NEAR(cubes.world.state(box).value().pose.position.x, 5.25, 0.05);
  EXPECT_NE(cubes.world.state_hash(), rests);
  // Filled again, over the box: it comes out on top, no faster than the push speed.
  cubes.world.set_cells(cubes.shape, {10, 1, 8, 1, 2, 1}, std::vector<std::uint8_t>(2, 1)).value();
  float fastest = 0;
  for (int i = 0; i < 300; ++i) {
    cubes.world.step(frame).value();
    fastest = std::max(fastest, speed(cubes.world, box));
  }
  EXPECT_NEAR(cubes.world.state(box).value().pose.position.y, 1.7, 0.005);
  EXPECT_LT(fastest, cubes.world.definition().contact_push_speed * 1.5f);
  EXPECT_NEAR(cubes.world.state(ball).value().pose.position.y, 1.7, 0.005);
}

TEST(Voxels, WallsStopWhatFlies) {
  Cubes cubes(1);
  // A wall of one cell, 2.5 m high, at x = 10 … 10.5.
  cubes.world.set_cells(cubes.shape, {20, 1, 0, 1, 5, 16}, std::vector<std::uint8_t>(5 * 16, 1)).value();
  std::vector<BodyId> bodies;
  const geometry::Shape3 shapes[] = {geometry::Sphere{0.1f}, geometry::Box{{0.1f, 0.1f, 0.1f}},
                                     geometry::Capsule3{0.1f, 0.05f}};
  for (int i = 0; i < 60; ++i)
    bodies.push_back(add_body<Dim3>(cubes.world, BodyType::dynamic, shapes[i % 3],
                                    {2 + 0.03 * i, 0.8 + 0.3 * (i % 6), 0.4 + 0.7 * (i / 6)}, {}, {300, 0, 0}));
  run(cubes.world, 30);
  for (const BodyId body : bodies) EXPECT_LT(cubes.world.state(body).value().pose.position.x, 10);
}

TEST(Voxels, SnapshotsCarryThemToo) {
  Cubes cubes, other;
  add_box<Dim3>(cubes.world, {5.25, 1.8, 4.25}, 0.2f);
  add_box<Dim3>(other.world, {5.25, 1.8, 4.25}, 0.2f);
  run(cubes.world, 20);
  cubes.world.set_cells(cubes.shape, {9, 0, 7, 3, 3, 3}, std::vector<std::uint8_t>(27, 0)).value();
  run(cubes.world, 5);
  const Snapshot<Dim3> snapshot = cubes.world.snapshot();
  run(cubes.world, 40);
  other.world.restore(Snapshot<Dim3>::decode(snapshot.encode(), {}).value()).value();
  run(other.world, 40);
  EXPECT_EQ(other.world.state_hash(), cubes.world.state_hash());
}

TEST(Voxels, WhatDoesNotFitIsNamed) {
  const auto grid = [](int columns, int layers, int rows, float cell, std::vector<std::uint8_t> cells) {
    const auto r = geometry::make_voxel_grid(columns, layers, rows, cell, std::move(cells));
    return r.ok() ? std::string("accepted") : r.error().message;
  };
  EXPECT_NE(grid(0, 1, 1, 1, {}).find("0 columns"), std::string::npos);
  EXPECT_NE(grid(1024, 1024, 1024, 1, {}).find("cells, expected at most"), std::string::npos);
  EXPECT_NE(grid(2, 2, 2, -1, {}).find("cell"), std::string::npos);
  EXPECT_NE(grid(2, 2, 2, 1, {1, 1}).find("2 cells, expected none or columns × layers × rows = 8"), std::string::npos);
  Cubes cubes;
  const auto message = [](const Status& s) { return s.ok() ? std::string("accepted") : s.error().message; };
  EXPECT_NE(message(cubes.world.set_cells(cubes.shape, {0, 5, 0, 1, 2, 1}, std::vector<std::uint8_t>(2, 0)))
                .find("begins at layer 5 and has 2 layers"),
            std::string::npos);
  const BodyId body = cubes.world.create_body({}).value();
  EXPECT_FALSE(cubes.world.add_shape(body, geometry::make_voxel_grid(2, 2, 2, 1).value()).ok()) << "a dynamic one";
}

}  // namespace
}  // namespace carom::rigid::test
