// Polygons in pieces (shared reference "ballistics", 2.14): areas are those of the whole, slabs and courses of bricks
// lie where they belong, and what breaks free keeps its momentum.
#include "carom/blast/fracture2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "carom/blast/structure.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace fracture2_test {
using namespace carom;
using namespace carom::blast;
using math::Vec2d;
using rigid::Dim2;

const std::vector<Vec2d> wall{{-2, -1.12}, {2, -1.12}, {2, 1.12}, {-2, 1.12}};

double area_of(const std::vector<Vec2d>& outline) {
  double area = 0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i)
    area += 0.5 * cross(outline[i] - outline[0], outline[i + 1] - outline[0]);
  return area;
}

/// Pieces and bonds of a cut have nothing between them.
void expect_whole(const Fracture2& f, double area) {
  double sum = 0, cut = 0, bonded = 0;
  for (const Piece2& p : f.pieces) {
    sum += p.mass.mass;
    for (std::size_t i = 0; i < p.outline.size(); ++i)
      if (p.sources[i] < 0) cut += distance(p.outline[i], p.outline[(i + 1) % p.outline.size()]);
  }
  for (const Bond2& b : f.bonds) bonded += b.length;
  EXPECT_NEAR(sum, area, 1e-12 * area);
  EXPECT_NEAR(2 * bonded, cut, 1e-9 * cut);
}

TEST(Fracture2, PiecesAreTheWhole) {
  // A concave one: an L with a notch.
  const std::vector<Vec2d> outline{{0, 0}, {3, 0}, {3, 1}, {2, 0.6}, {1, 1}, {1, 3}, {0, 3}};
  const double area = area_of(outline);
  const auto sites = uniform_sites2({{0, 0}, {3, 3}}, 50, 6);
  const auto f = fracture_polygon(outline, voronoi_pattern2(sites).value());
  ASSERT_TRUE(f) << f.error().message;
  expect_whole(*f, area);
  double hulls = 0;
  for (const Piece2& p : f->pieces)
    for (const geometry::Polygon& polygon : p.polygons) hulls += geometry::mass_properties(polygon, 1).mass;
  EXPECT_LT(hulls, area);
  EXPECT_GT(hulls, 0.97 * area);
  math::Random random(1);
  const auto inside = [](const std::vector<Vec2d>& o, Vec2d p) {
    bool in = false;
    for (std::size_t i = 0, j = o.size() - 1; i < o.size(); j = i++)
      if ((o[i].y > p.y) != (o[j].y > p.y) && p.x < o[i].x + (o[j].x - o[i].x) * (p.y - o[i].y) / (o[j].y - o[i].y))
        in = !in;
    return in;
  };
  for (int k = 0; k < 5000; ++k) {
    const Vec2d p{random.uniform(0.0, 3.0), random.uniform(0.0, 3.0)};
    int count = 0;
    for (const Piece2& piece : f->pieces) count += inside(piece.outline, p);
    EXPECT_EQ(count, inside(outline, p) ? 1 : 0);
  }
  std::vector<Vec2d> clockwise(outline.rbegin(), outline.rend());
  EXPECT_FALSE(fracture_polygon(clockwise, voronoi_pattern2(sites).value()));
  const std::vector<Vec2d> bow{{0, 0}, {2, 2}, {2, 0}, {0, 3}};
  EXPECT_FALSE(fracture_polygon(bow, voronoi_pattern2(sites).value()));
}

