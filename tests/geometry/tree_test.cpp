// Bounding-volume trees against brute force: every answer of a tree is the answer of a loop over all boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/dynamic_tree.h"
#include "carom/geometry/tree_walk.h"

namespace {
using namespace carom;
using namespace carom::geometry;

// A small generator of its own, so that the cases are the same everywhere.
struct Draw {
  std::uint64_t state = 88172645463325252ull;
  double unit() {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return double(state >> 11) * 0x1p-53;
  }
  double in(double a, double b) { return a + (b - a) * unit(); }
  Bounds3d box(double world, double size) {
    const Vec3d c{in(-world, world), in(-world, world), in(-world, world)};
    const Vec3d h{in(0, size), in(0, size), in(0, size)};
    return {c - h, c + h};
  }
};

std::vector<std::uint32_t> found(const DynamicTree3& tree, const Bounds3d& box) {
  std::vector<std::uint32_t> out;
  tree.query(box, [&](std::uint32_t item) { return out.push_back(item), true; });
  std::sort(out.begin(), out.end());
  return out;
}

TEST(DynamicTree, AnswersAsALoopDoesThroughRandomHistory) {
  Draw draw;
  DynamicTree3 tree;
  struct Entry {
    int leaf;
    Bounds3d box;
    std::uint32_t item;
  };
  std::vector<Entry> entries;
  std::uint32_t next = 0;
  for (int step = 0; step < 4000; ++step) {
    const double what = draw.unit();
    if (what < 0.4 || entries.empty()) {
      const Bounds3d box = draw.box(50, 2);
      const int leaf = tree.insert(box, next);
      entries.push_back({leaf, box, next++});
    } else if (what < 0.55) {
      const std::size_t i = std::size_t(draw.unit() * double(entries.size()));
      tree.remove(entries[i].leaf);
      entries[i] = entries.back();
      entries.pop_back();
    } else if (what < 0.8) {
      Entry& e = entries[std::size_t(draw.unit() * double(entries.size()))];
      e.box = draw.box(50, 2);
      tree.update(e.leaf, e.box);
    } else {
      Entry& e = entries[std::size_t(draw.unit() * double(entries.size()))];
      e.box = merge(e.box, draw.box(50, 1));
      if (draw.unit() < 0.5) e.box = draw.box(50, 2);
      tree.enlarge(e.leaf, e.box);
    }
    if (step % 500 == 250) tree.rebuild();
    if (step % 333 == 100) tree.rebuild_enlarged();
    if (step % 20 == 0) {
      ASSERT_TRUE(tree.valid()) << step;
      const Bounds3d box = draw.box(50, 10);
      std::vector<std::uint32_t> expected;
      for (const Entry& e : entries)
        if (overlaps(e.box, box)) expected.push_back(e.item);
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(found(tree, box), expected) << step;
    }
  }
  ASSERT_EQ(tree.size(), int(entries.size()));
  for (const Entry& e : entries) {
    EXPECT_EQ(tree.item(e.leaf), e.item);
    EXPECT_EQ(tree.bounds(e.leaf), e.box);
  }
}

TEST(DynamicTree, SelfPairsAndCrossPairsAreComplete) {
  Draw draw;
  DynamicTree3 a, b;
  std::vector<Bounds3d> boxes_a, boxes_b;
  for (std::uint32_t i = 0; i < 400; ++i) {
    boxes_a.push_back(draw.box(20, 2));
    a.insert(boxes_a.back(), i);
    boxes_b.push_back(draw.box(20, 2));
    b.insert(boxes_b.back(), i);
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> self, cross, expected_self, expected_cross;
  a.self_pairs(
      [&](std::uint32_t i, std::uint32_t j) { EXPECT_TRUE(self.insert({math::min(i, j), math::max(i, j)}).second); });
  a.pairs(b, [&](std::uint32_t i, std::uint32_t j) { EXPECT_TRUE(cross.insert({i, j}).second); });
  for (std::uint32_t i = 0; i < 400; ++i)
    for (std::uint32_t j = 0; j < 400; ++j) {
      if (i < j && overlaps(boxes_a[i], boxes_a[j])) expected_self.insert({i, j});
      if (overlaps(boxes_a[i], boxes_b[j])) expected_cross.insert({i, j});
    }
  EXPECT_EQ(self, expected_self);
  EXPECT_EQ(cross, expected_cross);
  EXPECT_GT(expected_self.size(), 50u);
}

TEST(DynamicTree, CastFindsEveryBoxOnTheWay) {
  Draw draw;
  DynamicTree3 tree;
  std::vector<Bounds3d> boxes;
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < 1000; ++i) boxes.push_back(draw.box(50, 1.5)), items.push_back(i);
  tree.insert_all(boxes, items, nullptr);
  ASSERT_TRUE(tree.valid());
  for (int k = 0; k < 500; ++k) {
    const Vec3d from{draw.in(-60, 60), draw.in(-60, 60), draw.in(-60, 60)};
    Vec3d to{draw.in(-60, 60), draw.in(-60, 60), draw.in(-60, 60)};
    if (k % 5 == 0) to.x = from.x;
    if (k % 10 == 0) to.y = from.y;
    const Vec3d extents = k % 2 == 0 ? Vec3d{} : Vec3d{0.5, 1, 0.25};
    std::set<std::uint32_t> seen;
    tree.cast(from, to - from, extents, [&](std::uint32_t i, double limit) { return seen.insert(i), limit; });
    // The segment against a box, by clipping its parameter interval with each slab.
    for (std::uint32_t i = 0; i < 1000; ++i) {
      double enter = 0, leave = 1;
      bool hit = true;
      for (int axis = 0; axis < 3; ++axis) {
        const double d = to[axis] - from[axis];
        const double low = boxes[i].low[axis] - extents[axis], high = boxes[i].high[axis] + extents[axis];
        if (d == 0) {
          hit = hit && from[axis] >= low && from[axis] <= high;
        } else {
          const double t0 = (low - from[axis]) / d, t1 = (high - from[axis]) / d;
          enter = math::max(enter, math::min(t0, t1)), leave = math::min(leave, math::max(t0, t1));
        }
      }
      hit = hit && enter <= leave;
      ASSERT_EQ(seen.count(i) == 1, hit) << k << " " << i;
    }
  }
}

TEST(DynamicTree, ClippedCastStopsAtTheNearest) {
  DynamicTree2 tree;
  for (std::uint32_t i = 0; i < 100; ++i) tree.insert({{i + 0.0, -1.0}, {i + 0.5, 1.0}}, i);
  int visits = 0;
  tree.cast({-1, 0}, {200, 0}, {}, [&](std::uint32_t item, double) {
    ++visits;
    return (item + 1.0) / 200;
  });
  EXPECT_LE(visits, 3);
}

TEST(DynamicTree, KeepsLargeWorldsAndInfiniteBoxesApart) {
  DynamicTree3 tree;
  const double far = 1e9;
  for (std::uint32_t i = 0; i < 64; ++i) tree.insert({{far + i, far, far}, {far + i + 0.999, far + 1, far + 1}}, i);
  const double infinity = std::numeric_limits<double>::infinity();
  tree.insert({{-infinity, -infinity, -infinity}, {infinity, 0, infinity}}, 99);
  EXPECT_TRUE(tree.valid());
  EXPECT_EQ(found(tree, {{far + 10.1, far, far}, {far + 10.2, far + 1, far + 1}}), std::vector<std::uint32_t>{10});
  EXPECT_EQ(found(tree, {{5, -1, 5}, {6, 1, 6}}), std::vector<std::uint32_t>{99});
}

TEST(DynamicTree, BulkBuildIsNoWorseThanInsertion) {
  Draw draw;
  DynamicTree3 bulk, one_by_one;
  std::vector<Bounds3d> boxes;
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < 5000; ++i) boxes.push_back(draw.box(100, 1)), items.push_back(i);
  std::vector<int> leaves(boxes.size());
  bulk.insert_all(boxes, items, leaves.data());
  for (std::uint32_t i = 0; i < 5000; ++i) one_by_one.insert(boxes[i], i);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(bulk.item(leaves[i]), i);
  EXPECT_LT(bulk.cost(), 1.1 * one_by_one.cost());
  EXPECT_LT(bulk.height(), 40);
  EXPECT_LT(one_by_one.height(), 60);
}

