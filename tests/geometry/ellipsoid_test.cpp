// Ellipsoids against closed forms: support, bounds, mass, rays, distances, contacts.
#include <gtest/gtest.h>

#include "carom/geometry/manifold.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/query.h"
#include "carom/math/random.h"
#include "carom/math/rotation.h"

namespace carom::geometry {
namespace {

using namespace math;

constexpr Ellipsoid egg{{0.7f, 0.4f, 1.1f}};

/// Pseudo-random numbers in (−1, 1), always the same.
struct Dice {
  std::uint32_t state = 2463534242u;
  float operator()() {
    state ^= state << 13, state ^= state >> 17, state ^= state << 5;
    return float(state >> 8) / 8388608.0f - 1;
  }
  Vec3f direction() {
    while (true) {
      const Vec3f v{(*this)(), (*this)(), (*this)()};
      if (length_squared(v) > 0.05f && length_squared(v) < 1) return normalize(v);
    }
  }
  Quatf rotation() { return normalize(Quatf{(*this)(), (*this)(), (*this)(), (*this)()}); }
};

/// h(n) = √(Σ rᵢ² nᵢ²), the support function.
double reach(Vec3f n) {
  const Vec3d p = scale(Vec3d(egg.radii), Vec3d(n));
  return length(p);
}

TEST(Ellipsoid, SupportAndBoundsAreExact) {
  Dice draw;
  for (int i = 0; i < 200; ++i) {
    const Vec3f n = draw.direction(), p = support(egg, n);
    EXPECT_NEAR(dot(p, n), reach(n), 2e-6);
    const Vec3f u{p.x / egg.radii.x, p.y / egg.radii.y, p.z / egg.radii.z};
    EXPECT_NEAR(length(u), 1, 2e-6f) << "on the surface";
    const Transform3f t{{1, 2, 3}, draw.rotation()};
    const Bounds3f b = bounds(egg, t);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3f e{};
      e[axis] = 1;
      EXPECT_NEAR(b.high[axis] - t.p[axis], reach(inverse_rotate(t.q, e)), 4e-6);
      EXPECT_NEAR(t.p[axis] - b.low[axis], reach(inverse_rotate(t.q, e)), 4e-6);
    }
  }
  EXPECT_FALSE(validate(Ellipsoid{{1, 0, 1}}).ok());
  EXPECT_NE(validate(Ellipsoid{{1, 0, 1}}).error().message.find("ellipsoid.radii.y"), std::string::npos);
}

// I = m/5 (b² + c²), m = 4/3 π abc ρ.
TEST(Ellipsoid, MassAndInertia) {
  const MassProperties3 p = mass_properties(egg, 800);
  const double a = egg.radii.x, b = egg.radii.y, c = egg.radii.z, m = 800 * 4.0 / 3.0 * pi * a * b * c;
  EXPECT_NEAR(p.mass, m, 1e-9 * m);
  EXPECT_NEAR(p.inertia.cx.x, m / 5 * (b * b + c * c), 1e-9 * m);
  EXPECT_NEAR(p.inertia.cy.y, m / 5 * (c * c + a * a), 1e-9 * m);
  EXPECT_NEAR(p.inertia.cz.z, m / 5 * (a * a + b * b), 1e-9 * m);
  EXPECT_EQ(p.center, (Vec3d{}));
}

TEST(Ellipsoid, RaysMeetTheQuadric) {
  Dice draw;
  for (int i = 0; i < 200; ++i) {
    const Vec3f from = draw.direction() * 3.0f, to = draw.direction() * 0.3f;
    const CastHit3 hit = ray_cast(egg, from, 2.0f * (to - from));
    ASSERT_TRUE(hit.hit);
    const Vec3d r(egg.radii), p(hit.point), u{p.x / r.x, p.y / r.y, p.z / r.z};
    EXPECT_NEAR(length(u), 1, 3e-6);
    const Vec3d gradient = normalize(Vec3d{u.x / r.x, u.y / r.y, u.z / r.z});
    EXPECT_LT(length(gradient - Vec3d(hit.normal)), 1e-5);
  }
  EXPECT_EQ(ray_cast(egg, {}, {1, 0, 0}).fraction, 0.0f) << "from inside";
  EXPECT_FALSE(ray_cast(egg, {0, 0.41f, -3}, {0, 0, 6}).hit) << "just past it";
}

/// Above a plane with normal n in the ellipsoid's frame its centre touches at the height h(n).
TEST(Ellipsoid, TouchesPlanesAndBoxesAtItsSupport) {
  Dice draw;
  for (int i = 0; i < 100; ++i) {
    const Quatf q = draw.rotation();
    const float h = float(reach(inverse_rotate(q, Vec3f{0, 1, 0})));
    for (const float gap : {0.01f, 0.0f, -0.01f}) {
      const Transform3f place{{0.1f, h + gap, -0.2f}, q};
      PairCache cache;
      Manifold3 m;
      collide(Plane{}, egg, place, 0.05f, cache, m);
      ASSERT_EQ(m.count, 1);
      EXPECT_NEAR(m.points[0].separation, gap, 3e-6f);
      const Transform3f above{{0.1f, h + gap + 1, -0.2f}, q};
      PairCache other;
      collide(Box{{5, 1, 5}}, egg, above, 0.05f, other, m);
      ASSERT_GE(m.count, 1);
      EXPECT_NEAR(m.points[0].separation, gap, 3e-5f);
      EXPECT_NEAR(m.normal.y, 1, 1e-4f);
    }
  }
}

TEST(Ellipsoid, DistanceAlongAnAxisAndOfSpheres) {
  const Distance3 d = distance(Shape3(egg), Shape3(egg), {{2, 0, 0}, {}});
  EXPECT_NEAR(d.distance, 2 - 1.4f, 1e-5f);
  EXPECT_LT(length(d.normal - Vec3f{1, 0, 0}), 1e-3f);
  // With equal half axes it is a sphere.
  Dice draw;
  const Ellipsoid round{{0.5f, 0.5f, 0.5f}};
  for (int i = 0; i < 50; ++i) {
    const Transform3f t{draw.direction() * 1.4f, draw.rotation()};
    EXPECT_NEAR(distance(Shape3(round), Shape3(Sphere{0.6f}), t).distance, 0.3f, 1e-5f);
    EXPECT_NEAR(distance(Shape3(round), Shape3(Box{{0.2f, 0.3f, 0.1f}}), t).distance,
                distance(Shape3(Sphere{0.5f}), Shape3(Box{{0.2f, 0.3f, 0.1f}}), t).distance, 1e-5f);
    PairCache cache;
    Manifold3 m;
    collide(round, round, {t.p * (0.95f / 1.4f), t.q}, 0.01f, cache, m);
    ASSERT_EQ(m.count, 1);
    EXPECT_NEAR(m.points[0].separation, -0.05f, 1e-4f);
    EXPECT_LT(length(m.normal - normalize(t.p)), 5e-3f);
    EXPECT_NEAR(shape_cast(Shape3(round), Shape3(round), {t.p * 2.0f, t.q}, t.p * -2.0f).fraction, 1 - 1 / 2.8f, 1e-4f);
  }
}

}  // namespace
}  // namespace carom::geometry
