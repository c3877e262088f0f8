// Contact manifolds in space against laws that hold for any pair of convex shapes: symmetry, invariance, and that
// pushing the shapes apart by the depth along the normal leaves them touching.
#include <gtest/gtest.h>

#include "carom/geometry/detail/gjk.h"
#include "carom/math/rotation.h"
#include "manifold_test_support.h"

namespace {
using namespace carom;
using namespace carom::geometry;
using namespace carom::geometry::testing;

Manifold3 contact(const Shape3& a, const Shape3& b, const Transform3f& x, float margin) {
  PairCache cache;
  Manifold3 m;
  collide(a, b, x, margin, cache, m);
  return m;
}
float least(const Manifold3& m) {
  float s = 1e30f;
  for (int i = 0; i < m.count; ++i) s = min(s, m.points[i].separation);
  return s;
}
// Distance by GJK, negative depth by EPA, radii included: another way to the same numbers.
double reference(const Shape3& a, const Shape3& b, const Transform3f& x) {
  const geometry::detail::Convex ca = geometry::detail::convex_of(a), cb = geometry::detail::convex_of(b);
  geometry::detail::CoreDistance d;
  const geometry::detail::Placed pa(ca), pb(cb, x);
  geometry::detail::core_distance(pa, pb, 1e9, {}, d);
  if (d.overlap) EXPECT_TRUE(geometry::detail::core_depth(pa, pb, d));
  return d.distance - double(ca.radius) - double(cb.radius);
}
bool finite(const Manifold3& m) {
  bool ok = is_finite(m.normal);
  for (int i = 0; i < m.count; ++i) ok = ok && is_finite(m.points[i].point) && is_finite(m.points[i].separation);
  return ok;
}

TEST(Manifold3, DepthAgreesWithTheReferenceAndMirrors) {
  Draw draw;
  int touching = 0, apart = 0;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (int k = 0; k < 60; ++k) {
        const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
        const Transform3f x{draw.vector(0.8, 2.5), draw.rotation()};
        const double truth = reference(a, b, x);
        const Manifold3 m = contact(a, b, x, 0.1f), r = contact(b, a, inverse(x), 0.1f);
        ASSERT_TRUE(finite(m)) << kind_name(ka) << " " << kind_name(kb) << " " << k;
        if (truth > 0.1001) {
          EXPECT_EQ(m.count, 0) << kind_name(ka) << " " << kind_name(kb) << " " << truth;
          continue;
        }
        if (truth > 0) {
          ++apart;
          // Sharp boxes that are apart at a corner may be left out; what is reported is never nearer than the truth by
          // more than the slant of a face's normal allows.
          // So may round shapes well beside a sharp face whose level they are above.
          const auto sharp = [](int kind) { return kind >= 2 && kind <= 5; };
          const auto round = [](int kind) { return kind != 2 && kind != 5; };
          if (m.count == 0 && ((ka == 2 && kb == 2) || (sharp(ka) && round(kb)) || (sharp(kb) && round(ka)))) continue;
        } else {
          ++touching;
        }
        ASSERT_GT(m.count, 0) << kind_name(ka) << " " << kind_name(kb) << " " << truth << " " << k;
        EXPECT_NEAR(length(m.normal), 1, 1e-4);
        // A face's normal is preferred to an edge's that parts the shapes at 5 % less depth.
        const double s = double(least(m)), slack = 0.06 * math::abs(truth) + 2e-3;
        EXPECT_LT(s, truth + slack) << kind_name(ka) << " " << kind_name(kb) << " " << truth << " " << k;
        EXPECT_GT(s, truth - (truth > 0 ? 0.03 : slack))
            << kind_name(ka) << " " << kind_name(kb) << " " << truth << " " << k;
        if (r.count == 0 || truth < -0.2) continue;  // deep: there may be two ways out of nearly the same length
        EXPECT_NEAR(least(m), least(r), slack) << kind_name(ka) << " " << kind_name(kb) << " " << truth;
      }
  EXPECT_GT(touching, 500);
  EXPECT_GT(apart, 100);
}

// Crossed by a hair either way, they lie along each other, and what carries the load stays where it is.
TEST(Manifold3, CapsulesThatTurnPastParallelTouchInTheSamePlace) {
  const Capsule3 capsule{0.3f, 0.3f};
  Vec3f before{};
  for (int i = -400; i <= 400; ++i) {
    const float turn = 1e-3f * float(i), tilt = 2e-3f * math::sin(0.05f * float(i));
    const Transform3f x{{0.599f, 0.1f, 0.002f},
                        math::from_axis_angle(Vec3f{1, 0, 0}, turn) * math::from_axis_angle(Vec3f{0, 0, 1}, tilt)};
    const Manifold3 m = contact(capsule, capsule, x, 0.02f);
    ASSERT_GT(m.count, 0) << turn;
    EXPECT_NEAR(double(least(m)), reference(capsule, capsule, x), 7e-4) << turn;
    Vec3f middle{};
    for (int k = 0; k < m.count; ++k) middle += m.points[k].point / float(m.count);
    if (i > -400) EXPECT_LT(length(middle - before), 0.02f) << turn;
    before = middle;
  }
}

// The face that held the contact before does not hide how near the edge has come.
TEST(Manifold3, ACapsuleThatLeansOverAnEdgeIsAsDeepAsItIs) {
  const Capsule3 capsule{0.3f, 0.3f};
  const Box box{{0.4f, 0.4f, 0.4f}};
  for (const float beyond : {0.05f, 0.15f, 0.25f}) {
    PairCache cache;
    for (int i = 0; i <= 300; ++i) {
      const float tilt = 1e-3f * float(i), along = 0.3f - beyond;  // from its middle to the edge
      const Vec3f axis{math::cos(tilt), -math::sin(tilt), 0}, over{math::sin(tilt), math::cos(tilt), 0};
      const Vec3f middle = Vec3f{0.4f, 0.4f, 0} + over * 0.2999f - axis * along;
      const Transform3f x{middle, math::from_axis_angle(Vec3f{0, 0, 1}, -0.5f * float(math::pi) - tilt)};
      Manifold3 m;
      collide(box, capsule, x, 0.02f, cache, m);
      ASSERT_GT(m.count, 0) << tilt;
      EXPECT_NEAR(double(least(m)), reference(box, capsule, x), 3e-4) << beyond << " " << tilt;
    }
  }
}

// The axis of the capsule lies in the box; the way out across it and an edge is 10 % shorter than out by a face.
TEST(Manifold3, ACapsuleDeepInARoundedBoxLeavesByTheShorterWay) {
  const Capsule3 capsule{0.580056489f, 0.970398307f};
  const Box box{{0.683759511f, 0.982914686f, 0.771261513f}, 0.2f};
  const Transform3f x{{-0.40512982f, 1.14727855f, -0.652188599f},
                      normalize(Quatf{-0.402345091f, 0.275888145f, -0.815039098f, -0.312594801f})};
  const double truth = reference(capsule, box, x);
  EXPECT_NEAR(truth, -1.2749, 1e-4);
  EXPECT_NEAR(least(contact(capsule, box, x, 0.1f)), truth, 1e-3);
  EXPECT_NEAR(least(contact(box, capsule, inverse(x), 0.1f)), truth, 1e-3);
}

TEST(Manifold3, PushingOutByTheDepthSeparates) {
  Draw draw;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (int k = 0; k < 40; ++k) {
        const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
        Transform3f x{draw.vector(0.1, 1.2), draw.rotation()};
        const Manifold3 m = contact(a, b, x, 0);
        if (m.count == 0) continue;
        const float depth = -least(m);
        x.p += m.normal * (depth * 1.001f + 2e-3f);
        // A face is preferred to a way out that is up to 5 % shorter.
        EXPECT_GT(reference(a, b, x), -1e-3 - 0.05 * double(depth))
            << kind_name(ka) << " " << kind_name(kb) << " depth " << depth;
      }
}

TEST(Manifold3, WhatIsToldOfTheDistanceIsNeverMoreThanIt) {
  Draw draw;
  int told = 0;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb) {
      const Shape3 a = random_convex(draw, ka), b = random_convex(draw, kb);
      PairCache cache;
      Transform3f x{draw.vector(1.5, 4), draw.rotation()};
      for (int k = 0; k < 30; ++k) {  // a slow motion, so that the cache is used
        x.p += draw.vector(0.01, 0.1);
        x.q = normalize(Quatf{1, draw.vector(0.01, 0.05)} * x.q);
        Manifold3 m;
        collide(a, b, x, 0.02f, cache, m);
        if (m.count > 0 || m.points[0].separation <= 0.02f) continue;
        ++told;
        ASSERT_LE(double(m.points[0].separation), reference(a, b, x) + 1e-4) << kind_name(ka) << " " << kind_name(kb);
      }
    }
  EXPECT_GT(told, 500);
}

