#include <gtest/gtest.h>

#include <cmath>

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/shape2.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::geometry::shape_test {
namespace {

constexpr float not_a_number = NAN, infinite = INFINITY;

struct Sequence {
  std::uint32_t state;
  double unit() { return double((state = state * 1664525u + 1013904223u) >> 8) / double(1 << 24); }
  double symmetric() { return 2 * unit() - 1; }
  Vec3f in_cube() {
    const double x = symmetric(), y = symmetric(), z = symmetric();
    return {float(x), float(y), float(z)};
  }
  Quatf rotation() {
    const double w = symmetric(), x = symmetric(), y = symmetric(), z = symmetric();
    return normalize(Quatf{float(w), float(x), float(y), float(z)});
  }
};

std::vector<Shape3> convex_shapes() {
  const Vec3f points[] = {{1, 0, 0}, {-1, 0.2f, 0}, {0, 1, 0.3f},      {0, -1, 0},
                          {0, 0, 1}, {0.1f, 0, -1}, {0.7f, 0.7f, 0.7f}};
  return {Sphere{0.7f},
          Capsule3{0.4f, 0.3f},
          Box{{0.3f, 0.5f, 0.9f}, 0},
          Box{{0.3f, 0.5f, 0.9f}, 0.1f},
          Cylinder{0.6f, 0.4f},
          Cylinder{0.6f, 0.4f, 0.15f},
          Cone{0.6f, 0.5f},
          Cone{0.6f, 0.5f, 0.15f},
          make_hull(points).value(),
          make_hull(points, {.radius = 0.2f}).value()};
}
std::vector<Shape2> convex_shapes2() {
  const Vec2f points[] = {{1, 0}, {0.5f, 0.8f}, {-0.6f, 0.7f}, {-1, -0.3f}, {0.2f, -0.9f}};
  return {Circle{0.7f},
          Capsule2{0.4f, 0.3f},
          make_polygon(points).value(),
          make_polygon(points, 0.2f).value(),
          make_box2({0.4f, 0.8f}, 0.1f, {{0.3f, 0.1f}, {0.8f, 0.6f}}),
          Segment{{-0.3f, 0.2f}, {0.5f, -0.7f}}};
}

// The bounds of a convex set are its support values along the axes.
TEST(ShapeTest, BoundsAreTheSupportAlongTheAxes3) {
  Sequence random{1};
  for (const Shape3& shape : convex_shapes())
    for (int k = 0; k < 50; ++k) {
      const Transform3f t{random.in_cube(), random.rotation()};
      const Bounds3f b = bounds(shape, t);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3f d{};
        d[axis] = 1;
        EXPECT_NEAR(b.high[axis], transform_point(t, support(shape, inverse_rotate(t.q, d)))[axis], 2e-6);
        EXPECT_NEAR(b.low[axis], transform_point(t, support(shape, inverse_rotate(t.q, -d)))[axis], 2e-6);
      }
    }
}
TEST(ShapeTest, BoundsAreTheSupportAlongTheAxes2) {
  Sequence random{2};
  for (const Shape2& shape : convex_shapes2())
    for (int k = 0; k < 50; ++k) {
      const double angle = 7 * random.unit(), x = random.symmetric(), y = random.symmetric();
      const Transform2f t{{float(x), float(y)}, {float(std::cos(angle)), float(std::sin(angle))}};
      const Bounds2f b = bounds(shape, t);
      EXPECT_NEAR(b.high.x, transform_point(t, support(shape, inverse_rotate(t.q, Vec2f{1, 0}))).x, 2e-6);
      EXPECT_NEAR(b.low.x, transform_point(t, support(shape, inverse_rotate(t.q, Vec2f{-1, 0}))).x, 2e-6);
      EXPECT_NEAR(b.high.y, transform_point(t, support(shape, inverse_rotate(t.q, Vec2f{0, 1}))).y, 2e-6);
      EXPECT_NEAR(b.low.y, transform_point(t, support(shape, inverse_rotate(t.q, Vec2f{0, -1}))).y, 2e-6);
    }
}

// Of a polygon they are the least and the greatest of its corners, to the last bit, however many it has.
TEST(ShapeTest, BoundsOfAPolygonAreThoseOfItsCorners) {
  Sequence random{4};
  for (int count = 3; count <= max_polygon_vertices; ++count) {
    std::vector<Vec2f> points;
    for (int i = 0; i < count; ++i) {
      const double angle = 6.283185307179586 * (i + 0.3 * random.unit()) / count;
      points.push_back({float(std::cos(angle)), float(std::sin(angle))});
    }
    const Polygon polygon = make_polygon(points, 0.1f).value();
    ASSERT_EQ(polygon.count, count);
    for (int k = 0; k < 50; ++k) {
      const double angle = 7 * random.unit(), x = random.symmetric(), y = random.symmetric();
      const Transform2f t{{float(x), float(y)}, {float(std::cos(angle)), float(std::sin(angle))}};
      Vec2f low{infinite, infinite}, high = -low;
      for (int i = 0; i < count; ++i) {
        const Vec2f corner = transform_point(t, polygon.vertices[i]);
        low = min(low, corner), high = max(high, corner);
      }
      EXPECT_EQ(bounds(Shape2(polygon), t).low, low - Vec2f(0.1f, 0.1f));
      EXPECT_EQ(bounds(Shape2(polygon), t).high, high + Vec2f(0.1f, 0.1f));
    }
  }
}

// h(d) = max x·d is convex and positively homogeneous: h(a + b) ≤ h(a) + h(b).
TEST(ShapeTest, SupportFunctionIsSubadditive) {
  Sequence random{3};
  for (const Shape3& shape : convex_shapes())
    for (int k = 0; k < 200; ++k) {
      const Vec3f a = random.in_cube(), b = random.in_cube();
      const auto h = [&shape](Vec3f d) { return dot(support(shape, d), d); };
      EXPECT_LE(h(a + b), h(a) + h(b) + 1e-5f);
      EXPECT_NEAR(h(a * 3.0f), 3 * h(a), 1e-5);
    }
}

TEST(ShapeTest, SupportOfKnownShapes) {
  EXPECT_EQ(support(Shape3(Box{{1, 2, 3}, 0}), {1, -1, 1}), (Vec3f{1, -2, 3}));
  EXPECT_EQ(support(Shape3(Cylinder{2, 1}), {3, 1, 0}), (Vec3f{1, 2, 0}));
  EXPECT_EQ(support(Shape3(Cone{1, 1}), {0, 1, 0}), (Vec3f{0, 1, 0}));
  EXPECT_EQ(support(Shape3(Cone{1, 1}), {5, 1, 0}), (Vec3f{1, -1, 0}));
  EXPECT_EQ(support(Shape3(Capsule3{1, 0.5f}), {0, -2, 0}), (Vec3f{0, -1.5f, 0}));
  EXPECT_EQ(support(Shape2(Capsule2{1, 0.5f}), {2, 0}), (Vec2f{0.5f, 1}));
}

TEST(ShapeTest, ValidateNamesTheField) {
  const auto message = [](const auto& shape) {
    const core::Status s = validate(shape);
    return s.ok() ? std::string() : s.error().message;
  };
  for (const float bad : {0.0f, -1.0f, not_a_number, infinite, -infinite, 1e30f, 1e-30f}) {
    EXPECT_NE(message(Shape3(Sphere{bad})).find("sphere.radius"), std::string::npos) << bad;
    EXPECT_NE(message(Shape3(Capsule3{1, bad})).find("capsule.radius"), std::string::npos) << bad;
    EXPECT_NE(message(Shape3(Box{{1, bad, 1}, 0})).find("box.half_extents"), std::string::npos) << bad;
    EXPECT_NE(message(Shape3(Cylinder{bad, 1})).find("cylinder.half_height"), std::string::npos) << bad;
    EXPECT_NE(message(Shape3(Cone{1, bad})).find("cone.radius"), std::string::npos) << bad;
    if (!(bad >= 0 && bad < 1)) {
      EXPECT_NE(message(Shape3(Cone{1, 1, bad})).find("cone.rounding"), std::string::npos) << bad;
    }
    EXPECT_NE(message(Shape2(Circle{bad})).find("circle.radius"), std::string::npos) << bad;
    EXPECT_NE(message(Shape2(Capsule2{1, bad})).find("capsule.radius"), std::string::npos) << bad;
  }
  EXPECT_NE(message(Shape3(Box{{1, 1, 1}, -0.1f})).find("box.radius"), std::string::npos);
  EXPECT_NE(message(Shape3(Capsule3{not_a_number, 1})).find("capsule.half_length"), std::string::npos);
  EXPECT_NE(message(Shape3(Plane{{0, 2, 0}})).find("plane.normal"), std::string::npos);
  EXPECT_NE(message(Shape3(Plane{{0, not_a_number, 0}})).find("plane.normal"), std::string::npos);
  EXPECT_NE(message(Shape3(std::shared_ptr<const Hull>())).find("hull"), std::string::npos);
  EXPECT_NE(message(Shape3(std::shared_ptr<const TriangleMesh>())).find("mesh"), std::string::npos);
  EXPECT_NE(message(Shape2(std::shared_ptr<const Chain>())).find("chain"), std::string::npos);
  EXPECT_NE(message(Shape2(Segment{{1, 1}, {1, 1}})).find("segment"), std::string::npos);
  EXPECT_NE(message(Shape2(Polygon{})).find("polygon.count"), std::string::npos);
  Polygon box = make_box2({1, 1});
  EXPECT_EQ(message(Shape2(box)), "");
  box.vertices[2] = {-0.9f, -0.9f};
  EXPECT_NE(message(Shape2(box)).find("convex"), std::string::npos);
  for (const Shape3& s : convex_shapes()) EXPECT_EQ(message(s), "");
  for (const Shape2& s : convex_shapes2()) EXPECT_EQ(message(s), "");
}

TEST(ShapeTest, PolygonIsTheHullOfItsPoints) {
  const Vec2f points[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 0.5f}, {0.5f, 0}, {1, 1}, {0.999999f, 1}, {0, 0.3f}};
  const auto polygon = make_polygon(points);
  ASSERT_TRUE(polygon.ok());
  EXPECT_EQ(polygon->count, 4);
  EXPECT_NEAR(polygon->centroid.x, 0.5, 1e-6);
  EXPECT_NEAR(polygon->centroid.y, 0.5, 1e-6);
  EXPECT_TRUE(validate(Shape2(*polygon)).ok());
  Sequence random{4};
  for (const float scale : {1e-4f, 1.0f, 1e6f})
    for (int k = 0; k < 500; ++k) {
      std::vector<Vec2f> cloud;
      const int n = 3 + int(random.unit() * 6);
      for (int i = 0; i < n; ++i) {
        const double x = random.symmetric(), y = random.symmetric();
        cloud.push_back({scale * float(x), scale * float(y)});
      }
      const auto hull = make_polygon(cloud);
      ASSERT_TRUE(hull.ok()) << hull.error().message;
      EXPECT_TRUE(validate(Shape2(*hull)).ok()) << validate(Shape2(*hull)).error().message;
      for (const Vec2f& p : cloud)
        for (int i = 0; i < hull->count; ++i) EXPECT_LE(dot(hull->normals[i], p - hull->vertices[i]), 4e-5f * scale);
    }
}

