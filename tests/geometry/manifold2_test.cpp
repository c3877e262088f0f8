// Contact manifolds in the plane: symmetry, depth against the closest features, chains without internal edges.
#include <gtest/gtest.h>

#include "manifold_test_support.h"

namespace {
using namespace carom;
using namespace carom::geometry;
using namespace carom::geometry::testing;

Manifold2 contact2(const Shape2& a, const Shape2& b, const Transform2f& x, float margin) {
  PairCache cache;
  Manifold2 m;
  collide(a, b, x, margin, cache, m);
  return m;
}
float least2(const Manifold2& m) {
  float s = 1e30f;
  for (int i = 0; i < m.count; ++i) s = min(s, m.points[i].separation);
  return s;
}
Shape2 random_shape2(Draw& draw, int kind) {
  const auto r = [&] { return draw.in(0.3, 1); };
  switch (kind) {
    case 0:
      return Circle{r()};
    case 1:
      return Capsule2{r(), r()};
    case 2:
      return make_box2({r(), r()});
    case 3:
      return make_box2({r(), r()}, 0.2f);
    case 4: {
      std::vector<Vec2f> points;
      while (true) {
        points.clear();
        for (int i = 0; i < 6; ++i) points.push_back({draw.in(-1, 1), draw.in(-1, 1)});
        if (auto p = make_polygon(points)) return *p;
      }
    }
    default:
      return Segment{{-r(), 0}, {r(), r()}};
  }
}

TEST(Manifold2, SeparationAgreesWithTheDistanceAndMirrors) {
  Draw draw;
  int touching = 0, told = 0;
  for (int ka = 0; ka < 6; ++ka)
    for (int kb = 0; kb < 6; ++kb)
      for (int k = 0; k < 400; ++k) {
        const Shape2 a = random_shape2(draw, ka), b = random_shape2(draw, kb);
        const Vec3f d = draw.direction();
        const Transform2f x{normalize(Vec2f{d.x, d.y}) * draw.in(0.2, 2.6), draw.rotation2()};
        const Manifold2 m = contact2(a, b, x, 0.1f), r = contact2(b, a, inverse(x), 0.1f);
        const Distance2 truth = distance(a, b, x);
        ASSERT_TRUE(is_finite(m.normal));
        if (truth.distance > 0.1001f) {
          EXPECT_EQ(m.count, 0) << ka << " " << kb;
          // What it says of the way between them holds: along its normal they are as far apart as it says.
          if (m.points[0].separation > 0.1f) {
            EXPECT_LE(m.points[0].separation, truth.distance + 1e-4f) << ka << " " << kb << " " << k;
            if (m.normal != Vec2f{}) {
              const Vec2f nearest = transform_point(x, support(b, inverse_rotate(x.q, -m.normal)));
              EXPECT_NEAR(length(m.normal), 1, 1e-5f);
              EXPECT_GE(dot(m.normal, nearest - support(a, m.normal)), m.points[0].separation - 1e-4f)
                  << ka << " " << kb << " " << k;
              ++told;
            }
          }
          continue;
        }
        if (truth.distance > 0.0999f) continue;  // rounding decides
        if (truth.distance > 0) {
          // Level tiles apart by a hair are left out on purpose.
          if (ka == 2 && kb == 2 && m.count == 0) continue;
          // Round shapes well beside a sharp edge whose level they are above have no contact yet.
          const bool sharp_and_round = (ka == 2 || ka >= 4) != (kb == 2 || kb >= 4);
          if (sharp_and_round && m.count == 0) continue;
          ASSERT_GT(m.count, 0) << ka << " " << kb << " " << truth.distance << " " << k;
          EXPECT_NEAR(least2(m), truth.distance, 2e-3f) << ka << " " << kb << " " << k;
          // Round shapes over the end of a sharp edge are pushed along the edge's normal, up to 32° from the nearest
          // way.
          const bool border = (ka == 2 || ka >= 4) != (kb == 2 || kb >= 4);
          EXPECT_GT(dot(m.normal, truth.normal), border ? 0.849f : 0.99f)
              << ka << " " << kb << " " << k << " d " << truth.distance;
        } else {
          ++touching;
          if (ka == 5 && kb == 5) continue;
          ASSERT_GT(m.count, 0) << ka << " " << kb << " " << k;
          // Moving B out by the depth parts the shapes.
          Transform2f y = x;
          y.p += m.normal * (-1.03f * least2(m) + 2e-3f);
          EXPECT_GT(distance(a, b, y).distance, 0) << ka << " " << kb << " " << k << " " << least2(m);
        }
        EXPECT_NEAR(least2(m), least2(r), 3e-3f) << ka << " " << kb << " " << k;
      }
  EXPECT_GT(touching, 3000);
  EXPECT_GT(told, 4000);
}

TEST(Manifold2, BoxOnBoxHasTwoSteadyPoints) {
  const Shape2 a = make_box2({2, 0.5f}), b = make_box2({0.5f, 0.5f});
  PairCache cache;
  std::uint32_t names[2] = {};
  for (int k = 0; k < 50; ++k) {
    const float e = 1e-4f * float(k % 5 - 2);
    Manifold2 m;
    collide(a, b, {{0.2f + e, 0.999f + e}, normalize(Rot2f{1, e})}, 0.02f, cache, m);
    ASSERT_EQ(m.count, 2);
    EXPECT_NEAR(m.normal.y, 1, 1e-5);
    for (int i = 0; i < 2; ++i) {
      if (k > 0) EXPECT_EQ(m.points[i].feature, names[i]);
      names[i] = m.points[i].feature;
      EXPECT_NEAR(abs(m.points[i].point.x - 0.2f), 0.5f, 1e-3f);
      EXPECT_NEAR(m.points[i].point.y, 0.4995f, 1e-3f);
    }
  }
}

TEST(Manifold2, FlatChainIsOnePlane) {
  // Shapes slide along flush segments, a little sunk or a little above: every normal is the line's.
  const std::vector<Vec2f> points{{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}, {-1, 0}};  // free space above: to the right
  const auto chain = make_chain(points, false).value();
  const Shape2 shapes[] = {Circle{0.3f}, Capsule2{0.3f, 0.2f}, make_box2({0.25f, 0.25f}),
                           make_box2({0.2f, 0.2f}, 0.05f)};
  const float heights[] = {0.3f, 0.5f, 0.25f, 0.25f};
  for (int s = 0; s < 4; ++s)
    for (const float sink : {0.004f, 0.0f, -0.004f})
      for (int k = 0; k < 3000; ++k) {
        const float x = 0.1f + 0.001f * float(k);
        int count = 0;
        for (int i = 0; i < chain->segment_count(); ++i) {
          const Manifold2 m = contact2(Shape2(chain->segment(i)), shapes[s], {{x, heights[s] - sink}, {}}, 0.02f);
          count += m.count;
          if (m.count > 0) ASSERT_GT(m.normal.y, 0.9999f) << s << " " << x << " " << sink;
        }
        ASSERT_GT(count, 0) << s << " " << x << " " << sink;
      }
}

TEST(Manifold2, ChainCollidesOnItsFreeSideOnly) {
  const ChainSegment s{{2, 0}, {1, 0}, {-1, 0}, {-2, 0}};
  EXPECT_EQ(contact2(s, Circle{0.5f}, {{0, 0.4f}, {}}, 0).count, 1);
  EXPECT_EQ(contact2(s, Circle{0.5f}, {{0, -0.1f}, {}}, 0).count, 0);
  // In the other order the normal turns.
  const Manifold2 m = contact2(Circle{0.5f}, s, {{0, -0.4f}, {}}, 0);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.normal.y, -1, 1e-6);
  EXPECT_NEAR(m.points[0].separation, -0.1f, 1e-6f);
}