TEST(Manifold3, DoesNotChangeWithTheFrame) {
  // Turning both shapes together (boxes are symmetric under quarter turns) turns the manifold.
  Draw draw;
  for (int k = 0; k < 300; ++k) {
    const Box a{{0.5f, 0.5f, 0.5f}}, b{{draw.in(0.2, 1), draw.in(0.2, 1), draw.in(0.2, 1)}};
    const Transform3f x{draw.vector(0.5, 1.5), draw.rotation()};
    const Quatf quarter = normalize(Quatf{1, 0, 1, 0});
    const Transform3f y{rotate(quarter, x.p), normalize(quarter * x.q)};
    const Manifold3 m = contact(a, b, x, 0.02f), r = contact(a, b, y, 0.02f);
    ASSERT_EQ(m.count > 0, r.count > 0);
    if (m.count > 0) EXPECT_NEAR(least(m), least(r), 1e-4f);
  }
}

TEST(Manifold3, BoxesRestOnFourPointsWithSteadyNames) {
  const Box a{{2, 0.5f, 2}}, b{{0.5f, 0.5f, 0.5f}};
  PairCache cache;
  std::uint32_t names[4] = {};
  for (int k = 0; k < 50; ++k) {
    const float e = 1e-4f * float(k % 7);
    const Transform3f x{{0.3f + e, 0.999f + e, -e}, normalize(Quatf{1, e, 0.15f, -e})};
    Manifold3 m;
    collide(a, b, x, 0.02f, cache, m);
    ASSERT_EQ(m.count, 4);
    EXPECT_NEAR(m.normal.y, 1, 1e-5);
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(m.points[i].separation, -0.001f, 2e-3f);
      if (k > 0) EXPECT_EQ(m.points[i].feature, names[i]);
      names[i] = m.points[i].feature;
      for (int j = 0; j < i; ++j) EXPECT_NE(names[i], names[j]);
    }
  }
}

