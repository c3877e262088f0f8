// Ray casts, shape casts and distances against closed forms and against each other.
#include <gtest/gtest.h>

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "manifold_test_support.h"

namespace {
using namespace carom;
using namespace carom::geometry;
using namespace carom::geometry::testing;

TEST(RayCast, ClosedForms) {
  const CastHit3 s = ray_cast(Shape3(Sphere{0.5f}), {-2, 0.3f, 0}, {4, 0, 0});
  ASSERT_TRUE(s.hit);
  EXPECT_NEAR(s.point.x, -0.4, 1e-6);  // √(0.25 − 0.09)
  EXPECT_NEAR(s.normal.x, -0.8, 1e-6);
  EXPECT_NEAR(s.normal.y, 0.6, 1e-6);
  const CastHit3 b = ray_cast(Shape3(Box{{0.5f, 1, 0.25f}}), {0.2f, 3, 0.1f}, {0, -4, 0});
  ASSERT_TRUE(b.hit);
  EXPECT_FLOAT_EQ(b.fraction, 0.5f);
  EXPECT_EQ(b.normal, (Vec3f{0, 1, 0}));
  EXPECT_FALSE(ray_cast(Shape3(Box{{0.5f, 1, 0.25f}}), {0.6f, 3, 0.1f}, {0, -4, 0}).hit);
  const CastHit3 c = ray_cast(Shape3(Cylinder{1, 0.5f}), {2, 0.5f, 0.3f}, {-4, 0, 0});
  ASSERT_TRUE(c.hit);
  EXPECT_NEAR(c.point.x, 0.4, 1e-6);
  // A rounded cylinder: its rim is a torus; 45° up the rim of radius 0.2 the normal is level and upward alike.
  const CastHit3 rim = ray_cast(Shape3(Cylinder{1, 0.5f, 0.2f}), {1.5f, 2, 0}, {-2, -2, 0});
  ASSERT_TRUE(rim.hit);
  EXPECT_NEAR(rim.point.x, 0.5 + 0.2 / math::sqrt(2.0), 1e-4);
  EXPECT_NEAR(rim.point.y, 1 + 0.2 / math::sqrt(2.0), 1e-4);
  EXPECT_NEAR(rim.normal.y, 1 / math::sqrt(2.0), 1e-3);
  // The side of a rounded one is the core's, moved out along its normal; over the apex is a ball.
  const double slant = math::sqrt(5.0);
  const CastHit3 round = ray_cast(Shape3(Cone{1, 1, 0.25f}), {2, 0, 0}, {-4, 0, 0});
  ASSERT_TRUE(round.hit);
  EXPECT_NEAR(double(round.fraction), (2 - 0.5 - 0.25 * slant / 2) / 4, 1e-5);
  EXPECT_NEAR(double(round.normal.x), 2 / slant, 1e-3);
  const CastHit3 cap = ray_cast(Shape3(Cone{1, 1, 0.25f}), {0, 4, 0}, {0, -8, 0});
  ASSERT_TRUE(cap.hit);
  EXPECT_NEAR(double(cap.fraction), (4 - 1.25) / 8, 1e-5);
  // A cone of half angle atan(1/2): at height y its radius is (h − y)/2.
  const CastHit3 k = ray_cast(Shape3(Cone{1, 1}), {2, 0, 0}, {-4, 0, 0});
  ASSERT_TRUE(k.hit);
  EXPECT_NEAR(k.point.x, 0.5, 1e-6);
  EXPECT_NEAR(k.normal.x, 2 / math::sqrt(5.0), 1e-6);
  EXPECT_NEAR(k.normal.y, 1 / math::sqrt(5.0), 1e-6);
  const CastHit3 inside = ray_cast(Shape3(Capsule3{1, 0.5f}), {0.1f, 1.2f, 0}, {5, 0, 0});
  EXPECT_TRUE(inside.hit);
  EXPECT_EQ(inside.fraction, 0);
  EXPECT_EQ(inside.normal, Vec3f{});
  // A far origin: 10 km away, a ball of 1 cm.
  const CastHit3 far = ray_cast(Shape3(Sphere{0.01f}), {-10000, 0.005f, 0}, {20000, 0, 0});
  ASSERT_TRUE(far.hit);
  EXPECT_NEAR(far.fraction * 20000 - 10000, -0.00866, 2e-3);
}

TEST(RayCast, AgreesWithACastOfAPointOnEveryConvexShape) {
  Draw draw;
  int hits = 0;
  for (int kind = 0; kind < convex_kinds; ++kind)
    for (int k = 0; k < 400; ++k) {
      const Shape3 shape = random_convex(draw, kind);
      const Vec3f from = draw.vector(1.8, 4), to = draw.vector(0, 1.2);
      const Vec3f way = (to - from) * draw.in(0.7, 2);
      const CastHit3 ray = ray_cast(shape, from, way);
      const CastHit3 slow = shape_cast(shape, Sphere{1e-6f}, {from, {}}, way);
      ASSERT_EQ(ray.hit, slow.hit) << kind_name(kind) << " " << k;
      if (!ray.hit) continue;
      ++hits;
      EXPECT_NEAR(ray.fraction * length(way), slow.fraction * length(way), 6e-3f) << kind_name(kind) << " " << k;
      EXPECT_NEAR(distance(shape, Sphere{1e-6f}, {ray.point, {}}).distance, 0, 2e-5f);
      EXPECT_LT(dot(ray.normal, way), 0);
    }
  EXPECT_GT(hits, 1000);
}

TEST(RayCast, MeshAndHeightFieldAgreeWithALoopOverTriangles) {
  Draw draw;
  const int n = 24;
  std::vector<float> heights;
  for (int i = 0; i < n * n; ++i) heights.push_back(draw.in(0, 1.5));
  const auto field = make_height_field(n, n, {0.5f, 0.7f}, heights).value();
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) vertices.push_back({0.5f * float(i), heights[std::size_t(j * n + i)], 0.7f * float(j)});
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const auto at = [&](int u, int v) { return std::uint32_t((j + v) * n + i + u); };
      for (const std::uint32_t k : {at(0, 0), at(1, 1), at(1, 0), at(0, 0), at(0, 1), at(1, 1)}) indices.push_back(k);
    }
  const auto mesh = make_triangle_mesh(vertices, indices).value();
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3f from{draw.in(-3, 15), draw.in(1.6, 5), draw.in(-3, 19)};
    const Vec3f to{draw.in(-3, 15), draw.in(-3, 1), draw.in(-3, 19)};
    const Vec3f way =
        k % 10 == 0 ? Vec3f{0, to.y - from.y, 0} : (k % 10 == 1 ? Vec3f{to.x - from.x, to.y - from.y, 0} : to - from);
    const CastHit3 m = ray_cast(Shape3(mesh), from, way), h = ray_cast(Shape3(field), from, way);
    ASSERT_EQ(m.hit, h.hit) << k;
    if (!m.hit) continue;
    ++hits;
    EXPECT_NEAR(m.fraction, h.fraction, 1e-5f);
    EXPECT_GT(m.normal.y, 0);
    EXPECT_GT(dot(m.normal, h.normal), 0.999f);
    // On the surface there, by the triangle that holds the point.
    const Distance3 d = distance(Shape3(field), Sphere{0.01f}, {m.point + m.normal * 0.05f, {}});
    EXPECT_LT(d.distance, 0.0401f);
  }
  EXPECT_GT(hits, 1000);
  // One-sided: from below there is nothing on the mesh; the ground is solid.
  EXPECT_FALSE(ray_cast(Shape3(mesh), {5, -3, 5}, {0, 10, 0}).hit);
  EXPECT_TRUE(ray_cast(Shape3(field), {5, -3, 5}, {0, 10, 0}).hit);
}

