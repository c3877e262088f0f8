// Cells that boxes come to: no segment that touches a box is ever told to be clear, and most that are clear are.
#include "carom/geometry/box_cells.h"

#include <gtest/gtest.h>

#include "carom/math/random.h"

namespace geometry_box_cells_test {
using namespace carom;
using namespace carom::geometry;
using math::Vec2d;
using math::Vec2f;
using math::Vec3d;
using math::Vec3f;

template <class V>
V any(math::Random& random, double size) {
  V v{};
  for (int k = 0; k < geometry::detail::Axes<V>::count; ++k) v[k] = random.uniform(-size, size);
  return v;
}

/// By slabs, in double.
template <class V>
bool touches(const Bounds<V>& box, const V& from, const V& way) {
  double first = 0, last = 1;
  for (int k = 0; k < geometry::detail::Axes<V>::count; ++k) {
    if (way[k] == 0) {
      if (from[k] < box.low[k] || from[k] > box.high[k]) return false;
      continue;
    }
    const double a = (box.low[k] - from[k]) / way[k], b = (box.high[k] - from[k]) / way[k];
    first = math::max(first, math::min(a, b)), last = math::min(last, math::max(a, b));
  }
  return first <= last;
}

template <class V, class Way>
void ask_all(V origin, double spread, double size, double length, double most_vain) {
  math::Random random(3);
  std::vector<Bounds<V>> boxes;
  for (int i = 0; i < 200; ++i) {
    const V low = origin + any<V>(random, spread);
    boxes.push_back({low, low + geometry::detail::Axes<V>::all(size * random.uniform())});
  }
  BoxCells<V> cells;
  EXPECT_FALSE(cells.crosses(origin, Way{}));
  cells.fill(boxes, length);
  int touched = 0, vain = 0;
  constexpr int segments = 20'000;
  for (int i = 0; i < segments; ++i) {
    const V from = i % 2 == 0 ? origin + any<V>(random, 1.2 * spread)
                              : boxes[std::size_t(i) % boxes.size()].low + any<V>(random, length);
    const Way way = i % 7 == 0 ? Way{} : Way(any<V>(random, (i % 50 == 0 ? 40 : 1) * length));
    bool any_touched = false;
    for (const auto& box : boxes) any_touched = any_touched || touches(box, from, V(way));
    const bool told = cells.crosses(from, way);
    if (any_touched) EXPECT_TRUE(told) << i;
    touched += int(any_touched);
    vain += int(told && !any_touched && i % 2 == 0);
  }
  EXPECT_GT(touched, 100);
  EXPECT_LT(vain, most_vain * segments / 2);
  cells.clear();
  EXPECT_FALSE(cells.crosses(boxes[0].low, Way{}));
}

TEST(BoxCells, NoneIsMissedAndFewAreAskedInVain) {
  ask_all<Vec3d, Vec3f>({}, 50, 2, 3, .12);
  ask_all<Vec2d, Vec2f>({}, 200, 2, 3, .12);
  ask_all<Vec3d, Vec3f>({3e6, -1e7, 4}, 50, 2, 3, .12);  // far from the origin
  ask_all<Vec2d, Vec2f>({-8e6, 2e6}, 200, 2, 3, .12);
  ask_all<Vec3d, Vec3f>({}, 5e4, 2000, 3, .9);  // large space, small segments
  ask_all<Vec3d, Vec3f>({}, 50, 2, 400, 1);     // long ones
}

TEST(BoxCells, BoxesWithoutEndAndSegmentsFromAnywhere) {
  const std::vector<Bounds3d> boxes{{{-1e15, -1e15, -1e15}, {1e15, 0, 1e15}}, {{5, 5, 5}, {6, 6, 6}}};
  BoxCells<Vec3d> cells;
  cells.fill(boxes, 1);
  EXPECT_TRUE(cells.crosses(Vec3d{0, 1, 0}, Vec3f{0, -2, 0}));
  EXPECT_TRUE(cells.crosses(Vec3d{5.5, 9, 5.5}, Vec3f{0, -8, 0}));
  cells.fill(std::span(boxes).last(1), 1);
  EXPECT_TRUE(cells.crosses(Vec3d{5.5, 9, 5.5}, Vec3f{0, -8, 0}));
  for (const double far : {1e12, 1e300})
    for (const float way : {1.0f, 3e38f, -3e38f})
      for (int k = 0; k < 3; ++k) {
        Vec3d from{5.5, 5.5, 5.5};
        Vec3f along{};
        from[k] = far, along[k] = way;
        cells.crosses(from, along);  // has an answer
        from[k] = -far;
        cells.crosses(from, along);
        from[k] = 7, along[k] = -3e38f;
        EXPECT_TRUE(cells.crosses(from, along));
      }
}

}  // namespace geometry_box_cells_test