// The edge of a card is a strip of 2 mm under the rounding; the card leans, so that one border of it is .8 mm lower. Of
// either end the manifold holds the lower corner, however it is turned: by the other one the card would sink there.
TEST(Manifold3, ACardThatLeansStandsOnTheLowerBorderOfItsEdge) {
  const Shape3 ground(Box{{20, 1, 20}}), card(Box{{0.001f, 0.49f, 0.3f}, 0.01f});
  for (const float lean : {0.4f, -0.4f, 0.2f}) {
    for (int i = 0; i < 8; ++i) {
      const Quatf q = from_axis_angle(Vec3f{0, 1, 0}, 0.7f * float(i)) * from_axis_angle(Vec3f{0, 0, 1}, lean);
      const float height = 0.49f * std::cos(lean) + 0.001f * std::abs(std::sin(lean)) + 0.01f;
      for (const bool mirrored : {false, true}) {
        const Transform3f place{{0, 1 + height - 1e-4f, 0}, q};
        PairCache cache;
        Manifold3 m;
        if (mirrored)
          collide(card, ground, inverse(place), 0.02f, cache, m);
        else
          collide(ground, card, place, 0.02f, cache, m);
        ASSERT_GE(m.count, 2);
        int deep[2] = {};
        for (int k = 0; k < m.count; ++k) {
          if (m.points[k].separation > 0) continue;
          EXPECT_NEAR(m.points[k].separation, -1e-4, 3e-5);
          const Vec3f on_card = mirrored ? m.points[k].point : inverse_transform_point(place, m.points[k].point);
          ++deep[on_card.z > 0];
        }
        EXPECT_EQ(deep[0], 1) << lean << ' ' << i << ' ' << mirrored;
        EXPECT_EQ(deep[1], 1) << lean << ' ' << i << ' ' << mirrored;
      }
    }
  }
}

