// Time of impact: the touch is found, nothing tunnels, and what stays apart is not stopped.
#include <gtest/gtest.h>

#include "carom/geometry/detail/swept3.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "manifold_test_support.h"

namespace {
using namespace carom;
using namespace carom::geometry;
using namespace carom::geometry::testing;

Quatf turned(Quatf q, Vec3f axis, float angle) {
  // Exact enough for a test: the tangent half-angle form.
  const float t = angle / 4, c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
  return normalize(Quatf{c, axis * s} * q);
}
Transform3f at(const Sweep3& s, float t) {
  const Quatf q1 = dot(s.q0, s.q1) < 0 ? -s.q1 : s.q1;
  const Quatf q = normalize(s.q0 + (q1 - s.q0) * t);
  return {s.c0 + (s.c1 - s.c0) * t - rotate(q, s.local_center), q};
}
Sweep3 still(Vec3f p = {}) { return {{}, p, p, {}, {}}; }

TEST(TimeOfImpact3, SphereAgainstWallInClosedForm) {
  const Sweep3 s{{}, {-5, 0, 0}, {5, 0, 0}, {}, {}};
  const TimeOfImpact t = time_of_impact(Sphere{0.5f}, s, Box{{0.1f, 2, 2}}, still());
  EXPECT_EQ(t.state, ImpactState::hit);
  EXPECT_NEAR(t.time, (5 - 0.6 - 0.0025) / 10, 2e-4);
  EXPECT_EQ(time_of_impact(Sphere{0.5f}, {{}, {-5, 3, 0}, {5, 3, 0}, {}, {}}, Box{{0.1f, 2, 2}}, still()).state,
            ImpactState::separated);
  EXPECT_EQ(time_of_impact(Sphere{0.5f}, {{}, {0.4f, 0, 0}, {5, 0, 0}, {}, {}}, Box{{0.1f, 2, 2}}, still()).state,
            ImpactState::overlapped);
}

// 10 000 rods, boxes, hulls and balls at 400 m/s, turning at up to 50 rad/s, for one step of 1/60 s against walls 0.1 m
// thick: each is stopped before it, touching, or truly misses.
TEST(TimeOfImpact3, NothingTunnelsThroughThinWalls) {
  Draw draw;
  const Shape3 wall = Box{{0.05f, 3, 3}};
  const float dt = 1.0f / 60;
  int hits = 0, misses = 0;
  for (int k = 0; k < 10000; ++k) {
    Shape3 shape;
    switch (k % 5) {
      case 0:
        shape = Sphere{draw.in(0.01, 0.1)};
        break;
      case 1:
        shape = Capsule3{draw.in(0.1, 0.5), draw.in(0.01, 0.05)};
        break;
      case 2:
        shape = Box{{draw.in(0.01, 0.5), draw.in(0.01, 0.05), draw.in(0.01, 0.05)}};
        break;
      case 3:
        shape = Cylinder{draw.in(0.1, 0.5), draw.in(0.01, 0.05)};
        break;
      default:
        shape = Cone{draw.in(0.1, 0.3), draw.in(0.01, 0.1)};
    }
    const Vec3f from{draw.in(-4, -0.7), draw.in(-2, 2), draw.in(-2, 2)};
    const Vec3f velocity = normalize(Vec3f{1, draw.in(-0.4, 0.4), draw.in(-0.4, 0.4)}) * 400.0f;
    const Quatf q0 = draw.rotation();
    const Vec3f axis = draw.direction();
    const Quatf q1 = turned(q0, axis, draw.in(0, 50) * dt);
    const Sweep3 sweep{{0, draw.in(-0.05, 0.05), 0}, from, from + velocity * dt, q0, q1};
    const TimeOfImpact t = time_of_impact(shape, sweep, wall, still());
    ASSERT_NE(t.state, ImpactState::failed);
    if (t.state == ImpactState::overlapped) continue;
    if (t.state == ImpactState::hit) {
      ++hits;
      ASSERT_LT(at(sweep, t.time).p.x, 0.6f) << k;  // on the near side still
      ASSERT_LT(distance(wall, shape, at(sweep, t.time)).distance, 0.0045f) << k;
    } else {
      ++misses;
    }
    for (int i = 0; i <= 40; ++i)
      ASSERT_FALSE(overlap(wall, shape, at(sweep, t.time * float(i) / 40))) << k << " " << i;
  }
  EXPECT_GT(hits, 7000);
  EXPECT_GT(misses, 5);
}

// Two boxes that turn by up to 1.5 rad on their ways: as long as a direction is said to keep them apart, it does.
TEST(TimeOfImpact3, ADirectionKeepsApartAsLongAsSaid) {
  Draw draw;
  int cut = 0, whole = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto sweep = [&](Vec3f from, Vec3f way) {
      Sweep3 s{{draw.in(-0.5, 0.5), draw.in(-0.5, 0.5), 0}, from, from + way, draw.rotation(), {}};
      const Vec3f axis = draw.direction();
      s.q1 = turned(s.q0, axis, draw.in(0, 1.5));
      return s;
    };
    const geometry::detail::Convex a = geometry::detail::convex_of(Box{{draw.in(0.1, 1), draw.in(0.1, 1), 0.2f}}),
                                   b = geometry::detail::convex_of(Box{{draw.in(0.1, 1), 0.3f, draw.in(0.1, 1)}});
    const Vec3f apart = draw.vector(2, 4), way = draw.vector(0, 2);
    const geometry::detail::Motion3 way_a(sweep({}, way)), way_b(sweep(apart, -apart * 0.6f));
    const geometry::detail::Swept<Vec3d> swept_a = geometry::detail::swept(a, way_a),
                                         swept_b = geometry::detail::swept(b, way_b);
    const double target = 0.01;
    geometry::detail::CoreGap gap{
        a,     b,      way_a,
        way_b, target, geometry::detail::bend_of(way_a, swept_a) + geometry::detail::bend_of(way_b, swept_b)};
    Vec3d n;
    const double distance = gap(0, n);
    if (distance <= target) continue;
    const double until = gap.clear_until(0, n, distance, target, 1);
    ++(until < 1 ? cut : whole);
    for (int i = 0; i <= 20; ++i) {
      const double t = until * i / 20;
      const geometry::detail::Placed at_a(a, way_a.at(t)), at_b(b, way_b.at(t));
      const double now = dot(n, at_b.support(-n) - at_a.support(n)) - gap.radii();
      ASSERT_GE(now, target - 1e-9) << k << " at " << t << " of " << until;
    }
  }
  EXPECT_GT(cut, 300);
  EXPECT_GT(whole, 300);
}

