// Mass properties by closed formulas against independent ones: sums over fine meshes, the parallel axis theorem, and
// each other.
#include "carom/geometry/mass_properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/mesh_builders.h"

namespace carom::geometry::mass_test {
namespace {

struct Sequence {
  std::uint32_t state;
  double unit() { return double((state = state * 1664525u + 1013904223u) >> 8) / double(1 << 24); }
  double symmetric() { return 2 * unit() - 1; }
  Vec3d in_cube() {
    const double x = symmetric(), y = symmetric(), z = symmetric();
    return {x, y, z};
  }
  Quatd rotation() {
    const double w = symmetric(), x = symmetric(), y = symmetric(), z = symmetric();
    return normalize(Quatd{w, x, y, z});
  }
};

void expect_near(const Mat3d& a, const Mat3d& b, double tolerance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(a(i, j), b(i, j), tolerance) << i << j;
}
void expect_same(const MassProperties3& a, const MassProperties3& b, double relative) {
  EXPECT_NEAR(a.mass / b.mass, 1, relative);
  EXPECT_NEAR(distance(a.center, b.center), 0, relative * math::sqrt(trace(b.inertia) / b.mass));
  expect_near(a.inertia, b.inertia, relative * trace(b.inertia));
}

std::vector<Vec3d> in_double(const Triangles& t) {
  std::vector<Vec3d> v;
  for (const Vec3f& p : t.positions) v.push_back(Vec3d(p));
  return v;
}
MeshMass mesh_mass(const Triangles& t, double density) {
  const auto m = mesh_mass_properties(in_double(t), t.indices, density);
  EXPECT_TRUE(m.ok()) << m.error().message;
  return m.ok() ? *m : MeshMass{};
}

Vec3f rock[] = {{1, 0, 0}, {-1, 0.2f, 0}, {0, 1, 0.3f}, {0, -1, 0}, {0, 0, 1}, {0.1f, 0, -1}, {0.7f, 0.7f, 0.7f}};

// Every shape against the divergence theorem over the triangles that are drawn for it. The mesh of a curved shape of n
// segments lies inside it, with an error of order n⁻²; extrapolating from n and n/2 leaves n⁻⁴.
TEST(MassTest, ShapesAgreeWithTheirTriangles) {
  const Shape3 shapes[] = {
      Sphere{0.7f},           Capsule3{0.4f, 0.3f},          Box{{0.3f, 0.5f, 0.9f}, 0},  Cylinder{0.6f, 0.4f},
      Cone{0.6f, 0.5f},       Ellipsoid{{0.3f, 0.5f, 0.9f}}, Cylinder{0.6f, 0.4f, 0.25f}, Cone{0.6f, 0.4f, 0.25f},
      make_hull(rock).value()};
  for (const Shape3& shape : shapes) {
    const MassProperties3 exact = mass_properties(shape, 700);
    const MassProperties3 fine = mesh_mass(to_triangles(shape, 256), 700).properties;
    const MassProperties3 coarse = mesh_mass(to_triangles(shape, 128), 700).properties;
    const auto limit = [](double f, double c) { return f + (f - c) / 3; };
    EXPECT_NEAR(limit(fine.mass, coarse.mass) / exact.mass, 1, 2e-6);
    EXPECT_NEAR(limit(fine.center.y, coarse.center.y), exact.center.y, 2e-6);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(limit(fine.inertia(i, i), coarse.inertia(i, i)) / exact.inertia(i, i), 1, 4e-6) << int(shape.type);
  }
}

// Steiner: V(K + rB) = V + S r + M r² + 4/3 π r³; for a box with edges a, b, c: S = 2(ab + bc + ca), M = π(a + b + c).
TEST(MassTest, RoundedBoxHasSteinersVolume) {
  const double a = 0.6, b = 1.0, c = 1.8, r = 0.2;
  const MassProperties3 m = mass_properties(Shape3(Box{{0.3f, 0.5f, 0.9f}, 0.2f}), 1);
  const double steiner =
      a * b * c + 2 * (a * b + b * c + c * a) * r + pi * (a + b + c) * r * r + 4.0 / 3 * pi * r * r * r;
  EXPECT_NEAR(m.mass, steiner, 1e-7);
}

// For a cone of base a, height H and side L, whose side's normal rises by α = asin(a/L): S = πa² + πaL,
// M = πa(π/2 + α) + πH. Swept from next to nothing it is a ball.
TEST(MassTest, RoundedConeHasSteinersVolume) {
  const double a = double(0.4f), h = 2 * double(0.6f), r = 0.25, side = math::sqrt(a * a + h * h);
  const MassProperties3 m = mass_properties(Shape3(Cone{0.6f, 0.4f, 0.25f}), 1);
  const double steiner = pi * a * a * h / 3 + pi * a * (a + side) * r +
                         (pi * a * (pi / 2 + math::asin(a / side)) + pi * h) * r * r + 4.0 / 3 * pi * r * r * r;
  EXPECT_NEAR(m.mass, steiner, 1e-7);
  const MassProperties3 ball = mass_properties(Shape3(Cone{1e-4f, 1e-4f, 1}), 1);
  EXPECT_NEAR(ball.mass / (4.0 / 3 * pi), 1, 1e-3);
  EXPECT_NEAR(ball.inertia(0, 0) / (8.0 / 15 * pi), 1, 1e-3);
  EXPECT_NEAR(ball.inertia(1, 1) / (8.0 / 15 * pi), 1, 1e-3);
  const MassProperties3 sharp = mass_properties(Shape3(Cone{0.6f, 0.4f}), 1),
                        nearly = mass_properties(Shape3(Cone{0.6f, 0.4f, 1e-5f}), 1);
  EXPECT_NEAR(nearly.mass, sharp.mass, 3e-5);
  EXPECT_NEAR(nearly.center.y, sharp.center.y, 2e-5);
  EXPECT_NEAR(nearly.inertia(0, 0), sharp.inertia(0, 0), 2e-5);
}

// The same for a cylinder of radius a and height 2h: S = 2πa² + 4πah, M = π²a + 2πh. Swept from a disc so thin that it
// is none, it is a torus with its hole filled; swept from a point, a ball.
TEST(MassTest, RoundedCylinderHasSteinersVolume) {
  const double a = double(0.4f), h = double(0.6f), r = 0.25;
  const MassProperties3 m = mass_properties(Shape3(Cylinder{0.6f, 0.4f, 0.25f}), 1);
  const double steiner = 2 * pi * a * a * h + (2 * pi * a * a + 4 * pi * a * h) * r +
                         (pi * pi * a + 2 * pi * h) * r * r + 4.0 / 3 * pi * r * r * r;
  EXPECT_NEAR(m.mass, steiner, 1e-7);
  const MassProperties3 ball = mass_properties(Shape3(Cylinder{1e-4f, 1e-4f, 1}), 1);
  EXPECT_NEAR(ball.mass / (4.0 / 3 * pi), 1, 1e-3);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(ball.inertia(i, i) / (8.0 / 15 * pi), 1, 1e-3) << i;
}

// The general rounded hull (faces, edges and corners by exact integrals) against the rounded box's own formula.
TEST(MassTest, RoundedHullOfABoxIsTheRoundedBox) {
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.3f : -0.3f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.9f : -0.9f});
  for (const float r : {0.001f, 0.1f, 0.7f, 10.0f})
    expect_same(mass_properties(Shape3(make_hull(corners, {.radius = r}).value()), 3),
                mass_properties(Shape3(Box{{0.3f, 0.5f, 0.9f}, r}), 3), 1e-6);
}