// What rocks from one edge to the other comes down on points that were there before, at the height that they had.
TEST(Manifold3, CrossedSticksTouchOnAllTheirWidth) {
  const float half = 0.02f;
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? half : -half, i & 4 ? half : -half});
  const Shape3 box = Box{{0.5f, half, half}}, hull = make_hull(corners).value();
  Draw draw;
  for (int i = 0; i < 400; ++i) {
    const Shape3 &a = i & 1 ? box : hull, &b = i & 2 ? box : hull;
    const float roll_a = i & 4 ? draw.in(-0.1, 0.1) : draw.in(0.3, 0.7), roll = draw.in(0.01, 0.1);
    const Quatf cross = from_rotation_vector(Vec3f{0, draw.in(0.6, 1.6), 0});
    const auto pose = [&](float roll_b) {  // A below is rolled about its length, x; B above lies across it
      const Quatf qa = from_rotation_vector(Vec3f{roll_a, 0, 0});
      const Quatf qb = cross * from_rotation_vector(Vec3f{roll_b, 0, 0});
      const auto height = [&](float t) { return half * (math::abs(math::cos(t)) + math::abs(math::sin(t))); };
      const Vec3f up{0, height(roll_a) + height(roll_b) - 0.001f, 0};
      return Transform3f{inverse_rotate(qa, up), conjugate(qa) * qb};
    };
    const Manifold3 m = contact(a, b, pose(roll), 0.01f), then = contact(a, b, pose(-roll), 0.01f);
    ASSERT_GE(m.count, 2) << i;
    EXPECT_NEAR(double(least(m)), reference(a, b, pose(roll)), 1e-5) << i;
    const auto deepest = [](const Manifold3& of) {
      return *std::min_element(of.points, of.points + of.count, [](const ManifoldPoint3& p, const ManifoldPoint3& q) {
        return p.separation < q.separation;
      });
    };
    const Vec3f next = deepest(then).point;
    float near = 1e30f;
    for (int k = 0; k < m.count; ++k) near = min(near, length(m.points[k].point - next));
    EXPECT_GT(length(deepest(m).point - next), half) << i;
    EXPECT_LT(near, 0.4f * half) << i;
  }
}

TEST(Manifold3, OctagonOfCrossedSquaresKeepsFourSpreadPoints) {
  const Box box{{0.5f, 0.5f, 0.5f}};
  const Transform3f x{{0, 1, 0}, normalize(Quatf{0.92388f, 0, 0.38268f, 0})};  // 45°
  const Manifold3 m = contact(box, box, x, 0.02f);
  ASSERT_EQ(m.count, 4);
  Vec3f low = m.points[0].point, high = low;
  for (const ManifoldPoint3& p : m.points) low = min(low, p.point), high = max(high, p.point);
  EXPECT_GT(high.x - low.x, 0.7f);
  EXPECT_GT(high.z - low.z, 0.7f);
}

