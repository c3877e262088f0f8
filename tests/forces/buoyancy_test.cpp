// Archimedes: submerged volumes and centres against closed forms, and against each other.
#include "carom/forces/buoyancy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace buoyancy_test {
using namespace carom;
using forces::Submerged2;
using forces::Submerged3;
using forces::WaterLine;
using forces::WaterPlane;
using math::Vec2d;
using math::Vec3d;

constexpr Vec2d square[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

WaterPlane tilted(double a, double b, double offset) {
  const Vec3d n = math::normalize(Vec3d{std::sin(a), std::cos(a), b});
  return {n, offset};
}

// A mesh of a sphere, cylinder or capsule: (profile radius, height) pairs turned about y.
struct Mesh {
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> indices;
};
Mesh turned(const std::vector<Vec2d>& profile, int around) {
  Mesh mesh;
  const int rings = int(profile.size());
  for (const Vec2d p : profile)
    for (int i = 0; i < around; ++i) {
      const double t = 2 * math::pi * i / around;
      mesh.vertices.push_back({p.x * std::cos(t), p.y, -p.x * std::sin(t)});
    }
  const auto at = [&](int ring, int i) { return std::uint32_t(ring * around + i % around); };
  for (int r = 0; r + 1 < rings; ++r)
    for (int i = 0; i < around; ++i) {
      for (const std::uint32_t v : {at(r, i), at(r, i + 1), at(r + 1, i + 1)}) mesh.indices.push_back(v);
      for (const std::uint32_t v : {at(r, i), at(r + 1, i + 1), at(r + 1, i)}) mesh.indices.push_back(v);
    }
  return mesh;
}

TEST(SubmergedPlane, SquareAndCircleAgainstClosedForms) {
  const Submerged2 half = forces::submerged(square, 0, {{0, 1}, 0.2});
  EXPECT_NEAR(half.area, 2.4, 1e-14);
  EXPECT_NEAR(half.centroid.y, -0.4, 1e-14);
  EXPECT_NEAR(half.centroid.x, 0, 1e-14);
  const Vec2d center{3, 4};
  for (const double q : {-1.9, -0.5, 0.0, 0.7, 1.99, 2.5}) {
    const Submerged2 circle = forces::submerged(std::span(&center, 1), 2, {{0, 1}, 4 + q});
    const double x = std::min(q, 2.0), root = std::sqrt(4 - x * x);
    const double area = 4 * (math::pi - std::acos(x / 2)) + x * root;
    EXPECT_NEAR(circle.area, area, 1e-13);
    EXPECT_NEAR(circle.centroid.y, 4 - 2.0 / 3 * root * root * root / area, 2e-12);
    EXPECT_NEAR(circle.centroid.x, 3, 1e-12);
  }
}

// Laws for every shape: the two sides of a line make the whole, in area and in first moment.
TEST(SubmergedPlane, BothSidesMakeTheWhole) {
  const std::vector<Vec2d> capsule{{-1, 0.3}, {2, 0.5}};
  const std::vector<Vec2d> triangle{{0, 0}, {2, 0.4}, {0.5, 1.7}};
  const std::vector<Vec2d> circle{{0.3, -0.2}};
  for (const auto& shape : {capsule, triangle, circle})
    for (const double radius : {0.25, 0.6})
      for (int i = 0; i < 60; ++i) {
        const double angle = 0.37 * i, offset = 0.05 * (i % 31) - 0.7;
        const Vec2d n{std::cos(angle), std::sin(angle)};
        const Submerged2 whole = forces::submerged(shape, radius, {n, 100});
        const Submerged2 below = forces::submerged(shape, radius, {n, offset});
        const Submerged2 above = forces::submerged(shape, radius, {-n, -offset});
        EXPECT_NEAR(below.area + above.area, whole.area, 1e-12);
        const Vec2d moment = below.area * below.centroid + above.area * above.centroid - whole.area * whole.centroid;
        EXPECT_NEAR(math::length(moment), 0, 1e-12);
      }
  const Submerged2 whole = forces::submerged(capsule, 0.25, {{0, 1}, 100});
  EXPECT_NEAR(whole.area, math::pi * 0.0625 + 0.5 * std::hypot(3, 0.2), 1e-13);
  EXPECT_NEAR(math::distance(whole.centroid, Vec2d{0.5, 0.4}), 0, 1e-13);
}

TEST(SubmergedPlane, RoundedTriangleEqualsAFinePolygon) {
  const std::vector<Vec2d> triangle{{0, 0}, {2, 0.4}, {0.5, 1.7}};
  std::vector<Vec2d> fine;
  for (int corner = 0; corner < 3; ++corner) {
    const Vec2d p = triangle[std::size_t(corner)], a = p - triangle[std::size_t(corner + 2) % 3],
                b = triangle[std::size_t(corner + 1) % 3] - p;
    const double start = std::atan2(-a.x, a.y), turn = std::atan2(math::cross(a, b), math::dot(a, b));
    for (int i = 0; i <= 2000; ++i) {
      const double t = start + turn * i / 2000;
      fine.push_back(p + 0.3 * Vec2d{std::cos(t), std::sin(t)});
    }
  }
  for (const double offset : {-0.1, 0.4, 0.9, 1.5}) {
    const Submerged2 exact = forces::submerged(triangle, 0.3, {{0, 1}, offset});
    const Submerged2 close = forces::submerged(fine, 0, {{0, 1}, offset});
    EXPECT_NEAR(exact.area, close.area, 1e-6);
    EXPECT_NEAR(math::distance(exact.centroid, close.centroid), 0, 1e-6);
  }
}

TEST(SubmergedSpace, SphereEqualsItsMeshAndTheRevolution) {
  std::vector<Vec2d> profile;
  for (int i = 0; i <= 200; ++i) {
    const double t = math::pi * i / 200;
    profile.push_back({std::sin(t), -std::cos(t)});
  }
  const Mesh mesh = turned(profile, 200);
  for (const double offset : {-0.8, -0.2, 0.3, 0.95, 3.0}) {
    const WaterPlane water = tilted(0.4, 0.3, offset);
    const Submerged3 cap = forces::submerged_sphere({0, 0, 0}, 1, water);
    const Submerged3 faceted = forces::submerged_mesh(mesh.vertices, mesh.indices, water);
    EXPECT_NEAR(faceted.volume, cap.volume, 3e-3 * cap.volume + 2e-5);
    EXPECT_NEAR(math::distance(faceted.centroid, cap.centroid), 0, 2e-3);
  }
}

TEST(SubmergedSpace, BoxUprightAndOnItsCorner) {
  const Submerged3 upright = forces::submerged_box({1, 2, 3}, {{0, 1, 0}, 0.5});
  EXPECT_NEAR(upright.volume, 2 * 2.5 * 6, 1e-13);
  EXPECT_NEAR(upright.centroid.y, -0.75, 1e-14);
  // A cube cut at right angles to its diagonal at distance d from the corner: a pyramid with three equal edges.
  const Vec3d n = math::normalize(Vec3d{1, 1, 1});
  const double d = 0.4;  // from the lowest corner, less than 1/√3 of the edge 2
  const Submerged3 corner = forces::submerged_box({1, 1, 1}, {n, -std::sqrt(3.0) + d});
  const double edge = d * std::sqrt(3.0);
  EXPECT_NEAR(corner.volume, edge * edge * edge / 6, 1e-14);
  EXPECT_NEAR(math::distance(corner.centroid, Vec3d{-1 + edge / 4, -1 + edge / 4, -1 + edge / 4}), 0, 1e-13);
  const Submerged3 whole = forces::submerged_box({1, 1, 1}, {n, 1e6});
  EXPECT_NEAR(whole.volume, 8, 1e-13) << "depth costs no digits";
  EXPECT_EQ(forces::submerged_box({1, 1, 1}, {n, -2}).volume, 0);
}

TEST(SubmergedSpace, RevolutionsAgainstMeshesAndClosedForms) {
  const forces::Revolution cylinder{{0, -1, 0}, {0, 1, 0}, 0.5, 0.5, false};
  const forces::Revolution cone{{0, -1, 0}, {0, 1, 0}, 0.8, 0, false};
  const forces::Revolution capsule{{0, -1, 0}, {0, 1, 0}, 0.5, 0.5, true};
  const WaterPlane deep{{0, 1, 0}, 50};
  EXPECT_NEAR(forces::submerged_revolution(cylinder, deep).volume, math::pi * 0.25 * 2, 1e-9);
  EXPECT_NEAR(forces::submerged_revolution(cone, deep).volume, math::pi * 0.64 * 2 / 3, 1e-9);
  EXPECT_NEAR(forces::submerged_revolution(cone, deep).centroid.y, -0.5, 1e-9);
  EXPECT_NEAR(forces::submerged_revolution(capsule, deep).volume, math::pi * (0.25 * 2 + 4.0 / 3 * 0.125), 1e-9);
  EXPECT_NEAR(forces::submerged_revolution(cylinder, {{0, 1, 0}, 0.25}).volume, math::pi * 0.25 * 1.25, 1e-7);
  // Lying half wet: V = half, centre at 4r/(3π).
  const Submerged3 lying = forces::submerged_revolution(cylinder, {{1, 0, 0}, 0});
  EXPECT_NEAR(lying.volume, math::pi * 0.25, 1e-9);
  EXPECT_NEAR(lying.centroid.x, -4 * 0.5 / (3 * math::pi), 1e-9);

  const Mesh cylinder_mesh = turned({{0, -1}, {0.5, -1}, {0.5, 1}, {0, 1}}, 2000);
  const Mesh cone_mesh = turned({{0, -1}, {0.8, -1}, {0, 1}}, 2000);
  std::vector<Vec2d> round;
  for (int i = 0; i <= 200; ++i) {
    const double t = math::pi * i / 200;
    round.push_back({0.5 * std::sin(t), -0.5 * std::cos(t) + (i < 100 ? -1 : 1)});
    if (i == 99) round.push_back({0.5, -1});
  }
  const Mesh capsule_mesh = turned(round, 400);
  for (int i = 0; i < 40; ++i) {
    const WaterPlane water = tilted(0.16 * i, 0.3 * std::sin(i), 0.05 * (i % 25) - 0.6);
    for (const auto& [solid, mesh] :
         {std::pair{&cylinder, &cylinder_mesh}, std::pair{&cone, &cone_mesh}, std::pair{&capsule, &capsule_mesh}}) {
      const Submerged3 exact = forces::submerged_revolution(*solid, water);
      const Submerged3 faceted = forces::submerged_mesh(mesh->vertices, mesh->indices, water);
      EXPECT_NEAR(exact.volume, faceted.volume, 3e-4 * (1 + faceted.volume)) << i;
      if (faceted.volume > 0.01) {
        EXPECT_NEAR(math::distance(exact.centroid, faceted.centroid), 0, 2e-3) << i;
      }
    }
    const WaterPlane other{-water.normal, -water.offset};
    const double both =
        forces::submerged_revolution(capsule, water).volume + forces::submerged_revolution(capsule, other).volume;
    EXPECT_NEAR(both, math::pi * (0.5 + 1.0 / 6), 1e-7);
  }
}

TEST(SubmergedSpace, DepthsAtTheVerticesGiveThePlaneAgain) {
  const Mesh mesh = turned({{0, -1}, {0.5, -1}, {0.5, 1}, {0, 1}}, 12);
  std::vector<double> depths;
  const WaterPlane water = tilted(0.2, 0.1, 0.3);
  for (const Vec3d v : mesh.vertices) depths.push_back((water.offset - math::dot(water.normal, v)) / water.normal.y);
  const Submerged3 plane = forces::submerged_mesh(mesh.vertices, mesh.indices, water);
  const Submerged3 columns = forces::submerged_mesh(mesh.vertices, mesh.indices, depths, {0, 1, 0});
  EXPECT_NEAR(plane.volume, columns.volume, 1e-13) << "vertical columns and columns along the normal fill one volume";
  EXPECT_NEAR(math::distance(plane.centroid, columns.centroid), 0, 1e-13);
}

}  // namespace buoyancy_test