TEST(MassTest, RoundedHullAgreesWithItsTriangles) {
  const Shape3 shape(make_hull(rock, {.radius = 0.3f}).value());
  const MassProperties3 exact = mass_properties(shape, 2);
  const MeshMass mesh = mesh_mass(to_triangles(shape, 64), 2);
  EXPECT_EQ(mesh.components, 1);
  expect_same(mesh.properties, exact, 3e-3);
  // A hull drowned in its radius is a ball.
  const MassProperties3 ball = mass_properties(Shape3(Sphere{1000}), 2);
  const MassProperties3 drowned = mass_properties(Shape3(make_hull(rock, {.radius = 1000}).value()), 2);
  EXPECT_NEAR(drowned.mass / ball.mass, 1, 4e-3);
  EXPECT_NEAR(drowned.inertia(0, 0) / ball.inertia(0, 0), 1, 7e-3);
}

TEST(MassTest, RoundedPolygonAgreesWithItsOutline) {
  const Vec2f points[] = {{1, 0}, {0.5f, 0.8f}, {-0.6f, 0.7f}, {-1, -0.3f}, {0.2f, -0.9f}};
  for (const float r : {0.0f, 0.3f, 2.0f}) {
    const Shape2 shape(make_polygon(points, r).value());
    const MassProperties2 exact = mass_properties(shape, 5);
    // The outline as a polygon of many corners, integrated by Green's theorem.
    const auto integrate = [&shape](int detail) {
      const Outline outline = to_outline(shape, detail);
      double area = 0, second = 0;
      Vec2d first{};
      for (std::size_t i = 0; i < outline.points.size(); ++i) {
        const Vec2d a(outline.points[i]), b(outline.points[(i + 1) % outline.points.size()]);
        const double w = cross(a, b);
        area += w / 2, first += (a + b) * (w / 6), second += w / 12 * (dot(a, a) + dot(a, b) + dot(b, b));
      }
      return MassProperties2{5 * area, first / area, 5 * (second - dot(first, first) / area)};
    };
    const MassProperties2 fine = integrate(256);
    EXPECT_NEAR(fine.mass / exact.mass, 1, 2e-4);
    EXPECT_NEAR(fine.center.x, exact.center.x, 1e-4);
    EXPECT_NEAR(fine.center.y, exact.center.y, 1e-4);
    EXPECT_NEAR(fine.inertia / exact.inertia, 1, 4e-4);
    EXPECT_LE(fine.mass, exact.mass * (1 + 1e-6));
  }
  // A square drowned in its radius is a disc; a box of radius r has Steiner's area.
  const MassProperties2 box = mass_properties(Shape2(make_box2({1, 0.5f}, 0.25f)), 1);
  EXPECT_NEAR(box.mass, 2 + 6 * 0.25 + pi * 0.0625, 1e-7);
}

