// Contacts with meshes, height fields and compounds: flush triangles are one plane, edges that stand out still hold.
#include <gtest/gtest.h>

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "manifold_test_support.h"

namespace {
using namespace carom;
using namespace carom::geometry;
using namespace carom::geometry::testing;

std::shared_ptr<const TriangleMesh> flat_mesh(int cells, float size) {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) vertices.push_back({float(i) * size, 0, float(j) * size});
  const auto at = [&](int i, int j) { return std::uint32_t(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const std::uint32_t k : {at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i, j), at(i, j + 1), at(i + 1, j + 1)})
        indices.push_back(k);
  return make_triangle_mesh(vertices, indices).value();
}
std::shared_ptr<const HeightField> flat_field(int cells, float size) {
  return make_height_field(cells + 1, cells + 1, {size, size},
                           std::vector<float>(std::size_t((cells + 1) * (cells + 1))))
      .value();
}

TEST(ManifoldMany, FlushTrianglesAreOnePlane) {
  Draw draw;
  const Shape3 grounds[] = {flat_mesh(8, 1), flat_field(8, 1)};
  const Quatf lying = normalize(Quatf{1, 0, 0, 1});
  struct Case {
    Shape3 shape;
    float height;
    Quatf q;
    int points;
  };
  const Case cases[] = {{Sphere{0.3f}, 0.3f, {}, 1},
                        {Capsule3{0.3f, 0.3f}, 0.3f, lying, 2},
                        {Box{{0.25f, 0.25f, 0.25f}}, 0.25f, {}, 4},
                        {Box{{0.7f, 0.25f, 0.7f}}, 0.25f, {}, 4},
                        {Cylinder{0.3f, 0.4f}, 0.3f, {}, 4},
                        {Cylinder{0.3f, 0.4f}, 0.4f, lying, 2},
                        {Cone{0.3f, 0.4f}, 0.3f, {}, 4}};
  for (const Shape3& ground : grounds)
    for (const Case& c : cases)
      for (int k = 0; k < 400; ++k) {
        const float sink = draw.in(-0.004, 0.004);
        const Quatf turn = normalize(Quatf{draw.in(0.1, 1), 0, draw.in(-1, 1), 0});
        const Transform3f x{{draw.in(1.5, 6.5), c.height - sink, draw.in(1.5, 6.5)}, normalize(turn * c.q)};
        Manifold3 m[4];
        const int count = collide_many(ground, c.shape, x, 0.02f, m);
        ASSERT_EQ(count, 1) << int(c.shape.type) << " " << k;
        EXPECT_GT(m[0].normal.y, 0.9999f);
        EXPECT_EQ(m[0].count, c.points) << int(c.shape.type) << " " << k << " at " << x.p.x << " " << x.p.z;
        for (int i = 0; i < m[0].count; ++i) EXPECT_NEAR(m[0].points[i].separation, -sink, 1e-4f);
        // Seen from the other shape.
        Manifold3 r[4];
        ASSERT_EQ(collide_many(c.shape, ground, inverse(x), 0.02f, r), 1);
        EXPECT_LT(rotate(x.q, r[0].normal).y, -0.999f);
        EXPECT_EQ(r[0].count, m[0].count);
      }
}

TEST(ManifoldMany, NamesStayWhileABoxSlidesOverTriangles) {
  const Shape3 ground = flat_mesh(8, 1), box = Box{{0.25f, 0.25f, 0.25f}};
  std::uint32_t names[4] = {};
  for (int k = 0; k < 500; ++k) {
    Manifold3 m[2];
    ASSERT_EQ(collide_many(ground, box, {{2 + 0.005f * float(k), 0.249f, 2.6f + 0.002f * float(k)}, {}}, 0.02f, m), 1);
    ASSERT_EQ(m[0].count, 4);
    std::uint32_t now[4];
    for (int i = 0; i < 4; ++i) now[i] = m[0].points[i].feature;
    for (int i = 0; i < 4; ++i) {
      if (k == 0) {
        names[i] = now[i];
        continue;
      }
      EXPECT_TRUE(names[i] == now[0] || names[i] == now[1] || names[i] == now[2] || names[i] == now[3]) << k;
    }
  }
}

TEST(ManifoldMany, OneSidedTrianglesAndSolidGround) {
  const Sphere ball{0.3f};
  Manifold3 m[2];
  EXPECT_EQ(collide_many(Shape3(flat_mesh(2, 1)), ball, {{1.2f, -0.1f, 1.4f}, {}}, 0.02f, m), 0);
  // Under the surface of solid ground it is pushed up.
  ASSERT_EQ(collide_many(Shape3(flat_field(2, 1)), ball, {{1.2f, -0.1f, 1.4f}, {}}, 0.02f, m), 1);
  EXPECT_NEAR(m[0].normal.y, 1, 1e-5);
  EXPECT_NEAR(m[0].points[0].separation, -0.4f, 1e-5f);
}