TEST(TimeOfImpact3, TwoMovingRodsMeet) {
  Draw draw;
  int hits = 0;
  for (int k = 0; k < 1000; ++k) {
    const Capsule3 a{0.4f, 0.02f}, b{0.3f, 0.03f};
    const auto sweep = [&](float side) {
      const Vec3f from{side * draw.in(1, 2), draw.in(-0.3, 0.3), draw.in(-0.3, 0.3)};
      const Quatf q = draw.rotation();
      const Vec3f way{-side * 3.5f, draw.in(-0.2, 0.2), draw.in(-0.2, 0.2)}, axis = draw.direction();
      return Sweep3{{}, from, from + way, q, turned(q, axis, draw.in(0, 0.83))};
    };
    const Sweep3 sa = sweep(-1), sb = sweep(1);
    const TimeOfImpact t = time_of_impact(a, sa, b, sb);
    hits += t.state == ImpactState::hit;
    for (int i = 0; i <= 60; ++i) {
      const float u = t.time * float(i) / 60;
      ASSERT_FALSE(overlap(a, b, inverse(at(sa, u)) * at(sb, u))) << k << " " << i;
    }
    if (t.state == ImpactState::hit)
      ASSERT_LT(distance(a, b, inverse(at(sa, t.time)) * at(sb, t.time)).distance, 0.0045f);
  }
  EXPECT_GT(hits, 200);
}