TEST(MassTest, ShapesOfThePlane) {
  const MassProperties2 disc = mass_properties(Shape2(Circle{2}), 3);
  EXPECT_NEAR(disc.mass, 12 * pi, 1e-12);
  EXPECT_NEAR(disc.inertia, disc.mass * 2, 1e-12);
  const MassProperties2 box = mass_properties(Shape2(make_box2({1, 2}, 0, {{5, 6}, {0.6f, 0.8f}})), 3);
  EXPECT_NEAR(box.mass, 24, 1e-4);
  EXPECT_NEAR(box.inertia, 24 * (4 + 16) / 12.0, 1e-4);
  EXPECT_NEAR(box.center.x, 5, 1e-6);
  // A capsule is a rounded segment: a very thin rounded box comes to the same.
  const MassProperties2 capsule = mass_properties(Shape2(Capsule2{1, 0.5f}), 1);
  const MassProperties2 thin = mass_properties(Shape2(make_box2({1e-4f, 1}, 0.5f)), 1);
  EXPECT_NEAR(capsule.mass, thin.mass, 1e-3);
  EXPECT_NEAR(capsule.inertia, thin.inertia, 1e-3);
  EXPECT_EQ(mass_properties(Shape2(Segment{{0, 0}, {1, 0}}), 3).mass, 0);
}

TEST(MassTest, CompoundIsTheSumOfItsPartsInPlace) {
  Sequence random{8};
  const Transform3d a{random.in_cube(), random.rotation()}, b{random.in_cube(), random.rotation()};
  const auto narrow = [](const Transform3d& t) {
    return Transform3f{Vec3f(t.p), {float(t.q.w), float(t.q.x), float(t.q.y), float(t.q.z)}};
  };
  const Shape3 box(Box{{1, 2, 3}, 0}), cone(Cone{1, 0.5f});
  const Shape3 both(make_compound({{box, narrow(a)}, {cone, narrow(b)}}).value());
  expect_same(mass_properties(both, 10),
              combine(transform(mass_properties(box, 10), a), transform(mass_properties(cone, 10), b)), 1e-6);
}

// Cutting a box in two and putting it together again (parallel axis theorem).
TEST(MassTest, TwoHalvesMakeTheWhole) {
  const MassProperties3 half = mass_properties(Shape3(Box{{0.5f, 2, 3}, 0}), 10);
  const MassProperties3 sum = combine(transform(half, {{-0.5, 0, 0}, {}}), transform(half, {{0.5, 0, 0}, {}}));
  expect_same(sum, mass_properties(Shape3(Box{{1, 2, 3}, 0}), 10), 1e-14);
  EXPECT_EQ(combine(MassProperties3{}, half).mass, half.mass);
  EXPECT_EQ(combine(MassProperties3{}, MassProperties3{}).mass, 0);
}

// Mass ∝ s³, inertia ∝ s⁵.
TEST(MassTest, ScalingLaw) {
  const double s = 2;
  const auto hull = [](float scale, float radius) {
    std::vector<Vec3f> points;
    for (const Vec3f& p : rock) points.push_back(p * scale);
    return mass_properties(Shape3(make_hull(points, {.radius = radius}).value()), 7);
  };
  const MassProperties3 one = hull(1, 0.25f), two = hull(2, 0.5f);
  EXPECT_NEAR(two.mass / one.mass, s * s * s, 1e-6);
  expect_near(two.inertia, s * s * s * s * s * one.inertia, 1e-5 * trace(two.inertia));
}