TEST(Manifold3, CylinderStandsOnItsCapAndLiesOnItsSide) {
  const Cylinder c{0.5f, 0.3f};
  const Box ground{{5, 1, 5}};
  const Quatf lying = normalize(Quatf{1, 1, 0, 0});
  for (const Shape3& floor : {Shape3(ground), Shape3(Plane{})}) {
    const float top = floor.type == ShapeType3::plane ? 0 : 1;
    const Manifold3 stands = contact(floor, c, {{0.2f, top + 0.499f, 0.1f}, {}}, 0.02f);
    ASSERT_EQ(stands.count, 4);
    EXPECT_NEAR(stands.normal.y, 1, 1e-6);
    float widest = 0;
    for (const ManifoldPoint3& p : stands.points) {
      EXPECT_NEAR(p.separation, -0.001f, 1e-5f);
      widest = max(widest, distance(p.point, stands.points[0].point));
    }
    EXPECT_GT(widest, 0.59f);
    for (int k = 0; k < 20; ++k) {  // rolling: the axis level, any turn about it
      const float angle = 0.3f * float(k);
      const Quatf spin = normalize(Quatf{1, 0, angle, 0});
      const Manifold3 lies = contact(floor, c, {{0, top + 0.299f, 0}, normalize(lying * spin)}, 0.02f);
      ASSERT_EQ(lies.count, 2);
      EXPECT_NEAR(lies.normal.y, 1, 1e-6);
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(lies.points[i].separation, -0.001f, 1e-5f);
      EXPECT_NEAR(distance(lies.points[0].point, lies.points[1].point), 1, 1e-3);
    }
  }
}

// In the cylinder's frame the far corners of the ground were off by a tenth of a millimetre: so were the separations,
// by which it was thrown about, and of twenty contacts one had its points a hundred metres away.
TEST(Manifold3, ACylinderOnAWideGroundIsWhereItIs) {
  Draw draw;
  const float radius = 0.02f, half_height = 0.1f, depth = 1e-4f;
  const Quatf lies = from_axis_angle(Vec3f{1, 0, 0}, 0.5f * float(math::pi));
  for (int k = 0; k < 2000; ++k) {
    const Quatf rolled = from_axis_angle(Vec3f{0, 0, 1}, float(draw.in(-3, 3)));
    const Vec3f at{float(draw.in(-100, 100)), 1 + radius - depth, float(draw.in(-100, 100))};
    const Manifold3 m = contact(Box{{200, 1, 200}}, Cylinder{half_height, radius}, {at, rolled * lies}, 0.01f);
    ASSERT_EQ(m.count, 2) << k;
    for (int i = 0; i < m.count; ++i) {
      ASSERT_NEAR(m.points[i].separation, -depth, 1e-6f) << k;
      ASSERT_NEAR(math::length(m.points[i].point - at), math::length(Vec3f{half_height, radius, 0}), 1e-3f) << k;
    }
  }
}

// Its outside is the core's and the rounding's: it stands on a disc of the core's radius and lies on a line of the
// core's length, and tilted by 45° it touches with one point of its rim.
// The rim of a tilted disc is told to a fiftieth of its radius, all round: what rocks on it is not lifted on the way.
TEST(Manifold3, ATiltedDiscHasItsRimAllRound) {
  const geometry::detail::Convex disc = geometry::detail::convex_of(Cylinder{0.05f, 1});
  Draw draw;
  for (int i = 0; i < 100; ++i) {
    geometry::detail::Feature face;
    const float heading = draw.in(-3, 3), tilt = draw.in(0.02, 0.5);
    const Vec3f lowest{math::cos(heading), 0, math::sin(heading)};
    geometry::detail::feature(disc, normalize(Vec3f{0, -1, 0} + lowest * tilt), face);
    float most = 0;
    for (int k = 0; k < face.count; ++k) {
      const Vec3f middle = 0.5f * (face.point[k] + face.point[k + 1 < face.count ? k + 1 : 0]);
      most = max(most, 1 - length(Vec3f{middle.x, 0, middle.z}));
    }
    EXPECT_LT(most, 0.02f) << i;
  }
}

