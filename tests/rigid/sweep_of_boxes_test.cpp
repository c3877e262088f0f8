#include "carom/rigid/detail/box_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "carom/math/random.h"

namespace carom::rigid::detail {
namespace {
using math::Vec3d;

core::SerialScheduler serial;

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
      ASSERT_TRUE(sweep.take(serial, tree_of(boxes)));
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

TEST(BoxSweep, FindsWhatMeetsABox) {
  for (const Vec3d origin : {Vec3d{}, Vec3d{-4e6, 1e5, 3e7}}) {
    std::vector<geometry::Bounds3d> boxes = boxes_of(1500, 40, {}, 11);
    for (geometry::Bounds3d& box : boxes) box = {box.low + origin, box.high + origin};
    const geometry::DynamicTree3 tree = tree_of(boxes);
    BoxSweep sweep;
    EXPECT_FALSE(sweep.holds(tree));
    ASSERT_TRUE(sweep.take(serial, tree));
    EXPECT_TRUE(sweep.holds(tree));
    math::Random random(13);
    std::size_t met = 0;
    for (int i = 0; i < 300; ++i) {
      geometry::Bounds3d box{origin, origin};
      for (int k = 0; k < 3; ++k) {
        box.low[k] += random.uniform(-20.0, 60.0);
        box.high[k] = box.low[k] + (i % 7 == k ? 1e15 : random.uniform(0.0, 6.0));  // a wall without end, or small
      }
      std::multiset<std::uint32_t> found, by_strips;
      sweep.query(box, [&](std::uint32_t item) { found.insert(item); });
      for (int s = 0; s < sweep.strip_count(); ++s)
        sweep.query_strip(s, box, [&](std::uint32_t item) { by_strips.insert(item); });
      EXPECT_EQ(found, by_strips);
      for (std::uint32_t k = 0; k < boxes.size(); ++k) {
        const bool near = overlaps(geometry::grow(boxes[k], 0.003), box);
        EXPECT_LE(found.count(k), near ? 1u : 0u);
        if (!overlaps(boxes[k], box)) continue;
        EXPECT_EQ(found.count(k), 1u);
        ++met;
      }
    }
    EXPECT_GT(met, 200u);
  }
}

TEST(BoxSweep, LeavesCrowdsAndWideWorldsToTheTree) {
  BoxSweep sweep;
  EXPECT_FALSE(sweep.take(serial, tree_of(boxes_of(3000, 6, {}, 3)))) << "a heap";
  std::vector<geometry::Bounds3d> far = boxes_of(500, 60, {}, 5);
  far.push_back({{2e4, 0, 0}, {2e4 + 1, 1, 1}});
  EXPECT_FALSE(sweep.take(serial, tree_of(far))) << "wider than floats hold exactly";
  std::vector<geometry::Bounds3d> outlier = boxes_of(3000, 6, {}, 5);
  outlier.push_back({{7e3, 7e3, 7e3}, {7e3 + 1, 7e3 + 1, 7e3 + 1}});
  EXPECT_FALSE(sweep.take(serial, tree_of(outlier))) << "a heap and one far from it";
}

}  // namespace
}  // namespace carom::rigid::detail