TEST(MassTest, PrincipalAxesDiagonaliseTheTensor) {
  Sequence random{21};
  for (int k = 0; k < 100; ++k) {
    const Mat3d r = to_matrix(random.rotation());
    const Vec3d moments{1 + random.unit(), 2 + random.unit(), 3 + 0.5 * random.unit()};
    const Mat3d inertia = rotate_inertia(Mat3d::diagonal(moments), r);
    const PrincipalAxes axes = principal_axes(inertia);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(axes.moments[i], moments[i], 1e-13 * 10);
    expect_near(rotate_inertia(Mat3d::diagonal(axes.moments), to_matrix(axes.rotation)), inertia, 1e-13);
  }
}

// ---- Closed meshes

std::string message(const Triangles& t, double density = 1000) {
  const auto m = mesh_mass_properties(in_double(t), t.indices, density);
  return m.ok() ? std::string() : m.error().message;
}
Triangles moved(Triangles t, Vec3f by) {
  for (Vec3f& p : t.positions) p += by;
  return t;
}
Triangles turned_inside_out(Triangles t) {
  for (std::size_t i = 0; i < t.indices.size(); i += 3) std::swap(t.indices[i], t.indices[i + 1]);
  return t;
}
Triangles joined(Triangles a, const Triangles& b) {
  const std::uint32_t base = std::uint32_t(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const std::uint32_t i : b.indices) a.indices.push_back(base + i);
  return a;
}
Triangles without_shared_vertices(const Triangles& t) {
  Triangles soup;
  for (const std::uint32_t i : t.indices) {
    soup.indices.push_back(std::uint32_t(soup.positions.size()));
    soup.positions.push_back(t.positions[i]);
  }
  return soup;
}

TEST(MeshMassTest, TorusByPappus) {
  const auto m = mesh_mass(make_torus_mesh(3, 1, 512, 256), 2);
  EXPECT_NEAR(m.volume, 2 * pi * pi * 3 * 1, 1e-2);
  EXPECT_NEAR(m.area, 4 * pi * pi * 3, 1e-2);
  EXPECT_NEAR(m.properties.inertia(2, 2) / m.properties.mass, 9 + 0.75, 2e-3);     // m(R² + ¾ r²) about the axis
  EXPECT_NEAR(m.properties.inertia(0, 0) / m.properties.mass, 4.5 + 0.625, 2e-3);  // m(½R² + ⅝ r²)
}

TEST(MeshMassTest, FarFromTheOriginNothingIsLost) {
  const Triangles box = make_box_mesh({1, 2, 3});
  std::vector<Vec3d> far = in_double(box);
  for (Vec3d& p : far) p += Vec3d{1e9, -2e9, 3e9};
  const auto m = mesh_mass_properties(far, box.indices, 1000);
  ASSERT_TRUE(m.ok()) << m.error().message;
  EXPECT_NEAR(m->properties.mass, 48000, 1e-6);
  expect_near(m->properties.inertia, Mat3d::diagonal(Vec3d{13, 10, 5} * 16000.0), 1e-4);
  EXPECT_NEAR(m->properties.center.x, 1e9, 1e-6);
}

TEST(MeshMassTest, SoupIsWelded) {
  const Triangles sphere = make_sphere_mesh(1, 40, 20);
  const MeshMass whole = mesh_mass(sphere, 1);
  Triangles soup = without_shared_vertices(sphere);
  EXPECT_DOUBLE_EQ(mesh_mass(soup, 1).volume, whole.volume);
  EXPECT_EQ(mesh_mass(soup, 1).components, 1);
  Sequence random{6};
  for (Vec3f& p : soup.positions) p += Vec3f(random.in_cube() * 3e-7);
  const MeshMass shaken = mesh_mass(soup, 1);
  EXPECT_NEAR(shaken.volume, whole.volume, 1e-5);
  EXPECT_EQ(shaken.components, 1);
}

TEST(MeshMassTest, CavityIsTakenOff) {
  const Triangles shell = joined(make_box_mesh({2, 2, 2}), turned_inside_out(make_box_mesh({1, 1, 1})));
  const MeshMass m = mesh_mass(shell, 1);
  EXPECT_DOUBLE_EQ(m.volume, 64 - 8);
  EXPECT_EQ(m.components, 2);
  EXPECT_EQ(m.cavities, 1);
  EXPECT_NEAR(m.properties.inertia(0, 0), 64 * 8.0 / 3 - 8 * 2.0 / 3, 1e-12);
  const MeshMass twice = mesh_mass(joined(make_box_mesh({2, 2, 2}), make_box_mesh({1, 1, 1})), 1);
  EXPECT_EQ(twice.overlapping, 1);
  EXPECT_EQ(twice.cavities, 0);
  const Triangles outside =
      joined(make_box_mesh({2, 2, 2}), moved(turned_inside_out(make_box_mesh({1, 1, 1})), {9, 0, 0}));
  EXPECT_NE(message(outside).find("piece 2 of 2"), std::string::npos) << message(outside);
}