TEST(ManifoldMany, RidgeHoldsABoxOnItsEdge) {
  // A roof of two faces with its ridge along z: the box balances on it.
  const std::vector<Vec3f> v{{-1, -1, -2}, {0, 0, -2}, {1, -1, -2}, {-1, -1, 2}, {0, 0, 2}, {1, -1, 2}};
  const std::vector<std::uint32_t> i{0, 3, 1, 1, 3, 4, 1, 4, 2, 2, 4, 5};
  const Shape3 roof = make_triangle_mesh(v, i).value();
  Manifold3 m[4];
  const int count = collide_many(roof, Box{{0.5f, 0.5f, 0.5f}}, {{0.05f, 0.499f, 0.1f}, {}}, 0.02f, m);
  ASSERT_GE(count, 1);
  EXPECT_NEAR(m[0].normal.y, 1, 1e-3);
  int points = 0;
  for (int k = 0; k < count; ++k) points += m[k].count;
  EXPECT_GE(points, 2);
  EXPECT_NEAR(m[0].points[0].separation, -0.001f, 1e-3f);
}

TEST(ManifoldMany, StepsOfAMeshStopABox) {
  // A step up of 0.3 m: floor, riser, upper floor. A box that runs into the riser is pushed back, not up.
  const std::vector<Vec3f> v{{-3, 0, -3}, {0, 0, -3}, {0, 0.3f, -3}, {3, 0.3f, -3},
                             {-3, 0, 3},  {0, 0, 3},  {0, 0.3f, 3},  {3, 0.3f, 3}};
  const std::vector<std::uint32_t> i{0, 4, 1, 1, 4, 5, 1, 5, 2, 2, 5, 6, 2, 6, 3, 3, 6, 7};
  const Shape3 step = make_triangle_mesh(v, i).value();
  Manifold3 m[4];
  const int count = collide_many(step, Box{{0.25f, 0.25f, 0.25f}}, {{-0.24f, 0.249f, 0.1f}, {}}, 0.02f, m);
  ASSERT_EQ(count, 2);
  bool floor = false, riser = false;
  for (int k = 0; k < count; ++k) {
    if (m[k].normal.y > 0.999f) {
      floor = true;
      EXPECT_NEAR(m[k].points[0].separation, -0.001f, 1e-4f);
    } else if (m[k].normal.x < -0.999f) {
      riser = true;
      EXPECT_NEAR(m[k].points[0].separation, -0.01f, 1e-4f);
    }
  }
  EXPECT_TRUE(floor && riser);
}

TEST(ManifoldMany, CompoundChildrenAnswerForThemselves) {
  std::vector<CompoundChild> children{{Box{{0.5f, 0.5f, 0.5f}}, {{-2, 0, 0}, {}}}, {Sphere{0.5f}, {{2, 0, 0}, {}}}};
  const Shape3 compound = make_compound(children).value();
  Manifold3 m[4];
  const Box bar{{4, 0.5f, 0.5f}};
  const int count = collide_many(compound, bar, {{0, 0.99f, 0}, {}}, 0.02f, m);
  ASSERT_EQ(count, 2);
  EXPECT_NE(m[0].child, m[1].child);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(m[k].normal.y, 1, 1e-5);
    EXPECT_NEAR(m[k].points[0].separation, -0.01f, 1e-5f);
    EXPECT_EQ(m[k].count, m[k].child == 0 ? 4 : 1);
  }
  // On a mesh, on a plane, and on another compound.
  Manifold3 r[4];
  EXPECT_EQ(collide_many(Shape3(flat_mesh(8, 1)), compound, {{4, 0.499f, 4.2f}, {}}, 0.02f, r), 2);
  EXPECT_EQ(collide_many(Shape3(Plane{}), compound, {{0, 0.499f, 0}, {}}, 0.02f, r), 2);
  EXPECT_EQ(collide_many(compound, compound, {{0, 0.99f, 0}, {}}, 0.02f, r), 2);
}

TEST(ManifoldMany, HillsPushAlongTheirOwnNormals) {
  // A ball that rests on a gently curved field feels the field's normal within what the facets turn.
  const int n = 40;
  std::vector<float> heights;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) heights.push_back(0.02f * float((i - 20) * (i - 20) + (j - 20) * (j - 20)) * 0.05f);
  const Shape3 bowl = make_height_field(n + 1, n + 1, {0.25f, 0.25f}, heights).value();
  Draw draw;
  for (int k = 0; k < 500; ++k) {
    const float x = draw.in(2, 8), z = draw.in(2, 8);
    const float u = x / 0.25f - 20, w = z / 0.25f - 20;
    const float h = 0.001f * (u * u + w * w);
    const Vec3f n3 = normalize(Vec3f{-0.002f * u / 0.25f, 1, -0.002f * w / 0.25f});
    Manifold3 m[4];
    const int count = collide_many(bowl, Sphere{0.3f}, {Vec3f{x, h, z} + n3 * 0.299f, {}}, 0.02f, m);
    ASSERT_GE(count, 1);
    EXPECT_GT(dot(m[0].normal, n3), 0.9995f);
    EXPECT_NEAR(m[0].points[0].separation, -0.001f, 1e-3f);
  }
}
}  // namespace
