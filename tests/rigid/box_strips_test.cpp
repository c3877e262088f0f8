#include "carom/rigid/detail/box_strips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "carom/math/cpu.h"
#include "carom/math/random.h"
#include "carom/rigid/detail/kernels.h"

namespace carom::rigid::detail {
namespace {
using geometry::Bounds2d;
using math::Vec2d;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

struct MovedBox {
  Bounds2d now, old;
};
/// On the grid of fat bounds; some stood still, some came from far away.
std::vector<MovedBox> boxes_of(int count, Vec2d size, Vec2d origin) {
  math::Random random(7);
  const auto grid = [](double x) { return std::floor(x * 1024) / 1024; };
  std::vector<MovedBox> boxes;
  for (int i = 0; i < count; ++i) {
    MovedBox box;
    for (int k = 0; k < 2; ++k) {
      box.now.low[k] = origin[k] + grid(random.uniform(0.0, size[k]));
      box.now.high[k] = box.now.low[k] + grid(random.uniform(0.1, i % 50 == k ? 30.0 : 1.5));
      const double moved = i % 3 == 0 ? 0 : i % 40 == 1 ? 1e5 * (i + 1) : grid(random.uniform(-1.0, 1.0));
      box.old.low[k] = box.now.low[k] + moved, box.old.high[k] = box.now.high[k] + moved;
    }
    boxes.push_back(box);
  }
  return boxes;
}
bool take(BoxStrips& strips, const std::vector<MovedBox>& boxes, int parts = 1) {
  Bounds2d whole = boxes.front().now;
  for (const MovedBox& box : boxes) whole = merge(whole, box.now);
  if (!strips.begin(whole, parts, boxes.size())) return false;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    strips.add(int(i * std::size_t(parts) / boxes.size()), std::uint32_t(i), boxes[i].now, boxes[i].old);
  return strips.sort(*core::make_thread_pool(parts));
}

struct Meetings {
  const BoxStrips& strips;
  int strip = 0;
  Pairs found{};
  std::size_t told = 0;

  static void tell(void* whom, std::int32_t i, std::int32_t first, std::uint32_t which) {
    Meetings& m = *static_cast<Meetings*>(whom);
    for (; which != 0; which &= which - 1) {
      const std::int32_t k = first + std::countr_zero(which);
      if (!m.strips.is_of(m.strip, i, k)) continue;
      const std::uint32_t a = m.strips.item(i), b = m.strips.item(k);
      m.found.insert({std::min(a, b), std::max(a, b)});
      ++m.told;
    }
  }
};

TEST(BoxStrips, TellWhatMeetsNowAndDidNotBeforeOnceByAnyLanes) {
  for (const Vec2d origin : {Vec2d{}, Vec2d{-4e6, 3e7}})
    for (const Vec2d size : {Vec2d{60, 60}, Vec2d{20, 200}, Vec2d{400, 8}}) {
      const std::vector<MovedBox> boxes = boxes_of(1500, size, origin);
      Pairs expected;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::uint32_t k = i + 1; k < boxes.size(); ++k)
          if (overlaps(boxes[i].now, boxes[k].now) && !overlaps(boxes[i].old, boxes[k].old)) expected.insert({i, k});
      EXPECT_GT(expected.size(), 200u);
      BoxStrips strips;
      for (const auto& [width, parts] : {std::pair{4, 1}, {8, 1}, {16, 1}, {16, 3}}) {
        ASSERT_TRUE(take(strips, boxes, parts));
        const auto kernels = kernels_of<Dim2>(math::choose_instruction_set(math::instruction_set_of_width(width)));
        Meetings meetings{strips};
        for (meetings.strip = 0; meetings.strip < strips.strip_count(); ++meetings.strip)
          kernels.pairs.sweep(strips.rows(), strips.strip_begin(meetings.strip), strips.strip_end(meetings.strip),
                              Meetings::tell, &meetings);
        EXPECT_EQ(meetings.found, expected) << width;
        EXPECT_EQ(meetings.told, expected.size()) << "a pair was told twice";
      }
    }
}

TEST(BoxStrips, LeaveCrowdsAndWideWorldsToTheTree) {
  BoxStrips strips;
  EXPECT_FALSE(take(strips, boxes_of(3000, {1, 1}, {}))) << "a heap";
  std::vector<MovedBox> far = boxes_of(500, {60, 60}, {});
  far.push_back({{{2e4, 0}, {2e4 + 1, 1}}, {{2e4, 0}, {2e4 + 1, 1}}});
  EXPECT_FALSE(take(strips, far)) << "wider than floats hold exactly";
}

}  // namespace
}  // namespace carom::rigid::detail
