#include "carom/geometry/hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carom/geometry/mass_properties.h"

namespace carom::geometry::hull_test {
namespace {

// A linear congruential generator whose sequence the rigid-body scene recipes give: exact integers, any platform.
struct Sequence {
  std::uint32_t state;
  std::uint32_t a = 1664525, c = 1013904223;
  double unit() { return double((state = a * state + c) >> 8) / double(1 << 24); }
  Vec3f in_cube() {
    const double x = unit(), y = unit(), z = unit();
    return {float(2 * x - 1), float(2 * y - 1), float(2 * z - 1)};
  }
};

void expect_sound(const Hull& hull, std::span<const Vec3f> points, const char* what) {
  const auto status = validate_hull(hull, points, 8 * hull_tolerance(points));
  EXPECT_TRUE(status.ok()) << what << ": " << (status.ok() ? "" : status.error().message);
}

std::vector<Vec3f> cube_grid(int n) {
  std::vector<Vec3f> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        points.push_back({2.0f * float(i) / float(n - 1) - 1, 2.0f * float(j) / float(n - 1) - 1,
                          2.0f * float(k) / float(n - 1) - 1});
  return points;
}

// The rock of Box3D's junkyard scene as that engine lists it: ten points at heights 1 − (2i + 1)/10 on a sphere of
// radius 1.5, turned by the golden angle. Published: 24 edges, 16 faces, volume 7.168672, centre (0.004822, −0.024283,
// 0), inner radius 0.987177 (single precision).
TEST(HullTest, RockOfJunkyardScene) {
  const Vec3f points[] = {{0.870830238f, -1.13540971f, 0.450000048f},   {1.2590425f, 0.801444054f, -0.150000095f},
                          {-0.604231358f, -0.249809593f, -1.3499999f},  {0.653834939f, 0, 1.3499999f},
                          {0.113410115f, 1.29407811f, 0.75f},           {-0.789835572f, -0.723643482f, 1.04999995f},
                          {1.00639534f, -0.366972625f, -1.05000019f},   {-0.599232316f, 1.15257156f, -0.75f},
                          {-0.370959997f, -1.38198745f, -0.449999928f}, {-1.46973026f, 0.259601593f, 0.150000095f}};
  const auto hull = make_hull(points);
  ASSERT_TRUE(hull.ok()) << hull.error().message;
  EXPECT_EQ((*hull)->vertices.size(), 10u);
  EXPECT_EQ((*hull)->edges.size(), 48u);
  EXPECT_EQ((*hull)->faces.size(), 16u);
  EXPECT_NEAR((*hull)->volume, 7.168672, 5e-6);
  EXPECT_NEAR((*hull)->centroid.x, 0.004822, 2e-6);
  EXPECT_NEAR((*hull)->centroid.y, -0.024283, 2e-6);
  EXPECT_NEAR((*hull)->centroid.z, 0, 2e-6);
  EXPECT_NEAR((*hull)->inner_radius, 0.987177, 2e-6);
  expect_sound(**hull, points, "rock");
}

// Recipe: 32 points on a sphere of radius 2 from s ← 2147001325 s + 715136305 mod 2³², seed 42. Published (Box3D's
// convex_pile): 32 vertices, 89 edges, 59 faces, volume 23.404310.
TEST(HullTest, ConvexPileScene) {
  std::vector<Vec3f> points;
  std::uint32_t s = 42;
  const auto draw = [&s] { return double((s = 2147001325u * s + 715136305u) & 0xFFFF) / 65535 - 0.5; };
  while (points.size() < 32) {
    const double x = draw(), y = draw(), z = draw();
    const double l = std::sqrt(x * x + y * y + z * z);
    if (l * l > 0.25) continue;
    points.push_back({float(2 * x / l), float(2 * y / l), float(2 * z / l)});
  }
  EXPECT_NEAR(points[0].x, -1.96552f, 1e-5);
  EXPECT_NEAR(points[0].y, 0.21244f, 1e-5);
  EXPECT_NEAR(points[0].z, -0.30263f, 1e-5);
  const auto hull = make_hull(points);
  ASSERT_TRUE(hull.ok()) << hull.error().message;
  EXPECT_EQ((*hull)->vertices.size(), 32u);
  EXPECT_EQ((*hull)->edges.size(), 2 * 89u);
  EXPECT_EQ((*hull)->faces.size(), 59u);
  EXPECT_NEAR((*hull)->volume, 23.404310, 2e-5);
  EXPECT_NEAR((*hull)->inner_radius, 1.481190, 2e-6);
  expect_sound(**hull, points, "pile");
}

TEST(HullTest, CubeOfAThousandGridPointsHasEightCornersAndSixFaces) {
  const auto points = cube_grid(10);
  const auto hull = make_hull(points);
  ASSERT_TRUE(hull.ok()) << hull.error().message;
  EXPECT_EQ((*hull)->vertices.size(), 8u);
  EXPECT_EQ((*hull)->edges.size(), 24u);
  EXPECT_EQ((*hull)->faces.size(), 6u);
  EXPECT_FLOAT_EQ((*hull)->volume, 8);
  EXPECT_FLOAT_EQ((*hull)->inner_radius, 1);
  expect_sound(**hull, points, "cube");
}

TEST(HullTest, CubeStaysACubeTurnedMovedAndScaled) {
  const auto grid = cube_grid(10);
  Sequence random{7};
  for (const float scale : {1e-4f, 1e-2f, 1.0f, 1e3f, 1e6f})
    for (int k = 0; k < 20; ++k) {
      const double turn = random.unit();
      const Quatf q = normalize(Quatf{float(turn), random.in_cube().x, random.in_cube().y, random.in_cube().z});
      const Vec3f shift = k % 2 ? random.in_cube() * (5 * scale) : Vec3f{};
      std::vector<Vec3f> points;
      for (const Vec3f& p : grid) points.push_back(rotate(q, p) * scale + shift);
      const auto hull = make_hull(points);
      ASSERT_TRUE(hull.ok()) << hull.error().message << " scale " << scale << " case " << k;
      EXPECT_EQ((*hull)->vertices.size(), 8u) << scale << " " << k;
      EXPECT_EQ((*hull)->faces.size(), 6u) << scale << " " << k;
      EXPECT_NEAR((*hull)->volume / (8 * double(scale) * scale * scale), 1, 1e-4);
      expect_sound(**hull, points, "turned cube");
    }
}

TEST(HullTest, PointsOnASphere) {
  Sequence random{3};
  for (const float scale : {1e-4f, 1.0f, 1e6f})
    for (const int n : {4, 5, 8, 20, 50, 100, 128, 200}) {
      std::vector<Vec3f> points;
      while (int(points.size()) < n) {
        const Vec3f p = random.in_cube();
        if (length(p) > 0.1f && length(p) < 1) points.push_back(normalize(p) * scale);
      }
      const auto hull = make_hull(points, {.max_vertices = 255});
      ASSERT_TRUE(hull.ok()) << hull.error().message;
      expect_sound(**hull, points, "sphere");
    }
}

TEST(HullTest, SimplifiedHullKeepsTheNumberOfCornersAndMostOfTheVolume) {
  Sequence random{11};
  std::vector<Vec3f> points;
  while (points.size() < 20000) {
    const Vec3f p = random.in_cube();
    if (length(p) > 0.1f && length(p) < 1) points.push_back(normalize(p));
  }
  const auto refused = make_hull(points);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("more than 128 corners"), std::string::npos) << refused.error().message;
  double before = 0;
  for (const int n : {8, 16, 32, 64, 128, 255}) {
    const auto hull = make_hull(points, {.max_vertices = n, .simplify = true});
    ASSERT_TRUE(hull.ok()) << hull.error().message;
    EXPECT_LE((*hull)->vertices.size(), std::size_t(n));
    EXPECT_TRUE(validate_hull(**hull, {}, 1e-4).ok());
    EXPECT_GT((*hull)->volume, before);
    before = (*hull)->volume;
  }
  EXPECT_GT(before, 0.95 * 4 * pi / 3);
}

// Clouds built to be awkward: points in few planes, on few lines, duplicated, all but flat, on lattices.
TEST(HullTest, RandomDegenerateCloudsGiveASoundHullOrAClearError) {
  Sequence random{99};
  int made = 0;
  for (int k = 0; k < 3000; ++k) {
    const int n = 4 + int(random.unit() * 60), kind = k % 8;
    const double flat = std::pow(10.0, -8 * random.unit());
    std::vector<Vec3f> points;
    for (int i = 0; i < n; ++i) {
      Vec3f p = random.in_cube();
      if (kind == 1) p = {std::round(p.x * 2), std::round(p.y * 2), std::round(p.z * 2)};
      if (kind == 2) p.y *= float(flat);
      if (kind == 3) p = {p.x, float(p.x * 0.3 + p.z * 0.7), p.z};
      if (kind == 4) p = {p.x, p.y * float(flat), p.z * float(flat)};
      if (kind == 5) p = normalize(Vec3f{p.x, 0, p.z}) + Vec3f{0, i % 2 ? 1.0f : -1.0f, 0};
      if (kind == 6 && i > 4) p = points[std::size_t(i) % 4] + p * float(flat);
      if (kind == 7) p = lerp(Vec3f{-1, 0, 0}, Vec3f{1, 1, 1}, p.x) + (i % 3 ? Vec3f{} : Vec3f{0, p.y, p.z});
      points.push_back(p);
    }
    const auto hull = make_hull(points, {.max_vertices = 255});
    if (hull.ok()) {
      ++made;
      expect_sound(**hull, points, "degenerate");
    } else {
      EXPECT_EQ(hull.error().message.find("no sound hull"), std::string::npos)
          << hull.error().message << " kind " << kind << " case " << k;
    }
  }
  EXPECT_GT(made, 1400);
}

TEST(HullTest, FlatCloudsAreNamed) {
  const auto message = [](std::vector<Vec3f> points) {
    const auto hull = make_hull(points);
    return hull.ok() ? std::string("ok") : hull.error().message;
  };
  EXPECT_NE(message({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).find("in one place"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 5}}).find("on one line"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {3, 5, 0}}).find("in one plane"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).find("at least 4"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 1}}).find("point 3"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {INFINITY, 0, 1}}).find("point 3"), std::string::npos);
}