TEST(Distance3, ClosedForms) {
  EXPECT_NEAR(distance(Sphere{0.5f}, Sphere{0.25f}, {{3, 4, 0}, {}}).distance, 4.25, 1e-6);
  EXPECT_NEAR(distance(Box{{1, 1, 1}}, Box{{1, 1, 1}}, {{3, 4, 5}, {}}).distance, math::sqrt(1.0 + 4 + 9), 1e-5);
  EXPECT_NEAR(distance(Capsule3{1, 0.2f}, Capsule3{1, 0.3f}, {{0, 0, 2}, normalize(Quatf{1, 0, 0, 1})}).distance, 1.5,
              1e-6);
  EXPECT_NEAR(distance(Cylinder{1, 0.5f}, Sphere{0.1f}, {{1.5f, 2, 0}, {}}).distance, math::sqrt(2.0) - 0.1, 1e-5);
  EXPECT_NEAR(distance(Plane{{0, 1, 0}}, Cone{1, 0.5f}, {{0, 3, 0}, {}}).distance, 2, 1e-6);
  const Distance3 d = distance(Box{{1, 1, 1}}, Sphere{0.5f}, {{0.3f, 3, 0.2f}, {}});
  EXPECT_NEAR(d.point_a.y, 1, 1e-6);
  EXPECT_NEAR(d.point_b.y, 2.5, 1e-6);
  EXPECT_NEAR(d.normal.y, 1, 1e-6);
  EXPECT_EQ(distance(Box{{1, 1, 1}}, Sphere{0.5f}, {{0, 1.2f, 0}, {}}).distance, 0);
}

