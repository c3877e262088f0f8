// The closed form for a triangle beside a box or hull finds what the search for a distance finds.
#include <gtest/gtest.h>

#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/off_directions.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::geometry::triangle_distance_test {

using namespace detail;

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d d = b - a;
  return length(p - a - d * clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0));
}

void compare(const Shape3& shape, std::uint64_t seed) {
  math::Random random(seed);
  const auto number = [&](double size) { return random.uniform(-size, size); };
  const auto vector = [&](double size) { return Vec3f(Vec3d{number(size), number(size), number(size)}); };
  const Convex core = convex_of(shape);
  int compared = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3f p = vector(2), q = p + vector(1.5), r = p + vector(1.5);
    if (length(cross(q - p, r - p)) < 0.05f) continue;
    const Transform3f x{vector(0.5), normalize(Quatf{float(number(1)), float(number(1)), float(number(1)), 0.1f})};
    const Convex triangle = convex_of_triangle(p, q, r);
    CoreDistance sought, found;
    core_distance(Placed(triangle), Placed(core, x), 1e30, {}, sought);
    if (sought.overlap || sought.distance < 1e-3) continue;
    const PlacedCorners corners(core, x);
    OffDirections off(corners, {}, 0, 1, false);
    const Vec3d corner[3] = {Vec3d(p), Vec3d(q), Vec3d(r)};
    ASSERT_TRUE(triangle_distance(corner, corners, Vec3d(triangle.normal), 1e30, 7, off, found));
    ASSERT_FALSE(found.overlap);
    EXPECT_GE(found.distance, sought.distance - 1e-5) << k;
    EXPECT_NEAR(length(found.point_b - found.point_a), found.distance, 1e-5) << k;
    const double to_border = min(distance_to_segment(sought.point_a, corner[0], corner[1]),
                                 min(distance_to_segment(sought.point_a, corner[1], corner[2]),
                                     distance_to_segment(sought.point_a, corner[2], corner[0])));
    if (to_border > 1e-6) continue;  // a corner of the shape stands over the face: not what is asked
    ++compared;
    EXPECT_NEAR(found.distance, sought.distance, 1e-5) << k;
    EXPECT_GT(dot(found.normal, sought.normal), 0.9999) << k;
  }
  EXPECT_GT(compared, 1000);
}

TEST(TriangleDistance, OfEdgesOfABoxIsThatOfTheSearch) { compare(Box{{0.5f, 0.2f, 0.9f}}, 1); }

TEST(TriangleDistance, OfEdgesOfAPrismIsThatOfTheSearch) {
  std::vector<Vec3f> points;
  for (int k = 0; k < 6; ++k)
    for (const float y : {-0.8f, 1.2f})
      points.push_back({0.4f * float(math::cos(k * pi / 3)), y, 0.4f * float(math::sin(k * pi / 3))});
  compare(Shape3(make_hull(points).value()), 2);
}

TEST(TriangleDistance, ASegmentGoesThroughAShapeOrNot) {
  math::Random random(3);
  const Vec3f half{0.5f, 0.2f, 0.9f};
  const PlacedCorners corners(convex_of(Shape3(Box{half})), {});
  int through = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto vector = [&] {
      return Vec3d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    };
    const Vec3d a = vector(), b = vector();
    // How deep it comes at the most, by samples: between two of them it is hardly deeper.
    double deepest = -10;
    for (int i = 0; i <= 1000; ++i) {
      const Vec3d at = a + (b - a) * (i / 1000.0);
      deepest = max(deepest, min(double(half.x) - math::abs(at.x),
                                 min(double(half.y) - math::abs(at.y), double(half.z) - math::abs(at.z))));
    }
    if (math::abs(deepest) < 0.004) continue;
    through += deepest > 0 ? 1 : 0;
    EXPECT_EQ(corners.meets_segment(Vec3f(a), Vec3f(b - a)), deepest > 0) << k;
  }
  EXPECT_GT(through, 300);
}

}  // namespace carom::geometry::triangle_distance_test