TEST(HullTest, OrderOfThePointsDoesNotMatterToTheSolid) {
  Sequence random{5};
  std::vector<Vec3f> points;
  for (int i = 0; i < 60; ++i) points.push_back(random.in_cube());
  const auto a = make_hull(points);
  std::reverse(points.begin(), points.end());
  const auto b = make_hull(points);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ((*a)->vertices.size(), (*b)->vertices.size());
  EXPECT_EQ((*a)->faces.size(), (*b)->faces.size());
  EXPECT_NEAR((*a)->volume, (*b)->volume, 1e-6);
}

TEST(HullTest, ValidateFindsDamage) {
  const auto good = make_hull(cube_grid(2));
  ASSERT_TRUE(good.ok());
  Hull hull = **good;
  hull.edges[3].next = hull.edges[3].twin;
  EXPECT_FALSE(validate_hull(hull, {}, 1e-5).ok());
  hull = **good;
  hull.vertices[0] = hull.vertices[0] * 1.1f;
  EXPECT_FALSE(validate_hull(hull, {}, 1e-5).ok());
  hull = **good;
  hull.planes[2].offset += 0.01f;
  EXPECT_FALSE(validate_hull(hull, {}, 1e-5).ok());
  const Vec3f outside[] = {{0, 1.1f, 0}};
  EXPECT_FALSE(validate_hull(**good, outside, 1e-5).ok());
}

}  // namespace
}  // namespace carom::geometry::hull_test