TEST(TimeOfImpact3, MeshesFieldsAndPlanesStopBullets) {
  Draw draw;
  const auto mesh =
      make_triangle_mesh({{-20, 0, -20}, {20, 0, -20}, {20, 0, 20}, {-20, 0, 20}}, {0, 2, 1, 0, 3, 2}).value();
  std::vector<float> heights(41 * 41);
  for (float& h : heights) h = draw.in(-0.3, 0);
  const auto field = make_height_field(41, 41, {1, 1}, heights).value();
  for (int k = 0; k < 1000; ++k) {
    const Shape3 shape = k % 2 == 0 ? Shape3(Sphere{0.02f}) : Shape3(Box{{0.3f, 0.02f, 0.02f}});
    const Vec3f from{draw.in(-10, 10), draw.in(0.5, 4), draw.in(-10, 10)};
    const Vec3f to{draw.in(-10, 10), draw.in(-4, -0.7), draw.in(-10, 10)};
    const Quatf q = draw.rotation();
    const Sweep3 sweep{{}, from, to, q, turned(q, draw.direction(), 0.8f)};
    for (const Shape3& ground : {Shape3(mesh), Shape3(Plane{})}) {
      const TimeOfImpact t = time_of_impact(shape, sweep, ground, still());
      ASSERT_EQ(t.state, ImpactState::hit) << k;
      ASSERT_LT(distance(ground, shape, at(sweep, t.time)).distance, 0.0045f);
    }
    const Sweep3 ground{{}, {-20, 0, -20}, {-20, 0, -20}, {}, {}};
    const TimeOfImpact t = time_of_impact(shape, sweep, Shape3(field), ground);
    ASSERT_EQ(t.state, ImpactState::hit) << k;
    const Transform3f x = at(sweep, t.time);
    ASSERT_LT(distance(Shape3(field), shape, {x.p + Vec3f{20, 0, 20}, x.q}).distance, 0.0045f) << k;
    // From behind, a one-sided mesh lets it pass.
    EXPECT_EQ(time_of_impact(shape, {{}, to, from, q, q}, Shape3(mesh), still()).state, ImpactState::separated);
  }
}

TEST(TimeOfImpact2, NothingTunnelsThroughThinWallsOrChains) {
  Draw draw;
  const Shape2 wall = make_box2({0.05f, 3});
  const auto chain = make_chain({{0, -3}, {0, 0}, {0, 3}}, false).value();  // free space to the right of travel: +x
  const auto pose = [](const Sweep2& s, float t) {
    const Rot2f q = normalize(Rot2f{s.q0.c + t * (s.q1.c - s.q0.c), s.q0.s + t * (s.q1.s - s.q0.s)});
    return Transform2f{s.c0 + (s.c1 - s.c0) * t - rotate(q, s.local_center), q};
  };
  int hits = 0;
  for (int k = 0; k < 10000; ++k) {
    const Shape2 shape = k % 3 == 0 ? Shape2(Circle{draw.in(0.01, 0.1)})
                                    : (k % 3 == 1 ? Shape2(make_box2({draw.in(0.01, 0.5), draw.in(0.01, 0.05)}))
                                                  : Shape2(Capsule2{draw.in(0.1, 0.5), 0.02f}));
    const Rot2f q0 = draw.rotation2();
    const Rot2f q1 = normalize(q0 * Rot2f{1, draw.in(-0.9, 0.9)});
    const Vec2f from{draw.in(0.7, 4), draw.in(-1.5, 1.5)};
    const Sweep2 sweep{{}, from, from + Vec2f{-400.0f / 60, draw.in(-1, 1)}, q0, q1};
    const TimeOfImpact t = time_of_impact(shape, sweep, wall, Sweep2{});
    ASSERT_TRUE(t.state == ImpactState::hit || t.state == ImpactState::overlapped) << k;
    if (t.state == ImpactState::overlapped) continue;
    ++hits;
    ASSERT_LT(distance(wall, shape, pose(sweep, t.time)).distance, 0.0045f) << k;
    for (int i = 0; i <= 20; ++i) ASSERT_FALSE(overlap(wall, shape, pose(sweep, t.time * float(i) / 20)));
    const TimeOfImpact c = time_of_impact(shape, sweep, Shape2(chain), Sweep2{});
    ASSERT_EQ(c.state, ImpactState::hit) << k;
    ASSERT_GT(pose(sweep, c.time).p.x, -0.01f);
  }
  EXPECT_GT(hits, 9000);
}
}  // namespace
