// The planes that triangles leave to a capsule, some triangles at a time: as distances and contacts tell them.
#include "carom/geometry/detail/triangle_blocks.h"

#include <gtest/gtest.h>

#include "carom/geometry/detail/contact_points.h"
#include "carom/math/elementary.h"
#include "manifold_test_support.h"

namespace carom::geometry::triangle_blocks_test {
using detail::SurfacePlane;
using detail::TriangleBlocks;
using geometry::testing::Draw;

float wave(int i, int j) { return 0.8f * math::sin(0.5f * float(i)) * math::cos(0.4f * float(j)); }
Shape3 wavy_mesh(int cells, float size, float height) {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) vertices.push_back({float(i) * size, height * wave(i, j), float(j) * size});
  const auto at = [&](int i, int j) { return std::uint32_t(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const std::uint32_t k : {at(i, j), at(i + 1, j + 1), at(i + 1, j), at(i, j), at(i, j + 1), at(i + 1, j + 1)})
        indices.push_back(k);
  return Shape3(make_triangle_mesh(vertices, indices).value());
}
Shape3 wavy_field(int cells, float size, float height) {
  std::vector<float> heights;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) heights.push_back(height * wave(i, j));
  return Shape3(make_height_field(cells + 1, cells + 1, {size, size}, heights).value());
}

constexpr float half_length = 0.6f, radius = 0.3f, margin = 0.4f;
int planes_of(const Shape3& surface, const Transform3f& x, std::span<SurfacePlane> out, int lanes = 0) {
  Bounds3f box = grow(bounds(Shape3(Capsule3{half_length, radius}), x), margin);
  box.high.y += 2 * (half_length + 2 * radius);
  TriangleBlocks blocks(lanes);
  blocks.gather(surface, grow(box, 0.7f));  // more than is asked about, as a character gathers
  return blocks.planes({x.p, rotate(x.q, Vec3f{0, half_length, 0}), radius, margin, box}, out);
}

// The nearest plane is as far as the surface is; over a flat edge a face counts for 1° beyond it, r (1 − cos 1°) deep.
TEST(TriangleBlocks, TellTheDistance) {
  Draw draw;
  const Shape3 capsule = Capsule3{half_length, radius};
  int seen = 0;
  for (const Shape3& ground : {wavy_mesh(16, 0.5f, 0.6f), wavy_field(16, 0.5f, 0.6f)})
    for (int k = 0; k < 3000; ++k) {
      const Quatf q = normalize(Quatf{1, draw.in(-0.4, 0.4), draw.in(-0.4, 0.4), draw.in(-0.4, 0.4)});
      const Transform3f x{{draw.in(2, 6), draw.in(0.7, 2.2), draw.in(2, 6)}, q};
      const float d = geometry::distance(ground, capsule, x).distance;
      SurfacePlane planes[16];
      const int count = planes_of(ground, x, planes);
      if (!(d > 0) || d > 0.95f * margin) continue;
      ++seen;
      ASSERT_GT(count, 0) << k << " at " << d;
      EXPECT_NEAR(planes[0].separation, d, 5e-5f) << k;
      for (int i = 1; i < count; ++i) EXPECT_GE(planes[i].separation, planes[i - 1].separation);
    }
  EXPECT_GT(seen, 1500);
}

// Where contacts are, planes are: with their normals and depths. Contacts take a face that is within a thousandth of
// the capsule's radius for the way out.
TEST(TriangleBlocks, TellWhatContactsTell) {
  Draw draw;
  const Shape3 capsule = Capsule3{half_length, radius};
  int seen = 0;
  for (const float height : {0.3f, 1.2f})
    for (const Shape3& ground : {wavy_mesh(16, 0.5f, height), wavy_field(16, 0.5f, height)})
      for (int k = 0; k < 2000; ++k) {
        const Transform3f x{{draw.in(2, 6), draw.in(0.3, 2), draw.in(2, 6)},
                            normalize(Quatf{1, draw.in(-0.3, 0.3), 0, draw.in(-0.3, 0.3)})};
        Manifold3 contacts[16];
        const Bounds3f box = grow(bounds(capsule, x), margin);
        const int count = detail::collide_surface(ground, capsule, x, margin, box, contacts);
        if (count == 0) continue;
        float least = 1e9f;
        int deepest = 0;
        for (int i = 0; i < count; ++i)
          for (int p = 0; p < contacts[i].count; ++p)
            if (contacts[i].points[p].separation < least) least = contacts[i].points[p].separation, deepest = i;
        if (least < -0.9f * radius) continue;  // its line is in the ground
        SurfacePlane planes[16];
        const int found = planes_of(ground, x, planes);
        ++seen;
        ASSERT_GT(found, 0) << k;
        EXPECT_NEAR(planes[0].separation, least, 1e-3f * radius) << k;
        bool same = false;
        for (int i = 0; i < found; ++i)
          same = same || (dot(planes[i].normal, contacts[deepest].normal) > 0.99f &&
                          math::abs(planes[i].separation - least) < 1e-3f);
        EXPECT_TRUE(same) << k;
      }
  EXPECT_GT(seen, 2000);
}

