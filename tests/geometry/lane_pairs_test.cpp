// Pairs of the plane in lanes: to the bit what collide() finds for each of them.
#include "carom/geometry/detail/lane_pairs.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "carom/math/cpu.h"
#include "carom/math/elementary.h"
#include "manifold_test_support.h"

namespace carom::geometry::lane_pairs_test {
using detail::lane_kind;
using detail::LaneKind;
using detail::LanePairs;
using geometry::testing::Draw;

Shape2 random_quad(Draw& draw, int k) {
  const float radius = k % 3 == 0 ? 0.1f : 0.0f;
  if (k % 2 == 0) {
    const Transform2f local = k % 4 == 0 ? Transform2f{} : Transform2f{{0.3f, -0.2f}, Rot2f(0.8f, 0.6f)};
    return make_box2({draw.in(0.3, 0.8), draw.in(0.3, 0.8)}, radius, local);
  }
  for (;;) {
    std::vector<Vec2f> points(std::size_t(k % 4 == 1 ? 3 : 4));
    for (Vec2f& p : points) p = {draw.in(-0.8, 0.8), draw.in(-0.8, 0.8)};
    if (const auto polygon = make_polygon(points, radius); polygon) return polygon.value();
  }
}
Shape2 random_polygon(Draw& draw, int k) {
  for (;;) {
    std::vector<Vec2f> points(std::size_t(5 + k % 4));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float angle = (float(i) + draw.in(0, 0.7)) * 6.2f / float(points.size()), size = draw.in(0.5, 0.8);
      points[i] = {size * math::cos(angle), size * math::sin(angle)};
    }
    if (const auto polygon = make_polygon(points, k % 3 == 0 ? 0.1f : 0.0f); polygon && polygon.value().count > 4)
      return polygon.value();
  }
}
Shape2 random_round(Draw& draw, LaneKind kind) {
  if (kind == LaneKind::quad_circle) return Circle{draw.in(0.2, 0.6)};
  return Capsule2{draw.in(0.2, 0.7), draw.in(0.1, 0.4)};
}
/// Every third pair stands square, level with each other, as in stacks and rows.
Transform2f random_place(Draw& draw, int k) {
  const Vec2f p{draw.in(-1.6, 1.6), draw.in(-1.6, 1.6)};
  const float angle = draw.in(-3.1, 3.1), eighths = float(int(draw.in(0, 8)));
  if (k % 3 != 0) return {p, Rot2f(math::cos(angle), math::sin(angle))};
  const Rot2f quarters[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return {{k % 2 == 0 ? 0.0f : 0.1f * eighths, p.y}, quarters[k / 3 % 4]};
}

bool same_bits(const Manifold2& a, const Manifold2& b) {
  if (std::memcmp(&a.normal, &b.normal, sizeof a.normal) != 0 || a.count != b.count) return false;
  if (a.count == 0) return std::memcmp(&a.points[0].separation, &b.points[0].separation, sizeof(float)) == 0;
  return std::memcmp(a.points, b.points, std::size_t(a.count) * sizeof(ManifoldPoint2)) == 0;
}

void agrees(LaneKind kind, int lanes, int most_left) {
  Draw draw;
  const detail::CollideLanes collide_lanes = detail::lane_colliders(lanes).of[int(kind)];
  int touching = 0, corners = 0, apart = 0, left = 0;
  for (int round = 0; round < 2000; ++round) {
    LanePairs pairs;
    const int count = 1 + round % LanePairs::capacity;
    std::vector<Shape2> shapes(2 * LanePairs::capacity);
    PairCache caches[LanePairs::capacity];
    for (int i = 0; i < count; ++i) {
      const int k = round * LanePairs::capacity + i;
      Shape2 &a = shapes[std::size_t(2 * i)], &b = shapes[std::size_t(2 * i + 1)];
      a = kind == LaneKind::capsules   ? random_round(draw, kind)
          : kind == LaneKind::polygons ? random_polygon(draw, k)
                                       : random_quad(draw, k);
      if (kind == LaneKind::polygons && k % 2 == 0)
        b = random_polygon(draw, k / 5);
      else
        b = kind == LaneKind::quads || kind == LaneKind::polygons ? random_quad(draw, k / 5) : random_round(draw, kind);
      if (k / 7 % 2 == 0) std::swap(a, b);
      pairs.a[i] = &a, pairs.b[i] = &b;
      ASSERT_EQ(lane_kind(*pairs.a[i], *pairs.b[i]), kind);
      const Transform2f x = random_place(draw, k);
      std::memcpy(pairs.b_in_a[i], &x, sizeof x);
      pairs.margin[i] = k % 5 == 0 ? 0.5f : 0.02f;
      caches[i].kind = std::uint8_t(k / 3 % 3), caches[i].a = std::uint8_t(k / 9 % 9);
      pairs.kind[i] = caches[i].kind, pairs.edge[i] = caches[i].a;
    }
    const std::uint32_t alone = collide_lanes(pairs, count);
    for (int i = 0; i < count; ++i) {
      Manifold2 m;
      Transform2f x;
      std::memcpy(&x, pairs.b_in_a[i], sizeof x);
      collide(*pairs.a[i], *pairs.b[i], x, pairs.margin[i], caches[i], m);
      (m.count == 0 ? apart : m.count == 1 ? corners : touching) += 1;
      if ((alone >> i & 1u) != 0) {
        ++left;
        continue;
      }
      ASSERT_TRUE(same_bits(m, pairs.found[i].manifold)) << round << ", " << i;
      EXPECT_EQ(pairs.kind[i], caches[i].kind) << round << ", " << i;
      EXPECT_EQ(pairs.edge[i], caches[i].a) << round << ", " << i;
    }
    EXPECT_EQ(alone >> count, 0u);
  }
  EXPECT_GT(apart, 2000);
  EXPECT_GT(corners, 1000);
  if (kind != LaneKind::quad_circle) EXPECT_GT(touching, 1000);
  EXPECT_LE(left, most_left);
}

class InLanes : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (math::simd_width(math::detect_instruction_set()) < GetParam()) GTEST_SKIP() << "not on this machine";
  }
};
TEST_P(InLanes, PolygonsOfFourCorners) { agrees(LaneKind::quads, GetParam(), 3000); }
TEST_P(InLanes, PolygonsOfEightCorners) { agrees(LaneKind::polygons, GetParam(), 3000); }
TEST_P(InLanes, PolygonsAndCapsules) { agrees(LaneKind::quad_capsule, GetParam(), 0); }
TEST_P(InLanes, PolygonsAndCircles) { agrees(LaneKind::quad_circle, GetParam(), 0); }
TEST_P(InLanes, Capsules) { agrees(LaneKind::capsules, GetParam(), 2000); }  // those in line overlap
INSTANTIATE_TEST_SUITE_P(Widths, InLanes, ::testing::Values(4, 8));