TEST(Manifold3, RoundedCylinderStandsLiesAndLeans) {
  const Cylinder c{0.4f, 0.3f, 0.1f};
  const Box ground{{5, 1, 5}};
  const Manifold3 stands = contact(ground, c, {{0.2f, 1.499f, 0.1f}, {}}, 0.02f);
  ASSERT_EQ(stands.count, 4);
  float widest = 0;
  for (const ManifoldPoint3& p : stands.points) {
    EXPECT_NEAR(p.separation, -0.001f, 1e-5f);
    widest = max(widest, distance(p.point, stands.points[0].point));
  }
  EXPECT_NEAR(widest, 0.6f, 0.02f);
  const Manifold3 lies = contact(ground, c, {{0, 1.399f, 0}, normalize(Quatf{1, 1, 0, 0})}, 0.02f);
  ASSERT_EQ(lies.count, 2);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(lies.points[i].separation, -0.001f, 1e-5f);
  EXPECT_NEAR(distance(lies.points[0].point, lies.points[1].point), 0.8f, 1e-3f);
  const float height = 0.7f / math::sqrt(2.0f) + 0.1f;
  const Manifold3 leans =
      contact(ground, c, {{0, 1 + height - 0.001f, 0}, from_axis_angle(Vec3f{0, 0, 1}, pi_f / 4)}, 0.005f);
  ASSERT_EQ(leans.count, 1);
  EXPECT_NEAR(leans.points[0].separation, -0.001f, 1e-4f);
  EXPECT_NEAR(leans.normal.y, 1, 1e-4f);
}

TEST(Manifold3, ConeRestsOnItsBaseAndOnItsSide) {
  const Cone c{0.5f, 0.4f};
  const Manifold3 base = contact(Plane{}, c, {{0, 0.499f, 0}, {}}, 0.02f);
  EXPECT_EQ(base.count, 4);
  // On its side the slant line is level: the axis leans by the half angle atan(r/2h).
  const double slant = math::sqrt(1.0 + 0.16);
  const Vec3f side_normal{float(1.0 / slant), float(0.4 / slant), 0};
  const Vec3f axis = cross(side_normal, Vec3f{0, -1, 0});
  const float c2 = dot(side_normal, Vec3f{0, -1, 0});
  const Quatf q = normalize(Quatf{1 + c2, axis});
  const float height = float(0.5 * 0.4 / slant) - 0.001f;
  const Manifold3 side = contact(Box{{5, 1, 5}}, c, {{0, 1 + height, 0}, q}, 0.02f);
  ASSERT_EQ(side.count, 2);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(side.points[i].separation, -0.001f, 1e-4f);
}

// On its base it stands on the core's disc, on its side it lies on the core's line, on its tip it touches with a point.
TEST(Manifold3, RoundedConeStandsLiesAndStandsOnItsTip) {
  const Cone c{0.5f, 0.4f, 0.1f};
  const Box ground{{5, 1, 5}};
  const Manifold3 base = contact(ground, c, {{0.1f, 1.599f, 0}, {}}, 0.02f);
  ASSERT_EQ(base.count, 4);
  for (const ManifoldPoint3& p : base.points) EXPECT_NEAR(p.separation, -0.001f, 1e-5f);
  const double slant = math::sqrt(1.0 + 0.16);
  const Vec3f side_normal{float(1.0 / slant), float(0.4 / slant), 0};
  const Quatf q = normalize(Quatf{1 + dot(side_normal, Vec3f{0, -1, 0}), cross(side_normal, Vec3f{0, -1, 0})});
  const Manifold3 side = contact(ground, c, {{0, 1 + float(0.5 * 0.4 / slant) + 0.099f, 0}, q}, 0.02f);
  ASSERT_EQ(side.count, 2);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(side.points[i].separation, -0.001f, 1e-4f);
  EXPECT_NEAR(distance(side.points[0].point, side.points[1].point), slant, 2e-3);
  const Manifold3 tip = contact(ground, c, {{0, 1.599f, 0}, {0, 1, 0, 0}}, 0.005f);
  ASSERT_EQ(tip.count, 1);
  EXPECT_NEAR(tip.points[0].separation, -0.001f, 1e-5f);
}