TEST(Manifold2, ChainHoldsWhatMetItsFront) {
  const ChainSegment s{{2, 0}, {1, 0}, {-1, 0}, {-2, 0}};
  const Shape2 card = make_box2({0.5f, 0.1f});
  PairCache cache;
  const auto meet = [&](float x, float height) {
    Manifold2 m;
    collide(s, card, {{x, height}, {}}, 0.01f, cache, m);
    return m;
  };
  EXPECT_EQ(meet(0, -0.05f).count, 0);  // from behind
  EXPECT_EQ(meet(0, 0.09f).count, 2);   // from the front
  const Manifold2 pressed = meet(0, -0.05f);
  ASSERT_EQ(pressed.count, 2);
  EXPECT_EQ(pressed.normal, (Vec2f{0, 1}));
  EXPECT_NEAR(least2(pressed), -0.15f, 1e-6f);
  EXPECT_EQ(meet(0.9f, -0.05f).count, 2);
  EXPECT_EQ(meet(1.1f, -0.05f).count, 0);  // over the neighbour, whose matter it is
  EXPECT_EQ(meet(0.9f, -0.05f).count, 0);  // what was let go comes from behind
  EXPECT_EQ(meet(0, 0.09f).count, 2);
  EXPECT_EQ(meet(0, -0.15f).count, 0);  // right through
}

