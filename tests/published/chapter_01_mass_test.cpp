// Chapter 1.6 and 1.8: mass, centre of mass, inertia tensors, the composite car.
#include <gtest/gtest.h>

#include "carom/geometry/hull.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_builders.h"

namespace carom::geometry::chapter_01_mass_test {
namespace {

MassProperties3 box_of(double mass, Vec3d size, Vec3d center) {
  const Shape3 shape(Box{Vec3f(size * 0.5), 0});
  MassProperties3 m = mass_properties(shape, 1);
  const double scale = mass / m.mass;
  return {mass, center, scale * m.inertia};
}

// Source: table of composite properties, chapter 1: car, driver and tank as boxes. Tolerance: one unit of the last
// published figure. Shows combination, the parallel axis theorem and principal axes.
TEST(Chapter01Mass, CompositeOfCarDriverAndTank) {
  const MassProperties3 car =
      combine(combine(box_of(1500, {4.0, 1.8, 1.2}, {2, 0, 0.6}), box_of(80, {0.4, 0.5, 0.9}, {2.2, 0.4, 0.8})),
              box_of(50, {0.5, 0.9, 0.3}, {0.8, 0, 0.4}));
  EXPECT_NEAR(car.mass, 1630, 1e-9);
  EXPECT_NEAR(car.center.x, 1.97301, 1e-5);
  EXPECT_NEAR(car.center.y, 0.01963, 1e-5);
  EXPECT_NEAR(car.center.z, 0.60368, 1e-5);
  EXPECT_NEAR(car.inertia(0, 0), 613.166, 1e-3);
  EXPECT_NEAR(car.inertia(1, 1), 2267.074, 1e-3);
  EXPECT_NEAR(car.inertia(2, 2), 2498.334, 1e-3);
  const PrincipalAxes axes = principal_axes(car.inertia);
  EXPECT_NEAR(axes.moments.x, 613.009, 1e-3);
  EXPECT_NEAR(axes.moments.y, 2266.939, 1e-3);
  EXPECT_NEAR(axes.moments.z, 2498.626, 1e-3);
}

// Source: table of shapes, chapter 1.6. The formulas are identities: 1e-6 covers dimensions kept as float.
TEST(Chapter01Mass, TableOfShapes) {
  const double density = 1000, l = 1.4, r = 0.3;
  const auto expect_moments = [](const MassProperties3& m, double axial, double transverse) {
    EXPECT_NEAR(m.inertia(1, 1) / axial, 1, 1e-6);
    EXPECT_NEAR(m.inertia(0, 0) / transverse, 1, 1e-6);
    EXPECT_NEAR(m.inertia(2, 2) / transverse, 1, 1e-6);
  };
  const MassProperties3 cylinder = mass_properties(Shape3(Cylinder{float(l / 2), float(r)}), density);
  EXPECT_NEAR(cylinder.mass / (density * pi * r * r * l), 1, 1e-6);
  expect_moments(cylinder, cylinder.mass * r * r / 2, cylinder.mass * (3 * r * r + l * l) / 12);

  const MassProperties3 sphere = mass_properties(Shape3(Sphere{float(r)}), density);
  EXPECT_NEAR(sphere.mass / (density * 4 / 3 * pi * r * r * r), 1, 1e-6);
  expect_moments(sphere, 0.4 * sphere.mass * r * r, 0.4 * sphere.mass * r * r);

  const MassProperties3 cone = mass_properties(Shape3(Cone{float(l / 2), float(r)}), density);
  EXPECT_NEAR(cone.mass / (density * pi * r * r * l / 3), 1, 1e-6);
  EXPECT_NEAR(cone.center.y, -l / 4, 1e-6);
  expect_moments(cone, 0.3 * cone.mass * r * r, 0.15 * cone.mass * (r * r + l * l / 4));

  const double a = 0.5, b = 0.9, c = 1.3;
  const MassProperties3 box = mass_properties(Shape3(Box{{float(a / 2), float(b / 2), float(c / 2)}, 0}), density);
  EXPECT_NEAR(box.inertia(0, 0) / (box.mass * (b * b + c * c) / 12), 1, 1e-6);
  EXPECT_NEAR(box.inertia(1, 1) / (box.mass * (c * c + a * a) / 12), 1, 1e-6);
  EXPECT_NEAR(box.inertia(2, 2) / (box.mass * (a * a + b * b) / 12), 1, 1e-6);

  // A tube is a cylinder less a cylinder: m(r₁² + r₂²)/2 about its axis.
  MassProperties3 bore = mass_properties(Shape3(Cylinder{float(l / 2), 0.2f}), density);
  const double mass = cylinder.mass - bore.mass;
  EXPECT_NEAR((cylinder.inertia(1, 1) - bore.inertia(1, 1)) / (mass * (r * r + 0.04) / 2), 1, 1e-6);
  EXPECT_NEAR((cylinder.inertia(0, 0) - bore.inertia(0, 0)) / (mass * (3 * r * r + 3 * 0.04 + l * l) / 12), 1, 1e-6);

  // A rod about its end: ml²/3.
  const MassProperties3 rod = mass_properties(Shape3(Cylinder{float(l / 2), 1e-4f}), density);
  EXPECT_NEAR(rod.inertia(0, 0) / (rod.mass * l * l / 12), 1, 1e-6);
  EXPECT_NEAR(transfer_inertia(rod.inertia, rod.mass, {0, l / 2, 0})(0, 0) / (rod.mass * l * l / 3), 1, 1e-6);
}

// An ellipsoid as a closed mesh: m(b² + c²)/5 about the a axis; the mesh of n segments is exact to order n⁻².
TEST(Chapter01Mass, EllipsoidByTheDivergenceTheorem) {
  const double a = 1, b = 2, c = 3;
  Triangles t = make_sphere_mesh(1, 256, 128);
  std::vector<Vec3d> vertices;
  for (const Vec3f& p : t.positions) vertices.push_back(scale(Vec3d(p), Vec3d{a, b, c}));
  const auto m = mesh_mass_properties(vertices, t.indices, 1);
  ASSERT_TRUE(m.ok()) << m.error().message;
  EXPECT_NEAR(m->volume / (4.0 / 3 * pi * a * b * c), 1, 1e-3);
  EXPECT_NEAR(m->properties.inertia(0, 0) / m->properties.mass / ((b * b + c * c) / 5), 1, 1e-3);
  EXPECT_NEAR(m->properties.inertia(1, 1) / m->properties.mass / ((c * c + a * a) / 5), 1, 1e-3);
  EXPECT_NEAR(m->properties.inertia(2, 2) / m->properties.mass / ((a * a + b * b) / 5), 1, 1e-3);
}

// 1.8: trace and determinant do not change under R I Rᵀ, and I_xx + I_yy ≥ I_zz for every solid (identities).
TEST(Chapter01Mass, InvariantsOfTheInertiaTensor) {
  std::uint32_t state = 17;
  const auto draw = [&state] {
    return 2 * double((state = state * 1664525u + 1013904223u) >> 8) / double(1 << 24) - 1;
  };
  for (int k = 0; k < 200; ++k) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 12; ++i) {
      const double x = draw(), y = draw(), z = draw();
      points.push_back({float(x), float(y), float(z)});
    }
    const auto hull = make_hull(points, {.radius = k % 2 ? 0.1f : 0});
    ASSERT_TRUE(hull.ok());
    const Mat3d inertia = mass_properties(Shape3(*hull), 1000).inertia;
    const double w = draw(), x = draw(), y = draw(), z = draw();
    const Mat3d turned = rotate_inertia(inertia, to_matrix(normalize(Quatd{w, x, y, z})));
    EXPECT_NEAR(trace(turned) / trace(inertia), 1, 1e-13);
    EXPECT_NEAR(determinant(turned) / determinant(inertia), 1, 1e-12);
    for (const Mat3d& m : {inertia, turned})
      for (int i = 0; i < 3; ++i)
        EXPECT_GE(m((i + 1) % 3, (i + 1) % 3) + m((i + 2) % 3, (i + 2) % 3), m(i, i) * (1 - 1e-12));
    const PrincipalAxes axes = principal_axes(inertia);
    EXPECT_GE(axes.moments.x + axes.moments.y, axes.moments.z * (1 - 1e-12));
    EXPECT_NEAR((axes.moments.x + axes.moments.y + axes.moments.z) / trace(inertia), 1, 1e-13);
  }
}

}  // namespace
}  // namespace carom::geometry::chapter_01_mass_test