TEST(ShapeTest, PolygonErrors) {
  const auto message = [](std::vector<Vec2f> points) {
    const auto p = make_polygon(points);
    return p.ok() ? std::string() : p.error().message;
  };
  EXPECT_NE(message({{0, 0}, {1, 0}}).find("at least 3"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 1}, {2, 2}, {3, 3}}).find("one line"), std::string::npos);
  EXPECT_NE(message({{1, 1}, {1, 1}, {1, 1}}).find("one line"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 0}, {0, not_a_number}}).find("finite"), std::string::npos);
  std::vector<Vec2f> circle;
  for (int i = 0; i < 9; ++i) circle.push_back({float(std::cos(i * 0.7)), float(std::sin(i * 0.7))});
  EXPECT_NE(message(circle).find("9 corners"), std::string::npos);
}

TEST(ShapeTest, ChainSegmentsKnowTheirNeighbours) {
  const auto open = make_chain({{0, 0}, {1, 0}, {2, 1}}, false).value();
  EXPECT_EQ(open->segment_count(), 2);
  EXPECT_EQ(open->segment(0).ghost_before, (Vec2f{-1, 0}));
  EXPECT_EQ(open->segment(0).ghost_after, (Vec2f{2, 1}));
  EXPECT_EQ(open->segment(1).ghost_after, (Vec2f{3, 2}));
  const auto loop = make_chain({{0, 0}, {1, 0}, {0, 1}}, true).value();
  EXPECT_EQ(loop->segment_count(), 3);
  EXPECT_EQ(loop->segment(0).ghost_before, (Vec2f{0, 1}));
  EXPECT_EQ(loop->segment(2).b, (Vec2f{0, 0}));
  EXPECT_EQ(loop->segment(2).ghost_after, (Vec2f{1, 0}));
  EXPECT_FALSE(make_chain({{0, 0}}, false).ok());
  EXPECT_FALSE(make_chain({{0, 0}, {1, 0}}, true).ok());
  EXPECT_FALSE(make_chain({{0, 0}, {0.0005f, 0}}, false).ok());
  EXPECT_FALSE(make_chain({{0, 0}, {not_a_number, 0}}, false).ok());
}