TEST(Manifold3, FlushTilesDoNotCatchABoxThatSlidesOverThem) {
  const Box tile{{0.5f, 0.5f, 0.5f}}, box{{0.25f, 0.25f, 0.25f}};
  const Quatf turned = normalize(Quatf{0.98877f, 0, 0.14944f, 0});  // 0.3 rad
  for (const Quatf& q : {Quatf{}, turned}) {
    PairCache cache;
    for (int k = 0; k < 2000; ++k) {
      const float x = -1.2f + 0.001f * float(k);
      for (const float sink : {-0.002f, 0.0f, 0.0005f, 0.002f}) {
        Manifold3 m;
        collide(tile, box, {{x, 0.75f - sink, 0.1f}, q}, 0.02f, cache, m);
        if (m.count > 0) ASSERT_GT(m.normal.y, 0.999f) << x << " " << sink;
      }
    }
  }
}

TEST(Manifold3, FlushTilesDoNotCatchRoundShapes) {
  // Sunk by what a resting body sinks, or a little above: the neighbour's border never pushes sideways.
  const Box tile{{0.5f, 0.5f, 0.5f}};
  const Quatf across = normalize(Quatf{1, 1, 0, 0}), along = normalize(Quatf{1, 0, 0, 1});
  struct Case {
    Shape3 shape;
    float height;
    Quatf q;
  };
  const Case cases[] = {{Sphere{0.3f}, 0.3f, {}},
                        {Capsule3{0.3f, 0.3f}, 0.3f, across},
                        {Capsule3{0.3f, 0.3f}, 0.3f, along},
                        {Cylinder{0.3f, 0.3f}, 0.3f, across},
                        {Cylinder{0.3f, 0.3f}, 0.3f, {}}};
  for (const Case& c : cases) {
    PairCache cache;
    for (int k = 0; k < 2400; ++k)
      for (const float sink : {-0.002f, 0.0f, 0.0005f}) {
        Manifold3 m;
        collide(tile, c.shape, {{-1.2f + 0.001f * float(k), 0.5f + c.height - sink, 0.1f}, c.q}, 0.16f, cache, m);
        if (m.count > 0) ASSERT_GT(m.normal.y, 0.9999f) << int(c.shape.type) << " " << k << " " << sink;
      }
  }
}

TEST(Manifold3, HardCasesStayFinite) {
  Draw draw;
  for (int ka = 0; ka < convex_kinds; ++ka)
    for (int kb = 0; kb < convex_kinds; ++kb)
      for (const float size_a : {0.001f, 1.0f, 1000.0f})
        for (const float size_b : {0.001f, 1.0f, 1000.0f})
          for (int k = 0; k < 6; ++k) {
            const Shape3 a = random_convex(draw, ka, size_a), b = random_convex(draw, kb, size_b);
            Transform3f x;
            if (k == 1) x.p = {size_a, 0, 0};
            if (k == 2) x.q = normalize(Quatf{1, 1, 0, 0});
            if (k == 3) x.p = {0, size_a + size_b, 0};
            if (k == 4) x = {draw.direction() * 1e-7f, draw.rotation()};
            if (k == 5) x = {draw.direction() * size_a, draw.rotation()};
            const Manifold3 m = contact(a, b, x, 0.01f);
            ASSERT_TRUE(finite(m)) << kind_name(ka) << " " << kind_name(kb) << " " << size_a << " " << size_b << " "
                                   << k;
            if (m.count > 0) ASSERT_NEAR(length(m.normal), 1, 1e-3);
            // A sparse hull need not hold its own origin.
            if (k == 0 && ka != 5 && kb != 5) ASSERT_GT(m.count, 0) << kind_name(ka) << " " << kind_name(kb);
          }
}
}  // namespace
