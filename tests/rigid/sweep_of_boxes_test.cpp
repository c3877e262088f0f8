#include "carom/rigid/detail/box_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "carom/math/random.h"

namespace carom::rigid::detail {
namespace {
using math::Vec3d;

/// Boxes of fast bodies: long, few of them side by side, on the grid of fat bounds.
std::vector<geometry::Bounds3d> boxes_of(int count, double size, Vec3d origin, std::uint64_t seed) {
  math::Random random(seed);
  const auto grid = [](double x) { return std::floor(x * 1024) / 1024; };
  std::vector<geometry::Bounds3d> boxes;
  for (int i = 0; i < count; ++i) {
    Vec3d low, high;
    for (int k = 0; k < 3; ++k) {
      low[k] = grid(origin[k] + random.uniform(0.0, size));
      high[k] = low[k] + grid(random.uniform(0.1, k == i % 3 ? 5.0 : 1.5));
    }
    boxes.push_back({low, high});
  }
  return boxes;
}
geometry::DynamicTree3 tree_of(const std::vector<geometry::Bounds3d>& boxes) {
  geometry::DynamicTree3 tree;
  for (std::size_t i = 0; i < boxes.size(); ++i) tree.insert(boxes[i], std::uint32_t(i));
  return tree;
}

TEST(BoxSweep, FindsWhatComparingAllWithAllFinds) {
  for (const Vec3d origin : {Vec3d{}, Vec3d{-4e6, 1e5, 3e7}})
    for (const Vec3d stretch : {Vec3d{1, 1, 1}, Vec3d{0.3, 1, 2}}) {
      std::vector<geometry::Bounds3d> boxes = boxes_of(1500, 40, {}, 7);
      for (geometry::Bounds3d& box : boxes)
        for (int k = 0; k < 3; ++k) {
          const double low = std::floor(box.low[k] * stretch[k] * 1024) / 1024, size = box.high[k] - box.low[k];
          box.low[k] = origin[k] + low, box.high[k] = box.low[k] + size;
        }
      boxes.push_back(boxes.front());  // twice the same
      std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t k = i + 1; k < boxes.size(); ++k)
          if (overlaps(boxes[i], boxes[k])) expected.insert({i, k});
      BoxSweep sweep;
      ASSERT_TRUE(sweep.take(tree_of(boxes)));
      std::size_t visits = 0;
      for (int s = 0; s < sweep.strip_count(); ++s)
        sweep.visit_strip(s, [&](std::uint32_t a, std::uint32_t b) {
          found.insert({std::min(a, b), std::max(a, b)});
          ++visits;
        });
      EXPECT_EQ(found, expected);
      EXPECT_EQ(visits, found.size()) << "a pair was told twice";
      EXPECT_GT(found.size(), 200u);
    }
}

TEST(BoxSweep, LeavesCrowdsAndWideWorldsToTheTree) {
  BoxSweep sweep;
  EXPECT_FALSE(sweep.take(tree_of(boxes_of(3000, 6, {}, 3)))) << "a heap";
  std::vector<geometry::Bounds3d> far = boxes_of(500, 60, {}, 5);
  far.push_back({{2e4, 0, 0}, {2e4 + 1, 1, 1}});
  EXPECT_FALSE(sweep.take(tree_of(far))) << "wider than floats hold exactly";
  std::vector<geometry::Bounds3d> outlier = boxes_of(3000, 6, {}, 5);
  outlier.push_back({{7e3, 7e3, 7e3}, {7e3 + 1, 7e3 + 1, 7e3 + 1}});
  EXPECT_FALSE(sweep.take(tree_of(outlier))) << "a heap and one far from it";
}

}  // namespace
}  // namespace carom::rigid::detail
