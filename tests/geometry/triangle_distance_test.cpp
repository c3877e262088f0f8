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

Shape3 prism(int sides) {
  std::vector<Vec3f> points;
  for (int k = 0; k < sides; ++k)
    for (const float y : {-0.8f, 1.2f})
      points.push_back({0.4f * float(math::cos(k * 2 * pi / sides)), y, 0.4f * float(math::sin(k * 2 * pi / sides))});
  return Shape3(make_hull(points).value());
}
TEST(TriangleDistance, OfEdgesOfAPrismIsThatOfTheSearch) { compare(prism(6), 2); }

// The same box as a hull has its distance searched for.
TEST(SegmentDistance, OfABoxIsThatOfTheSearch) {
  math::Random random(3);
  const auto number = [&](double size) { return float(random.uniform(-size, size)); };
  const auto vector = [&](double size) { return Vec3f{number(size), number(size), number(size)}; };
  const auto turn = [&] { return normalize(Quatf{number(1), number(1), number(1), 0.1f}); };
  const Vec3f half{0.5f, 0.2f, 0.9f};
  std::vector<Vec3f> points;
  for (int i = 0; i < 8; ++i)
    points.push_back({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  const Shape3 sought_shape(make_hull(points).value());
  const Convex box = convex_of(Shape3(Box{half})), hull = convex_of(sought_shape);
  int apart = 0, touching = 0;
  for (int k = 0; k < 6000; ++k) {
    const Convex line = convex_of(k % 5 == 0 ? Shape3(Sphere{0.1f}) : Shape3(Capsule3{1.01f + number(1), 0.1f}));
    // Every third lies along an axis of the box, level with its faces.
    const Quatf level = k / 3 % 2 == 0 ? Quatf{1, 0, 0, 0} : Quatf{0.70710678f, 0, 0, 0.70710678f};
    const Transform3f at{vector(0.3), turn()}, b = at * Transform3f{vector(1.2), k % 3 == 0 ? level : turn()};
    CoreDistance sought, found;
    core_distance(Placed(hull, at), Placed(line, b), 1e30, {}, sought);
    core_distance(Placed(box, at), Placed(line, b), 1e30, {}, found);
    if (sought.overlap || sought.distance < 1e-4) {
      ++touching;
      EXPECT_TRUE(found.overlap || found.distance < 2e-4) << k;
      continue;
    }
    ++apart;
    ASSERT_FALSE(found.overlap) << k;
    EXPECT_NEAR(found.distance, sought.distance, 2e-6) << k;
    EXPECT_NEAR(length(found.point_b - found.point_a), found.distance, 2e-6) << k;
    EXPECT_GT(dot(found.normal, sought.normal), 1 - 1e-4) << k;
  }
  EXPECT_GT(apart, 3000);
  EXPECT_GT(touching, 500);
}

void compare_faces(const Shape3& shape, std::uint64_t seed) {
  math::Random random(seed);
  const auto number = [&](double size) { return float(random.uniform(-size, size)); };
  const auto vector = [&](double size) { return Vec3f{number(size), number(size), number(size)}; };
  const Convex core = convex_of(shape);
  int met = 0, cut = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3f p = vector(1), q = p + vector(1.5), r = p + vector(1.5);
    if (length(cross(q - p, r - p)) < 0.05f) continue;
    const Transform3f x{vector(0.8), normalize(Quatf{number(1), number(1), number(1), 0.1f})};
    const Convex triangle = convex_of_triangle(p, q, r);
    const float radius = k % 2 == 0 ? 0 : 0.05f, widen = k % 3 == 0 ? 0.01f : 0, margin = number(0.5);
    Feature face, incident;
    face_feature(triangle, 0, triangle.normal, face);
    feature(core, -inverse_rotate(x.q, triangle.normal), incident);
    for (int i = 0; i < incident.count; ++i) incident.point[i] = transform_point(x, incident.point[i]);
    ContactPoints sought, found;
    clip_to_face(face, 0, incident, radius, margin, 0, sought, widen);
    PlacedCorners(core, x).clip_face(triangle.corner, triangle.normal, radius, margin, widen, found);
    ASSERT_EQ(found.count, sought.count) << k;
    for (int i = 0; i < found.count; ++i) {
      EXPECT_EQ(found.point[i].feature, sought.point[i].feature) << k;
      EXPECT_NEAR(found.point[i].separation, sought.point[i].separation, 1e-5f) << k;
      EXPECT_LT(length(found.point[i].point - sought.point[i].point), 2e-5f) << k;
      cut += found.point[i].feature > 0xff;
    }
    met += found.count > 0;
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(cut, 1000);
}

TEST(TriangleFace, OfABoxIsCutAsByClipping) { compare_faces(Box{{0.5f, 0.2f, 0.9f}}, 4); }

TEST(TriangleFace, OfAPrismIsCutAsByClipping) { compare_faces(prism(7), 5); }

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
