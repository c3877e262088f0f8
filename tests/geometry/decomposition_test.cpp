// Convex decomposition against bodies whose parts and volumes are known.
#include <gtest/gtest.h>

#include <limits>

#include "carom/geometry/decomposition.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"

namespace {
using namespace carom;
using namespace carom::geometry;

double total_volume(const std::vector<std::shared_ptr<const Hull>>& parts) {
  double sum = 0;
  for (const auto& p : parts) sum += double(p->volume);
  return sum;
}
bool inside_any(const std::vector<std::shared_ptr<const Hull>>& parts, Vec3f p) {
  for (const auto& hull : parts) {
    bool inside = true;
    for (const HullPlane& plane : hull->planes) inside = inside && dot(plane.normal, p) <= plane.offset;
    if (inside) return true;
  }
  return false;
}

/// A prism along z from 0 to 1 over the L (0,0) (2,0) (2,1) (1,1) (1,2) (0,2): volume 3 m³.
Triangles l_prism() {
  constexpr float outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  Triangles t;
  for (const float z : {0.0f, 1.0f})
    for (const auto& p : outline) t.positions.push_back({p[0], p[1], z});
  for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u, 0u, 3u, 4u, 0u, 4u, 5u}) t.indices.push_back(6 + k);
  for (const std::uint32_t k : {0u, 2u, 1u, 0u, 3u, 2u, 0u, 4u, 3u, 0u, 5u, 4u}) t.indices.push_back(k);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    for (const std::uint32_t k : {i, j, 6 + j, i, 6 + j, 6 + i}) t.indices.push_back(k);
  }
  return t;
}

TEST(Decomposition, AnLIsTwoBoxes) {
  const Triangles t = l_prism();
  const auto parts = decompose_convex(t.positions, t.indices).value();
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(total_volume(parts), 3, 1e-3);
  for (const auto& p : parts) EXPECT_EQ(p->vertices.size(), 8u);
  EXPECT_FALSE(inside_any(parts, {1.5f, 1.5f, 0.5f}));
}

TEST(Decomposition, AConvexMeshStaysWhole) {
  const Triangles t = make_box_mesh({0.5f, 0.25f, 1});
  const auto parts = decompose_convex(t.positions, t.indices).value();
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_NEAR(total_volume(parts), 1, 1e-3);
}

TEST(Decomposition, ATorusKeepsItsHoleAndVolume) {
  const Triangles t = make_torus_mesh(1, 0.3f, 48, 24);
  DecompositionOptions options;
  options.concavity = 0.005f;
  const auto parts = decompose_convex(t.positions, t.indices, options).value();
  EXPECT_LE(parts.size(), 16u);
  EXPECT_GT(parts.size(), 3u);
  // 16 hulls about round matter, of cells of a twelfth of its radius: they hold all of it and a quarter of air.
  constexpr double volume = 2 * pi * pi * 0.09;
  EXPECT_GT(total_volume(parts), volume);
  EXPECT_LT(total_volume(parts), 1.25 * volume);
  for (int i = 0; i < 24; ++i) {
    const float c = float(math::cos(i * pi / 12)), s = float(math::sin(i * pi / 12));
    EXPECT_TRUE(inside_any(parts, {c, s, 0})) << i;
    EXPECT_FALSE(inside_any(parts, {0.5f * c, 0.5f * s, 0})) << i;
  }
}

TEST(Decomposition, RefusesWhatHasNoInside) {
  Triangles open = make_box_mesh({1, 1, 1});
  open.indices.resize(open.indices.size() - 3);
  EXPECT_NE(decompose_convex(open.positions, open.indices).error().message.find("open"), std::string::npos);
  const Triangles box = make_box_mesh({1, 1, 1});
  DecompositionOptions options;
  options.resolution = 2;
  EXPECT_NE(decompose_convex(box.positions, box.indices, options).error().message.find("resolution"),
            std::string::npos);
  std::vector<std::uint32_t> wrong = box.indices;
  wrong[4] = 99;
  EXPECT_NE(decompose_convex(box.positions, wrong).error().message.find("99"), std::string::npos);
  std::vector<Vec3f> broken = box.positions;
  broken[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(decompose_convex(broken, box.indices).ok());
  EXPECT_FALSE(decompose_convex(box.positions, {}).ok());
}
}  // namespace