TEST(ShapeTest, TriangleMeshKnowsFlatConvexAndOpenEdges) {
  // Two triangles of a flat square, then a wall down from its far side (convex) and one up from its near side
  // (concave).
  const std::vector<Vec3f> v = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}, {0.5f, -1, -1}, {0.5f, 1, 0}};
  const auto mesh = make_triangle_mesh(v, {0, 1, 2, 0, 2, 3, 3, 2, 4, 1, 0, 5}).value();
  ASSERT_EQ(mesh->triangle_count(), 4);
  EXPECT_EQ(mesh->edge_flags[0], edge0_flat | edge1_open | edge2_flat);  // concave wall, open side, diagonal
  EXPECT_EQ(mesh->edge_flags[1], edge0_flat | edge2_open);               // diagonal; edge 1 is the convex one
  EXPECT_EQ(mesh->edge_flags[2], edge1_open | edge2_open);
  EXPECT_EQ(mesh->edge_flags[3], edge0_flat | edge1_open | edge2_open);
  EXPECT_FALSE(make_triangle_mesh(v, {0, 1, 9}).ok());
  EXPECT_FALSE(make_triangle_mesh(v, {0, 1}).ok());
  EXPECT_FALSE(make_triangle_mesh(v, {0, 1, 1, 0, 0, 2}).ok());
  EXPECT_FALSE(make_triangle_mesh({{0, 0, 0}, {1, 0, 0}, {0, infinite, 0}}, {0, 1, 2}).ok());
  EXPECT_EQ(make_triangle_mesh(v, {0, 1, 1, 0, 1, 2}).value()->triangle_count(), 1);
}