// Whatever the width, the same planes to the bit.
TEST(TriangleBlocks, WidthsAgree) {
  Draw draw;
  int seen = 0;
  for (const Shape3& ground : {wavy_mesh(16, 0.5f, 1.2f), wavy_field(16, 0.5f, 1.2f)})
    for (int k = 0; k < 1000; ++k) {
      const Transform3f x{{draw.in(2, 6), draw.in(0.3, 2), draw.in(2, 6)},
                          normalize(Quatf{1, draw.in(-0.3, 0.3), 0, draw.in(-0.3, 0.3)})};
      SurfacePlane four[16], eight[16];
      const int count = planes_of(ground, x, four, 4);
      ASSERT_EQ(planes_of(ground, x, eight, 8), count) << k;
      for (int i = 0; i < count; ++i) {
        EXPECT_EQ(four[i].normal, eight[i].normal) << k;
        EXPECT_EQ(four[i].separation, eight[i].separation) << k;
        EXPECT_EQ(four[i].point, eight[i].point) << k;
        ++seen;
      }
    }
  EXPECT_GT(seen, 2000);
}

// Flat seams push along the face's normal only; the edge of a ledge pushes aside.
TEST(TriangleBlocks, SeamsDoNotPush) {
  Draw draw;
  const Shape3 ground = wavy_mesh(16, 0.5f, 0);
  for (int k = 0; k < 500; ++k) {
    SurfacePlane planes[16];
    const Transform3f x{{draw.in(2, 6), half_length + radius + draw.in(-0.02, 0.2), draw.in(2, 6)}, {}};
    ASSERT_EQ(planes_of(ground, x, planes), 1) << k;
    EXPECT_NEAR(planes[0].normal.y, 1, 1e-6f);
    EXPECT_NEAR(planes[0].separation, x.p.y - half_length - radius, 1e-6f);
    EXPECT_NEAR(planes[0].point.y, 0, 1e-6f);
  }
  // Beside the border at x = 0, its lower end below the level of the ground: the border is an edge to it.
  SurfacePlane planes[16];
  const Transform3f beside{{-0.4f, half_length - 0.1f + 0.3f, 4.1f}, {}};
  const int count = planes_of(ground, beside, planes);
  ASSERT_GE(count, 1);
  const float distance = math::sqrt(0.4f * 0.4f + 0.2f * 0.2f);
  EXPECT_NEAR(planes[0].separation, distance - radius, 1e-5f);
  EXPECT_NEAR(planes[0].normal.x, -0.4f / distance, 1e-5f);
}

// Two triangles of two kilometres that lean: far corners cost a fifth of a millimetre at most.
TEST(TriangleBlocks, LargeTrianglesAreTrue) {
  Draw draw;
  const auto at = [](float x, float z) { return Vec3f{x, 0.3f * x + 0.2f * z, z}; };
  const std::vector<Vec3f> vertices{at(-1000, -1000), at(-1000, 1000), at(1000, 1000), at(1000, -1000)};
  const Shape3 ground(make_triangle_mesh(vertices, {0, 1, 2, 0, 2, 3}).value());
  const Vec3f normal = normalize(Vec3f{-0.3f, 1, -0.2f});
  for (int k = 0; k < 500; ++k) {
    const float x = draw.in(-700, 700), z = draw.in(-700, 700);
    const Vec3f foot = at(x, z);
    const float gap = draw.in(-0.02, 0.3);
    const Vec3f low = foot + normal * (radius + gap);
    SurfacePlane planes[16];
    const int count = planes_of(ground, {low + Vec3f{0, half_length, 0}, {}}, planes);
    ASSERT_GE(count, 1) << k;
    EXPECT_NEAR(planes[0].separation, gap, 2e-4f) << k;
    EXPECT_GT(dot(planes[0].normal, normal), 0.99999f) << k;
  }
}

}  // namespace carom::geometry::triangle_blocks_test
