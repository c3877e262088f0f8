// Tiles of the plane: their outlines, and bodies on ground that is dug and filled.
#include <gtest/gtest.h>

#include "carom/rigid/tile_ground.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

/// Twice the area that a closed line runs round, counterclockwise positive.
double doubled_area(const geometry::Chain& chain) {
  double sum = 0;
  for (std::size_t i = 0; i < chain.points.size(); ++i)
    sum += double(cross(chain.points[i], chain.points[(i + 1) % chain.points.size()]));
  return sum;
}

TEST(TileGround, OutlinesEncloseWhatIsFilled) {
  std::uint32_t state = 77;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<std::uint8_t> cells;
    int filled = 0, borders = 0;
    for (int i = 0; i < 13 * 9; ++i) {
      state = 1664525u * state + 1013904223u;
      cells.push_back(std::uint8_t((state >> 20) % 5 < std::uint32_t(1 + trial % 4) ? 1 + (state >> 28) % 2 : 0));
      filled += cells.back() != 0;
    }
    const auto at = [&](int i, int j) {
      return i >= 0 && j >= 0 && i < 13 && j < 9 && cells[std::size_t(j * 13 + i)] != 0;
    };
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 13; ++i)
        if (at(i, j)) borders += !at(i - 1, j) + !at(i + 1, j) + !at(i, j - 1) + !at(i, j + 1);
    double area = 0, length = 0;
    const std::vector<std::shared_ptr<const geometry::Chain>> outlines = outline_tiles(13, 9, 0.5f, cells).value();
    for (const auto& chain : outlines) {
      area += doubled_area(*chain) / 2;
      for (int i = 0; i < chain->segment_count(); ++i) {
        const geometry::ChainSegment s = chain->segment(i);
        length += double(math::length(s.b - s.a));
        // The material is that of the cells to the left of the segment, all along.
        const Vec2f way = math::normalize(s.b - s.a), in{-way.y, way.x};
        for (float t = 0.25f; t < math::length(s.b - s.a); t += 0.5f) {
          const Vec2f p = s.a + way * t + in * 0.1f;
          const std::uint8_t cell = cells[std::size_t(int(p.y / 0.5f) * 13 + int(p.x / 0.5f))];
          ASSERT_NE(cell, 0);
          if (!chain->materials.empty()) EXPECT_EQ(chain->materials[std::size_t(i)], cell - 1);
        }
      }
    }
    EXPECT_NEAR(area, 0.25 * filled, 1e-4);
    EXPECT_NEAR(length, 0.5 * borders, 1e-3);
  }
}

struct Ground {
  World2 world{world_with<Dim2>()};
  TileGround tiles;
  Ground() {
    std::vector<std::uint8_t> cells;
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 60; ++i) cells.push_back(std::uint8_t(j < 4 ? (i < 30 ? 1 : 2) : 0));
    const BodyId body = world.create_body({.type = BodyType::fixed}).value();
    ShapeDef<Dim2> d;
    d.surfaces = {{{.friction = 0.6f}, {}}, {{.friction = 0}, {}}};
    tiles = TileGround::create(world, body, 60, 8, 0.5f, cells, d).value();
  }
};

TEST(TileGround, NothingCatchesBetweenTiles) {
  for (int kind = 0; kind < 3; ++kind) {
    Ground ground;
    const geometry::Shape2 shapes[] = {geometry::Circle{0.3f}, geometry::make_box2({0.3f, 0.25f}),
                                       geometry::Capsule2{0.2f, 0.2f}};
    const double heights[] = {0.3, 0.25, 0.4};
    const BodyId body = add_body<Dim2>(ground.world, BodyType::dynamic, shapes[kind], {15.6, 2 + heights[kind]},
                                       {.friction = 0}, {8, 0});
    ground.world.set_locks(body, {.rotation_z = true}).value();
    run(ground.world, 80);
    EXPECT_NEAR(ground.world.state(body).value().linear_velocity.x, 8, 0.008f) << kind;
    EXPECT_NEAR(ground.world.state(body).value().pose.position.y, 2 + heights[kind], 0.005) << kind;
  }
}

TEST(TileGround, IsDugAndFilled) {
  Ground ground;
  const BodyId box = add_box<Dim2>(ground.world, {5.25, 2.2}, 0.2f);
  run(ground.world, 90);
  ASSERT_FALSE(ground.world.state(box).value().awake);
  ASSERT_EQ(ground.tiles.shapes().size(), 1u);
  ground.tiles.set_cells(ground.world, {10, 2, 1, 2}, std::vector<std::uint8_t>(2, 0)).value();
  EXPECT_TRUE(ground.world.state(box).value().awake);
  run(ground.world, 90);
  EXPECT_NEAR(ground.world.state(box).value().pose.position.y, 1.2, 0.005);
  // A cave far below is an outline of its own, and the surface stays the shape that it was.
  const ShapeId surface = ground.tiles.shapes()[0];
  ground.tiles.set_cells(ground.world, {30, 1, 4, 1}, std::vector<std::uint8_t>(4, 0)).value();
  ASSERT_EQ(ground.tiles.shapes().size(), 2u);
  EXPECT_TRUE(ground.world.contains(surface));
  EXPECT_FALSE(ground.world.state(box).value().awake) << "nothing changed where it lies";
  ground.tiles.set_cells(ground.world, {9, 4, 3, 1}, std::vector<std::uint8_t>(3, 1)).value();
  run(ground.world, 30);
  EXPECT_NEAR(ground.world.state(box).value().pose.position.y, 1.2, 0.005) << "shut in";
  EXPECT_NE(ground.world.ray_cast({5.25, 9}, {0, -9}).value().point.y, 2) << "a roof over it";
}

TEST(TileGround, WhatDoesNotFitIsNamed) {
  Ground ground;
  const auto message = [](const auto& s) { return s.ok() ? std::string("accepted") : s.error().message; };
  EXPECT_NE(message(ground.tiles.set_cells(ground.world, {58, 0, 3, 1}, std::vector<std::uint8_t>(3, 0)))
                .find("begins at column 58 and has 3 columns"),
            std::string::npos);
  EXPECT_NE(message(ground.tiles.set_cells(ground.world, {0, 0, 3, 1}, std::vector<std::uint8_t>(2, 0)))
                .find("2 values for a block of 3"),
            std::string::npos);
  EXPECT_NE(message(ground.tiles.set_cells(ground.world, {0, 0, 1, 1}, std::vector<std::uint8_t>(1, 9)))
                .find("surfaces has 2 entries"),
            std::string::npos)
      << "a material that there is no surface for";
  EXPECT_EQ(ground.tiles.at(0, 0), 1) << "refused: nothing changed";
  EXPECT_NE(message(outline_tiles(0, 4, 1, {})).find("0 columns"), std::string::npos);
  const BodyId body = ground.world.create_body({}).value();
  EXPECT_NE(message(TileGround::create(ground.world, body, 1, 1, 1, {1})).find("dynamic"), std::string::npos);
}

}  // namespace
}  // namespace carom::rigid::test