TEST(LanePairs, KindsOfShapes) {
  const Shape2 box = make_box2({1, 1}), circle = Circle{1}, capsule = Capsule2{1, 1}, point = Capsule2{0, 1};
  EXPECT_EQ(lane_kind(box, box), LaneKind::quads);
  Draw draw;
  const Shape2 polygon = random_polygon(draw, 0);
  EXPECT_EQ(lane_kind(polygon, box), LaneKind::polygons);
  EXPECT_EQ(lane_kind(box, polygon), LaneKind::polygons);
  EXPECT_EQ(lane_kind(polygon, polygon), LaneKind::polygons);
  EXPECT_EQ(lane_kind(polygon, circle), LaneKind::none);
  EXPECT_EQ(lane_kind(circle, box), LaneKind::quad_circle);
  EXPECT_EQ(lane_kind(box, capsule), LaneKind::quad_capsule);
  EXPECT_EQ(lane_kind(box, point), LaneKind::none);
  EXPECT_EQ(lane_kind(capsule, capsule), LaneKind::capsules);
  EXPECT_EQ(lane_kind(capsule, point), LaneKind::none);
  EXPECT_EQ(lane_kind(circle, capsule), LaneKind::none);
  EXPECT_EQ(lane_kind(box, Shape2(Segment{{0, 0}, {1, 0}})), LaneKind::none);
}

}  // namespace carom::geometry::lane_pairs_test