TEST(MeshMassTest, TwoBoxesThatShareAnEdgeAreStillASolid) {
  Triangles two = joined(make_box_mesh({1, 1, 1}), moved(make_box_mesh({1, 1, 1}), {2, 2, 0}));
  const MeshMass m = mesh_mass(two, 1);
  EXPECT_DOUBLE_EQ(m.volume, 16);
  EXPECT_EQ(m.non_manifold_edges, 1);
}

TEST(MeshMassTest, DefectsAreNamedNotIntegrated) {
  Triangles box = make_box_mesh({1, 2, 3});
  EXPECT_EQ(message(box), "");
  EXPECT_NE(message(turned_inside_out(box)).find("inside out"), std::string::npos);
  EXPECT_NE(message(box, -1).find("density"), std::string::npos);
  EXPECT_NE(message(box, NAN).find("density"), std::string::npos);

  Triangles open = box;
  open.indices.resize(open.indices.size() - 3);
  EXPECT_NE(message(open).find("3 open edges"), std::string::npos) << message(open);

  Triangles flipped = box;
  std::swap(flipped.indices[0], flipped.indices[1]);
  EXPECT_NE(message(flipped).find("3 edges whose two triangles are wound against"), std::string::npos)
      << message(flipped);

  Triangles fin = box;
  fin.indices.insert(fin.indices.end(), {0, 1, 7});
  EXPECT_FALSE(message(fin).empty());
  Triangles doubled = box;
  doubled.indices.insert(doubled.indices.end(), doubled.indices.begin(), doubled.indices.begin() + 3);
  EXPECT_NE(message(doubled).find("more triangles one way"), std::string::npos) << message(doubled);

  Triangles index = box;
  index.indices[4] = 8;
  EXPECT_NE(message(index).find("vertex 8 of 8"), std::string::npos) << message(index);
  index.indices.pop_back();
  EXPECT_NE(message(index).find("three a triangle"), std::string::npos);
  Triangles nan = box;
  nan.positions[3].y = NAN;
  EXPECT_NE(message(nan).find("vertex 3"), std::string::npos);

  Triangles flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 1}};
  EXPECT_NE(message(flat).find("no volume"), std::string::npos) << message(flat);
  Triangles nothing{{{0, 0, 0}}, {0, 0, 0}};
  EXPECT_NE(message(nothing).find("no triangle"), std::string::npos) << message(nothing);
  EXPECT_FALSE(message({}).empty());
}

TEST(MeshBuildersTest, EveryBuilderMakesAClosedSolid) {
  EXPECT_NEAR(mesh_mass(make_box_mesh({1, 2, 3}), 1).volume, 48, 1e-12);
  EXPECT_NEAR(mesh_mass(make_sphere_mesh(1, 128, 64), 1).volume, 4.0 / 3 * pi, 6e-3);
  EXPECT_NEAR(mesh_mass(make_prism_mesh(2, 0.5f, 6), 1).volume, 1.5 * std::sqrt(3.0) * 4, 1e-5);
  const Vec2f profile[] = {{1, -1}, {2, 0}, {0.5f, 1}};
  EXPECT_GT(mesh_mass(make_lathe_mesh(profile, 12), 1).volume, 5);
  const Triangles hill = make_terrain_mesh(4, 3, {2, 1}, [](int i, int j) { return i * j; });
  EXPECT_EQ(hill.positions.size(), 20u);
  EXPECT_EQ(hill.indices.size(), 72u);
  EXPECT_EQ(hill.positions.back(), (Vec3f{8, 12, 3}));
  for (std::size_t i = 0; i < hill.indices.size(); i += 3) {
    const Vec3f a = hill.positions[hill.indices[i]];
    EXPECT_GT(cross(hill.positions[hill.indices[i + 1]] - a, hill.positions[hill.indices[i + 2]] - a).y, 0);
  }
  EXPECT_EQ(mesh_mass(to_triangles(Shape3(Box{{1, 1, 1}, 0.2f})), 1).components, 1);
}

}  // namespace
}  // namespace carom::geometry::mass_test