TEST(Manifold2, ConvexChainCornerIsSharedByHalves) {
  // A roof: the circle over the ridge touches it once for each half of the corner's normals, never twice apart.
  const std::vector<Vec2f> points{{2, -2}, {0, 0}, {-2, -2}};
  const auto chain = make_chain(points, false).value();
  for (int k = -40; k <= 40; ++k) {
    const float angle = 0.015f * float(k);
    const Vec2f c = normalize(Vec2f{angle, 1}) * 0.49f;
    int touching = 0;
    for (int i = 0; i < 2; ++i) {
      const Manifold2 m = contact2(Shape2(chain->segment(i)), Circle{0.5f}, {c, {}}, 0);
      if (m.count == 0) continue;
      ++touching;
      EXPECT_GT(dot(m.normal, normalize(c)), 0.999f);
    }
    EXPECT_GE(touching, 1);
    if (k != 0) EXPECT_EQ(touching, 1) << k;
  }
}

TEST(Manifold2, FlushTilesDoNotCatchABox) {
  const Shape2 tile = make_box2({0.5f, 0.5f}), box = make_box2({0.25f, 0.25f});
  PairCache cache;
  for (int k = 0; k < 2000; ++k)
    for (const float sink : {0.002f, 0.0f, -0.002f}) {
      Manifold2 m;
      collide(tile, box, {{-1.2f + 0.001f * float(k), 0.75f - sink}, {}}, 0.02f, cache, m);
      if (m.count > 0) ASSERT_GT(m.normal.y, 0.999f) << k << " " << sink;
    }
}

TEST(Manifold2, HardCasesStayFinite) {
  Draw draw;
  for (int ka = 0; ka < 6; ++ka)
    for (int kb = 0; kb < 6; ++kb)
      for (int k = 0; k < 50; ++k) {
        const Shape2 a = random_shape2(draw, ka), b = random_shape2(draw, kb);
        Transform2f x;
        if (k % 3 == 1) x.p = {1e-8f, 0};
        if (k % 3 == 2) x.q = {0, 1};
        const Manifold2 m = contact2(a, b, x, 0.01f);
        ASSERT_TRUE(is_finite(m.normal));
        for (int i = 0; i < m.count; ++i) {
          ASSERT_TRUE(is_finite(m.points[i].point));
          ASSERT_TRUE(is_finite(m.points[i].separation));
        }
        if (ka != 5 && kb != 5) ASSERT_GT(m.count, 0) << ka << " " << kb;
      }
}
}  // namespace