TEST(ShapeTest, HeightFieldErrors) {
  EXPECT_TRUE(make_height_field(2, 2, {1, 1}, {0, 1, 2, 3}).ok());
  EXPECT_EQ(make_height_field(2, 2, {1, 1}, {0, -1, 2, 3}).value()->low, -1);
  EXPECT_FALSE(make_height_field(1, 2, {1, 1}, {0, 1}).ok());
  EXPECT_FALSE(make_height_field(2, 2, {0, 1}, {0, 1, 2, 3}).ok());
  EXPECT_FALSE(make_height_field(2, 2, {1, 1}, {0, 1, 2}).ok());
  EXPECT_FALSE(make_height_field(2, 2, {1, 1}, {0, 1, 2, not_a_number}).ok());
  EXPECT_FALSE(make_height_field(2, 2, {1, 1}, {0, 1, 2, 3}, {0, 0}).ok());
  EXPECT_FALSE(make_height_field(2000000000, 2000000000, {1, 1}, {}).ok());
}

TEST(ShapeTest, CompoundErrorsNameTheChild) {
  EXPECT_FALSE(make_compound({}).ok());
  const auto bad = make_compound({{Sphere{1}, {}}, {Plane{}, {}}});
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("child 1"), std::string::npos);
  EXPECT_FALSE(make_compound({{Sphere{-1}, {}}}).ok());
  EXPECT_FALSE(make_compound({{Sphere{1}, {{not_a_number, 0, 0}, {}}}}).ok());
  EXPECT_FALSE(make_compound({{Sphere{1}, {{}, {0, 0, 0, 0}}}}).ok());
  const Shape3 two(make_compound({{Sphere{1}, {{2, 0, 0}, {}}}, {Sphere{0.5f}, {{-1, 3, 0}, {}}}}).value());
  const Bounds3f b = bounds(two, {{10, 0, 0}, {}});
  EXPECT_EQ(b.low, (Vec3f{8.5f, -1, -1}));
  EXPECT_EQ(b.high, (Vec3f{13, 3.5f, 1}));
}

TEST(ShapeTest, PlaneBoundsAreOneSidedOnlyWhereAxisAligned) {
  const Bounds3f flat = bounds(Shape3(Plane{}), {{1, 2, 3}, {}});
  EXPECT_EQ(flat.high.y, 2);
  EXPECT_EQ(flat.low.y, -infinite);
  EXPECT_EQ(flat.high.x, infinite);
  EXPECT_EQ(bounds(Shape3(Plane{{0.6f, 0.8f, 0}}), {}).high.y, infinite);
}

}  // namespace
}  // namespace carom::geometry::shape_test