TEST(Distance3, NoSampleIsNearerAndTheWitnessesAreThatFarApart) {
  Draw draw;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (int k = 0; k < 10; ++k) {
        const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
        const Transform3f x{draw.vector(2, 4), draw.rotation()};
        const Distance3 d = distance(a, b, x);
        if (d.distance <= 0) continue;
        EXPECT_NEAR(length(d.point_b - d.point_a), d.distance, 1e-4f);
        // The plane across the witnesses parts the shapes: no point of either is on the wrong side.
        EXPECT_LE(dot(support(a, d.normal) - d.point_a, d.normal), 1e-4f);
        EXPECT_GE(dot(transform_point(x, support(b, inverse_rotate(x.q, -d.normal))) - d.point_b, d.normal), -1e-4f);
        EXPECT_FALSE(overlap(a, b, x));
        EXPECT_NEAR(distance(b, a, inverse(x)).distance, d.distance, 1e-4f);
      }
}

TEST(Distance3, SurfacesAgreeWithALoopOverTheirTriangles) {
  Draw draw;
  const int n = 12;
  std::vector<float> heights;
  for (int i = 0; i < n * n; ++i) heights.push_back(draw.in(0, 1));
  const auto field = make_height_field(n, n, {1, 1}, heights).value();
  for (int k = 0; k < 100; ++k) {
    const Vec3f p{draw.in(-4, 15), draw.in(1.5, 6), draw.in(-4, 15)};
    const float found = distance(Shape3(field), Sphere{0.1f}, {p, {}}).distance;
    float least = 1e30f;
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i)
        for (int t = 0; t < 2; ++t) {
          const auto v = [&](int u, int w) {
            return Vec3f{float(i + u), heights[std::size_t((j + w) * n + i + u)], float(j + w)};
          };
          const Vec3f a = v(0, 0), b = t == 0 ? v(1, 1) : v(0, 1), c = t == 0 ? v(1, 0) : v(1, 1);
          for (int s = 0; s <= 12; ++s)
            for (int r = 0; r + s <= 12; ++r) {
              const Vec3f q = a + (b - a) * (float(s) / 12) + (c - a) * (float(r) / 12);
              least = min(least, math::distance(p, q) - 0.1f);
            }
        }
    EXPECT_LE(found, least + 1e-4f);
    EXPECT_GT(found, least - 0.12f);
  }
}

TEST(ShapeCast, SphereAgainstBoxAndPlane) {
  const CastHit3 h = shape_cast(Box{{1, 1, 1}}, Sphere{0.5f}, {{5, 0.2f, 0.3f}, {}}, {-10, 0, 0});
  ASSERT_TRUE(h.hit);
  EXPECT_NEAR(h.fraction, 0.35, 1e-5);
  EXPECT_NEAR(h.normal.x, 1, 1e-5);
  EXPECT_NEAR(h.point.x, 1, 1e-4);
  EXPECT_FALSE(shape_cast(Box{{1, 1, 1}}, Sphere{0.5f}, {{5, 1.6f, 0}, {}}, {-10, 0, 0}).hit);
  const CastHit3 p = shape_cast(Plane{}, Box{{0.5f, 0.5f, 0.5f}}, {{0, 2, 0}, {}}, {1, -3, 0});
  ASSERT_TRUE(p.hit);
  EXPECT_NEAR(p.fraction, 0.5, 1e-6);
  EXPECT_EQ(shape_cast(Box{{1, 1, 1}}, Sphere{0.5f}, {{1.2f, 0, 0}, {}}, {-10, 0, 0}).fraction, 0);
}