TEST(Fracture2, SlabsAreAsThickAsTheySay) {
  const auto even = fracture_polygon(wall, slab_pattern2(wall, {0, 3}, 7).value()).value();
  ASSERT_EQ(even.pieces.size(), 7u);
  ASSERT_EQ(even.bonds.size(), 6u);
  expect_whole(even, 4 * 2.24);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_NEAR(even.pieces[k].mass.mass, 4 * 0.32, 1e-6);
    EXPECT_NEAR(even.pieces[k].mass.center.y, -1.12 + 0.32 * (double(k) + 0.5), 1e-6);
    EXPECT_EQ(even.pieces[k].polygons.size(), 1u);
  }
  for (const Bond2& b : even.bonds) {
    EXPECT_EQ(b.b, b.a + 1);
    EXPECT_NEAR(b.length, 4, 1e-12);
    EXPECT_EQ(b.normal, (Vec2d{0, 1}));
    EXPECT_NEAR(b.center.y, -1.12 + 0.32 * double(b.b), 1e-6);
  }
  // Borders are moved by half of half a thickness at most; the same for the same seed.
  const auto moved = fracture_polygon(wall, slab_pattern2(wall, {0, 1}, 7, 0.5, 9).value()).value();
  expect_whole(moved, 4 * 2.24);
  double farthest = 0;
  for (const Bond2& b : moved.bonds)
    farthest = math::max(farthest, math::abs(b.center.y - (-1.12 + 0.32 * double(b.b))));
  EXPECT_GT(farthest, 0.02);
  EXPECT_LT(farthest, 0.25 * 0.32 + 1e-6);
  EXPECT_EQ(slab_pattern2(wall, {0, 1}, 7, 0.5, 9)->cells[3][0].offset,
            slab_pattern2(wall, {0, 1}, 7, 0.5, 9)->cells[3][0].offset);
  // A trough cut across: two posts and a foot.
  const std::vector<Vec2d> trough{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto parts = fracture_polygon(trough, slab_pattern2(trough, {0, 1}, 4).value()).value();
  EXPECT_EQ(parts.pieces.size(), 6u);
  EXPECT_EQ(parts.bonds.size(), 5u);
  expect_whole(parts, 5);
  expect_whole(fracture_polygon(trough, slab_pattern2(trough, {1, 0.7}, 9, 1, 3).value()).value(), 5);
}

TEST(Fracture2, BricksLieInCoursesThatAreShifted) {
  const auto f = fracture_polygon(wall, brick_pattern2(wall, {0.4, 0.16}, wall[0]).value()).value();
  // 14 courses: ten bricks, then nine between two halves.
  ASSERT_EQ(f.pieces.size(), 7u * 10 + 7u * 11);
  expect_whole(f, 4 * 2.24);
  std::vector<double> joints[14];
  for (const Piece2& p : f.pieces) {
    const int course = int(math::floor((p.mass.center.y + 1.12) / 0.16));
    const bool half = p.mass.mass < 0.05;
    EXPECT_NEAR(p.mass.mass, (half ? 0.2 : 0.4) * 0.16, 1e-6);
    EXPECT_NEAR(p.mass.center.y, -1.12 + 0.16 * (course + 0.5), 1e-6);
    EXPECT_FALSE(half && course % 2 == 0);
    EXPECT_EQ(half, course % 2 == 1 && math::abs(p.mass.center.x) > 1.8);
    EXPECT_EQ(p.polygons.size(), 1u);
  }
  std::size_t head = 0, bed = 0;
  for (const Bond2& b : f.bonds) {
    if (math::abs(b.normal.x) == 1) {
      ++head;
      EXPECT_NEAR(b.length, 0.16, 1e-6);
      joints[int(math::floor((b.center.y + 1.12) / 0.16))].push_back(b.center.x);
    } else {
      ++bed;
      EXPECT_NEAR(b.length, 0.2, 1e-6);
    }
  }
  EXPECT_EQ(head, 7u * 9 + 7u * 10);
  EXPECT_EQ(bed, 13u * 20);
  for (std::size_t course = 0; course < 14; ++course) {
    std::sort(joints[course].begin(), joints[course].end());
    for (std::size_t k = 0; k < joints[course].size(); ++k)
      EXPECT_NEAR(joints[course][k], -2 + 0.4 * double(k) + (course % 2 == 0 ? 0.4 : 0.2), 1e-6);
  }
  // A gate in the wall: bricks are cut where it is, and cells give two pieces.
  const std::vector<Vec2d> gate{{-2, -1.12},   {-0.13, -1.12}, {-0.13, 0.5}, {0.05, 0.5},
                                {0.05, -1.12}, {2, -1.12},     {2, 1.12},    {-2, 1.12}};
  expect_whole(fracture_polygon(gate, brick_pattern2(gate, {0.4, 0.16}, gate[0]).value()).value(), area_of(gate));
}

