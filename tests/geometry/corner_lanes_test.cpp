// Searches among the corners of hulls, by every instruction set of this machine: what one by one gives, to the bit.
#include "carom/geometry/detail/corner_lanes.h"

#include <gtest/gtest.h>

#include <vector>

#include "carom/math/cpu.h"
#include "carom/math/random.h"
#include "carom/math/vec.h"

namespace corner_lanes_test {
using namespace carom;
using math::Vec3f;

TEST(CornerLanes, FindWhatOneByOneFinds) {
  std::vector<const geometry::detail::CornerKernels*> all = {&geometry::detail::corner_lanes_baseline::kernels,
                                                             &geometry::detail::corner_kernels()};
  math::Random random(5);
  for (int round = 0; round < 400; ++round) {
    const int blocks = 1 + round % 127, count = 4 * blocks;
    std::vector<Vec3f> points;
    std::vector<float> lanes(std::size_t(12 * blocks));
    for (int i = 0; i < count; ++i) {
      // From a coarse grid, so that many lie equally far; the last ones once more, as a hull's rest of four does.
      const auto place = [&] { return float(random.integer(-3, 3)); };
      points.push_back(i > 0 && i >= count - 2 ? points.back() : Vec3f{place(), place(), place()});
      for (int k = 0; k < 3; ++k) lanes[std::size_t(12 * (i / 4) + 4 * k + i % 4)] = points.back()[k];
    }
    const auto number = [&] {
      return round % 2 == 0 ? float(random.uniform(-1.0, 1.0)) : float(random.integer(-2, 2));
    };
    float rows[3][3];
    for (auto& row : rows)
      for (float& x : row) x = number();
    int first = 0;
    float low[3], high[3];
    const auto along = [](const float(&row)[3], Vec3f p) { return p.x * row[0] + p.y * row[1] + p.z * row[2]; };
    for (int k = 0; k < 3; ++k) {
      low[k] = 1e30f, high[k] = -1e30f;
      for (const Vec3f& p : points)
        low[k] = math::min(low[k], along(rows[k], p)), high[k] = math::max(high[k], along(rows[k], p));
    }
    for (int i = 1; i < count; ++i)
      if (along(rows[0], points[std::size_t(i)]) > along(rows[0], points[std::size_t(first)])) first = i;
    for (const auto* kernels : all) {
      EXPECT_EQ(kernels->farthest(lanes.data(), blocks, rows[0][0], rows[0][1], rows[0][2]), first);
      float least[3], most[3];
      kernels->extremes(lanes.data(), blocks, rows, least, most);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(least[k], low[k]);
        EXPECT_EQ(most[k], high[k]);
      }
    }
  }
}

}  // namespace corner_lanes_test