TEST(ShapeCast, EndsTouchingWhateverTheShapes) {
  Draw draw;
  int hits = 0;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (int k = 0; k < 20; ++k) {
        const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
        Transform3f x{draw.vector(3, 6), draw.rotation()};
        const Vec3f goal = draw.direction() * 0.8f;
        const Vec3f way = (goal - x.p) * draw.in(0.5, 1.5);
        const CastHit3 h = shape_cast(a, b, x, way);
        const Vec3f from = x.p;
        x.p = from + way * h.fraction;
        const float d = distance(a, b, x).distance;
        if (h.hit) {
          ++hits;
          EXPECT_LT(d, 1e-3f) << kind_name(ka) << " " << kind_name(kb);
          EXPECT_LT(dot(h.normal, way), 1e-3f);
        } else {
          EXPECT_GT(d, 0) << kind_name(ka) << " " << kind_name(kb);
        }
        // Nothing was passed on the way.
        for (int s = 0; s < 20; ++s) {
          x.p = from + way * (h.fraction * float(s) / 20);
          EXPECT_FALSE(overlap(a, b, x)) << kind_name(ka) << " " << kind_name(kb);
        }
      }
  EXPECT_GT(hits, 300);
}

TEST(ShapeCast, OnATriangleFromTheFrontEndsTouchingIt) {
  Draw draw;
  int hits = 0, misses = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3f a = draw.direction(), b = draw.direction(), c = draw.direction();
    const Vec3f normal = cross(b - a, c - a);
    if (length(normal) < 0.1f) continue;
    const Shape3 mesh(make_triangle_mesh({a, b, c}, {0, 1, 2}).value());
    const Shape3 moving = k % 4 == 0   ? Shape3(Sphere{draw.in(0.1, 0.6)})
                          : k % 4 == 1 ? Shape3(Capsule3{draw.in(0.1, 0.8), draw.in(0.1, 0.5)})
                          : k % 4 == 2 ? Shape3(Box{{draw.in(0.1, 0.6), draw.in(0.1, 0.6), draw.in(0.1, 0.6)}})
                                       : Shape3(Cylinder{draw.in(0.1, 0.6), draw.in(0.1, 0.6), k % 8 == 3 ? 0.1f : 0});
    Transform3f x{draw.vector(1.5, 6), draw.rotation()};
    const Vec3f way = (draw.vector(0, 1.3) - x.p) * draw.in(0.4, 2);
    if (dot(normal, x.p - a) <= 0 || dot(normal, way) >= 0) {
      EXPECT_FALSE(shape_cast(mesh, moving, x, way).hit);
      continue;
    }
    const bool begins_in_touch = overlap(mesh, moving, x);
    const CastHit3 h = shape_cast(mesh, moving, x, way);
    const Vec3f from = x.p;
    x.p = from + way * h.fraction;
    const float d = distance(mesh, moving, x).distance;
    if (begins_in_touch) {
      EXPECT_TRUE(h.hit);
      EXPECT_EQ(h.fraction, 0);
    } else if (h.hit) {
      ++hits;
      EXPECT_LT(d, 1e-3f) << k;
      EXPECT_NEAR(length(h.normal), 1, 1e-5f);
      // Drawn back along the normal it is that far away: the normal is that of the touch.
      x.p = x.p + h.normal * 0.01f;
      EXPECT_NEAR(distance(mesh, moving, x).distance, 0.01f, 1e-3f) << k;
      EXPECT_LT(distance(mesh, Sphere{1e-5f}, {h.point, {}}).distance, 2e-3f) << k;
    } else {
      ++misses;
      EXPECT_GT(d, 0) << k;
    }
    for (int s = 0; s < 20 && h.fraction > 0; ++s) {
      x.p = from + way * (h.fraction * float(s) / 20);
      ASSERT_FALSE(overlap(mesh, moving, x)) << k << " " << s;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 200);
}

TEST(Overlap3, AgreesWithTheDistance) {
  Draw draw;
  int touching = 0;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (int k = 0; k < 60; ++k) {
        const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
        const Transform3f x{draw.vector(0, 2.5), draw.rotation()};
        const float d = distance(a, b, x).distance;
        if (d > 0 && d < 1e-5f) continue;  // too near to tell
        touching += d <= 0;
        EXPECT_EQ(overlap(a, b, x), d <= 0) << kind_name(ka) << " " << kind_name(kb) << " " << d;
      }
  EXPECT_GT(touching, 200);
}