TEST(Fracture2, BadInputIsNamed) {
  EXPECT_EQ(brick_pattern2(wall, {0.4, 0}, {}).error().message, "size is (0.4, 0), expected metres > 0");
  EXPECT_EQ(brick_pattern2(wall, {0.01, 0.01}, {}).error().message, "brick_pattern2: more than 10000 bricks");
  EXPECT_EQ(brick_pattern2(wall, {1e-9, 1}, {}).error().message, "brick_pattern2: more than 10000 bricks");
  EXPECT_FALSE(brick_pattern2(wall, {1, 1}, {std::numeric_limits<double>::infinity(), 0}));
  EXPECT_FALSE(brick_pattern2({}, {1, 1}, {}));
  EXPECT_EQ(slab_pattern2(wall, {0, 1}, 0).error().message, "count is 0, expected 1 to 10000 slabs");
  EXPECT_EQ(slab_pattern2(wall, {0, 0}, 3).error().message, "normal: expected a direction");
  EXPECT_FALSE(slab_pattern2(wall, {0, 1}, 3, 1.5));
  EXPECT_FALSE(slab_pattern2(std::vector<Vec2d>{{0, std::numeric_limits<double>::quiet_NaN()}}, {0, 1}, 3));
}

// A free wall that a ball comes through: what is given at each hand-over keeps mass, momentum and angular momentum.
TEST(Fracture2, WhatBreaksFreeKeepsItsMomentum) {
  for (const bool bricks : {true, false}) {
    rigid::World2 world({.gravity = {0, 0}});
    const auto pattern =
        bricks ? brick_pattern2(wall, {0.4, 0.16}, wall[0]) : slab_pattern2(wall, {1, 0.2}, 20, 0.3, 2);
    auto d = structure_of(fracture_polygon(wall, pattern.value()).value(), 1900);
    d.material = bond_material(Substance::brick_and_mortar);
    d.angular_velocity = 0.5f;
    auto structure = Structure2::make(world, d).value();
    rigid::BodyDef<Dim2> body;
    body.position = {0.3, -2};
    body.linear_velocity = {0, 60};
    body.bullet = true;
    const auto id = world.create_body(body).value();
    ASSERT_TRUE(world.add_shape(id, geometry::Circle{0.25f}, {.density = 7800}));
    const auto first = world.totals();
    EXPECT_NEAR(first.mass, 1900 * 4 * 2.24 + 7800 * math::pi * 0.0625, 1e-5 * first.mass);
    int rounds = 0;
    for (int i = 0; i < 30; ++i) {
      structure.start_step();
      for (int round = 0; round < 12; ++round) {
        const auto before = world.totals();
        const auto snapshot = world.snapshot();
        ASSERT_TRUE(world.step(1 / 60.f));
        if (!structure.find_breaks(world, 1 / 60.f).value()) break;
        ++rounds;
        ASSERT_TRUE(world.restore(snapshot));
        ASSERT_TRUE(structure.bear(world));
        ASSERT_TRUE(structure.part_bodies(world));
        const auto after = world.totals();
        EXPECT_NEAR(after.mass, before.mass, 1e-6 * before.mass);
        EXPECT_LT(length(after.momentum - before.momentum), 1e-6 * length(before.momentum));
        EXPECT_LT(math::abs(after.angular_momentum - before.angular_momentum), 1e-6 * length(before.momentum));
      }
      ASSERT_TRUE(structure.part_bodies(world));
    }
    const auto after = world.totals();
    EXPECT_NEAR(after.mass, first.mass, 1e-6 * first.mass);
    EXPECT_LT(length(after.momentum - first.momentum), 1e-6 * length(first.momentum));
    EXPECT_GT(structure.broken(), 5u);
    EXPECT_GT(rounds, 0);
  }
}

}  // namespace fracture2_test
