// Voxel grids against the same cells as boxes, one by one.
#include <gtest/gtest.h>

#include "carom/geometry/manifold.h"
#include "carom/geometry/query.h"
#include "carom/geometry/voxels.h"

namespace carom::geometry {
namespace {

using namespace math;

struct Chance {
  std::uint32_t state = 88172645u;
  float operator()() {
    state ^= state << 13, state ^= state >> 17, state ^= state << 5;
    return float(state >> 8) / 8388608.0f - 1;
  }
  Vec3f vector(float size) { return Vec3f{(*this)(), (*this)(), (*this)()} * size; }
};

struct Cells {
  std::shared_ptr<const VoxelGrid> grid;
  explicit Cells(float share) {
    Chance chance;
    std::vector<std::uint8_t> cells;
    for (int i = 0; i < 12 * 9 * 10; ++i) cells.push_back(std::uint8_t(chance() < 2 * share - 1 ? 1 : 0));
    grid = make_voxel_grid(12, 9, 10, 0.5f, cells).value();
  }
  template <class Use>
  void each(Use&& use) const {
    for (int k = 0; k < 10; ++k)
      for (int j = 0; j < 9; ++j)
        for (int i = 0; i < 12; ++i)
          if (grid->at(i, j, k) != 0)
            use(Transform3f{{0.5f * float(i) + 0.25f, 0.5f * float(j) + 0.25f, 0.5f * float(k) + 0.25f}, {}});
  }
  static constexpr Box cube{{0.25f, 0.25f, 0.25f}};
};

TEST(VoxelGrid, RaysAgreeWithBoxes) {
  const Cells cells(0.15f);
  Chance chance;
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f from = Vec3f{3, 2.25f, 2.5f} + chance.vector(5), way = chance.vector(8);
    float best = 2;
    cells.each([&](const Transform3f& t) {
      const CastHit3 h = ray_cast(Cells::cube, from - t.p, way);
      if (h.hit) best = min(best, h.fraction);
    });
    const CastHit3 hit = ray_cast(cells.grid, from, way);
    ASSERT_EQ(hit.hit, best <= 1) << i;
    if (!hit.hit) continue;
    ++hits;
    EXPECT_NEAR(hit.fraction, best, 1e-5f);
    if (best > 0) {
      EXPECT_EQ(material_of_part(cells.grid, hit.child), 0);
      EXPECT_LT(dot(hit.normal, way), 0);
      EXPECT_EQ(cells.grid->cells[hit.child / 12], 1);
    }
  }
  EXPECT_GT(hits, 300);
  // Along an axis, exactly between two columns.
  EXPECT_FALSE(ray_cast(make_voxel_grid(4, 4, 4, 1).value(), {-1, 2, 2}, {9, 0, 0}).hit) << "all empty";
}

TEST(VoxelGrid, CastsAndDistancesAgreeWithBoxes) {
  const Cells cells(0.08f);
  Chance chance;
  const Shape3 shapes[] = {Sphere{0.2f}, Box{{0.1f, 0.2f, 0.15f}}, Capsule3{0.2f, 0.1f}};
  int hits = 0, near = 0;
  for (int i = 0; i < 300; ++i) {
    const Shape3& shape = shapes[i % 3];
    const Transform3f place{Vec3f{3, 2.25f, 2.5f} + chance.vector(4),
                            normalize(Quatf{chance(), chance(), chance(), chance()})};
    const Vec3f way = chance.vector(6);
    float best = 2, least = 1e9f;
    cells.each([&](const Transform3f& t) {
      const Transform3f in_cell{place.p - t.p, place.q};
      const CastHit3 h = shape_cast(Shape3(Cells::cube), shape, in_cell, way);
      if (h.hit) best = min(best, h.fraction);
      least = min(least, distance(Shape3(Cells::cube), shape, in_cell).distance);
    });
    EXPECT_NEAR(distance(Shape3(cells.grid), shape, place).distance, least, 2e-5f) << i;
    const CastHit3 hit = shape_cast(Shape3(cells.grid), shape, place, way);
    ASSERT_EQ(hit.hit, best <= 1) << i;
    if (!hit.hit) continue;
    ++hits;
    near += best > 0 ? 1 : 0;
    EXPECT_NEAR(hit.fraction * length(way), best * length(way), 1e-4f) << i;
  }
  EXPECT_GT(hits, 70);
  EXPECT_GT(near, 60);
}

TEST(VoxelGrid, ContactsAreThoseOfOneFlatBox) {
  // A plate of 8 × 1 × 8 cells is a box: the same depth and normal wherever a box stands on it.
  const Shape3 plate = make_voxel_grid(8, 1, 8, 0.5f, std::vector<std::uint8_t>(64, 1)).value();
  Chance chance;
  for (int i = 0; i < 200; ++i) {
    const float depth = 0.01f * chance();
    const Quatf turn = normalize(Quatf{chance(), 0, chance(), 0});
    const Transform3f place{{2 + chance(), 0.5f + 0.2f - depth, 2 + chance()}, turn};
    Manifold3 found[8];
    const int count = collide_many(plate, Box{{0.3f, 0.2f, 0.4f}}, place, 0.02f, found);
    ASSERT_EQ(count, 1) << "one patch for all seams";
    EXPECT_NEAR(found[0].normal.y, 1, 1e-5f);
    EXPECT_EQ(found[0].count, 4);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(found[0].points[k].separation, -depth, 1e-5f);
  }
}

}  // namespace
}  // namespace carom::geometry