TEST(ShapeCast, OnMeshFieldAndCompound) {
  const auto mesh = make_triangle_mesh({{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}}, {0, 2, 1, 0, 3, 2}).value();
  const auto field = make_height_field(11, 11, {1, 1}, std::vector<float>(121)).value();
  const Box box{{0.5f, 0.5f, 0.5f}};
  for (const Shape3& ground : {Shape3(mesh), Shape3(field)}) {
    const CastHit3 h = shape_cast(ground, box, {{1.3f, 3, 1.2f}, {}}, {2, -5, 1});
    ASSERT_TRUE(h.hit);
    EXPECT_NEAR(h.fraction, 0.5, 1e-4);
    EXPECT_NEAR(h.normal.y, 1, 1e-4);
  }
  EXPECT_FALSE(shape_cast(Shape3(mesh), box, {{0, -3, 0}, {}}, {0, 6, 0}).hit);
  const auto compound = make_compound({{Sphere{0.5f}, {{0, 0, 0}, {}}}, {Sphere{0.5f}, {{3, 0, 0}, {}}}}).value();
  const CastHit3 c = shape_cast(Shape3(compound), Sphere{0.5f}, {{3, 5, 0}, {}}, {0, -10, 0});
  ASSERT_TRUE(c.hit);
  EXPECT_EQ(c.child, 1u);
  EXPECT_NEAR(c.fraction, 0.4, 1e-5);
  EXPECT_EQ(ray_cast(Shape3(compound), {3, 5, 0}, {0, -10, 0}).child, 1u);
}

TEST(Query2, ClosedFormsOfThePlane) {
  const Shape2 box = make_box2({1, 1});
  EXPECT_NEAR(distance(box, Circle{0.5f}, {{4, 5}, {}}).distance, 4.5, 1e-6);
  EXPECT_NEAR(distance(box, make_box2({1, 1}), {{4, 5}, {}}).distance, math::sqrt(4.0 + 9), 1e-5);
  EXPECT_TRUE(overlap(box, Circle{0.5f}, {{1.4f, 0}, {}}));
  EXPECT_FALSE(overlap(box, Circle{0.5f}, {{1.6f, 0}, {}}));
  const CastHit2 r = ray_cast(box, {-3, 0.2f}, {4, 0});
  ASSERT_TRUE(r.hit);
  EXPECT_NEAR(r.fraction, 0.5, 1e-6);
  EXPECT_NEAR(r.normal.x, -1, 1e-6);
  EXPECT_EQ(ray_cast(box, {0, 0}, {4, 0}).fraction, 0);
  const CastHit2 c = ray_cast(Shape2(Capsule2{1, 0.5f}), {-3, 0.2f}, {5, 0});
  ASSERT_TRUE(c.hit);
  EXPECT_NEAR(c.fraction, 0.5, 1e-6);
  const CastHit2 s = shape_cast(box, Circle{0.5f}, {{5, 0}, {}}, {-7, 0});
  ASSERT_TRUE(s.hit);
  EXPECT_NEAR(s.fraction, 0.5, 1e-5);
  const auto chain = make_chain({{3, 0}, {1, 0}, {-1, 0}}, false).value();
  EXPECT_TRUE(ray_cast(Shape2(chain), {0, 2}, {0, -3}).hit);
  EXPECT_FALSE(ray_cast(Shape2(chain), {0, -2}, {0, 3}).hit);  // from the solid side
  EXPECT_EQ(ray_cast(Shape2(chain), {2, 2}, {0, -3}).child, 0u);
  EXPECT_NEAR(shape_cast(Shape2(chain), Circle{0.5f}, {{0, 2}, {}}, {0, -3}).fraction, 0.5, 1e-4);
}

TEST(Query2, ShapeCastEndsTouching) {
  Draw draw;
  const Shape2 shapes[] = {Circle{0.4f}, Capsule2{0.5f, 0.2f}, make_box2({0.5f, 0.3f}), make_box2({0.3f, 0.6f}, 0.1f),
                           Segment{{-0.5f, 0}, {0.5f, 0.2f}}};
  for (const Shape2& a : shapes)
    for (const Shape2& b : shapes)
      for (int k = 0; k < 60; ++k) {
        const Vec3f u = draw.direction(), v = draw.direction();
        Transform2f x{normalize(Vec2f{u.x, u.y}) * 3.0f, draw.rotation2()};
        const Vec2f from = x.p, way = (Vec2f{v.x, v.y} * 0.6f - x.p) * 1.5f;
        const CastHit2 h = shape_cast(a, b, x, way);
        x.p = from + way * h.fraction;
        if (h.hit) EXPECT_LT(distance(a, b, x).distance, 1e-3f);
        for (int s = 0; s < 20; ++s) {
          x.p = from + way * (h.fraction * 0.999f * float(s) / 20);
          EXPECT_FALSE(overlap(a, b, x));
        }
      }
}
}  // namespace