TEST(DynamicTree, SortedInsertionStaysShallow) {
  DynamicTree3 tree;
  for (std::uint32_t i = 0; i < 4096; ++i) tree.insert({{double(i), 0, 0}, {i + 0.9, 1, 1}}, i);
  EXPECT_TRUE(tree.valid());
  EXPECT_LT(tree.height(), 48);
}

TEST(StaticTree, AnswersAsALoopDoesAndStaysShallow) {
  Draw draw;
  for (const int count : {1, 2, 5, 700}) {
    std::vector<Bounds3f> boxes;
    for (int i = 0; i < count; ++i) {
      const Bounds3d b = draw.box(20, 2);
      boxes.push_back({Vec3f(b.low), Vec3f(b.high)});
    }
    const StaticTree tree = build_static_tree(boxes);
    for (int k = 0; k < 100; ++k) {
      const Bounds3d q = draw.box(20, 5);
      const Bounds3f box{Vec3f(q.low), Vec3f(q.high)};
      std::set<std::uint32_t> seen;
      query(tree, box, [&](std::uint32_t i) { return seen.insert(i), true; });
      for (int i = 0; i < count; ++i) {
        if (overlaps(boxes[std::size_t(i)], box)) {
          ASSERT_EQ(seen.count(std::uint32_t(i)), 1u);
        }
      }
    }
  }
  // Boxes that halve in size: a split by surface alone would peel one off a level.
  std::vector<Bounds3f> nested;
  float x = 1;
  for (int i = 0; i < 120; ++i, x *= 0.8f) nested.push_back({{x * 0.9f, 0, 0}, {x, x, x}});
  for (int i = 0; i < 5000; ++i) nested.push_back({{0, 0, 0}, {1e-20f, 1e-20f, 1e-20f}});
  const StaticTree tree = build_static_tree(nested, 1);
  std::size_t visited = 0;
  query(tree, {{-1, -1, -1}, {2, 2, 2}}, [&](std::uint32_t) { return ++visited, true; });
  EXPECT_EQ(visited, nested.size());
}
TEST(DynamicTree, RefitAfterAllMoved) {
  Draw draw;
  DynamicTree3 tree;
  std::vector<Bounds3d> boxes;
  std::vector<int> leaves;
  for (std::uint32_t i = 0; i < 500; ++i) {
    boxes.push_back(draw.box(50, 2));
    leaves.push_back(tree.insert(boxes.back(), i));
  }
  int rebuilt = 0;
  for (int step = 0; step < 60; ++step) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3d d{draw.in(-1, 1), draw.in(-1, 1), draw.in(-1, 1)};
      boxes[i] = {boxes[i].low + d, boxes[i].high + d};
      tree.set_bounds(leaves[i], boxes[i]);
    }
    rebuilt += tree.refit() ? 1 : 0;
    ASSERT_TRUE(tree.valid());
    for (int k = 0; k < 20; ++k) {
      const Bounds3d box = draw.box(50, 5);
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (overlaps(boxes[i], box)) expected.push_back(i);
      ASSERT_EQ(found(tree, box), expected);
    }
  }
  EXPECT_GT(rebuilt, 0);
  EXPECT_LT(rebuilt, 30);
}

TEST(ChainTree, VisitsWhatALoopVisits) {
  Draw draw;
  for (const int count : {2, 3, 4, 5, 17, 360}) {
    for (const bool loop : {false, true}) {
      if (loop && count < 3) continue;
      std::vector<Vec2f> points;
      for (int i = 0; i < count; ++i) points.push_back({float(i), float(draw.in(-3, 3))});
      const auto chain = make_chain(points, loop).value();
      for (int k = 0; k < 50; ++k) {
        const Vec2f c{float(draw.in(-1, count)), float(draw.in(-4, 4))}, h{float(draw.in(0, 3)), float(draw.in(0, 3))};
        const Bounds2f box{c - h, c + h};
        std::vector<int> expected, visited;
        for (int i = 0; i < chain->segment_count(); ++i)
          if (overlaps(geometry::detail::segment_bounds(*chain, i), box)) expected.push_back(i);
        geometry::detail::visit_segments(*chain, box, [&](int i) { return visited.push_back(i), true; });
        ASSERT_EQ(visited, expected);
      }
    }
  }
}

}  // namespace
