// Chapter 18.8, fracture: laws of pieces (shared reference "ballistics-sports", 2.14): their volumes, first moments and
// moments of inertia are the whole's to 1e-9, every piece is closed without T-junctions and of Euler's χ = 2, and every
// point is in exactly one of them (by chance). Momentum through the hand-over: chapter_18_blast_test.cpp.
#include <gtest/gtest.h>

#include "carom/geometry/query.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "tests/blast/fracture_support.h"

namespace chapter_18_fracture_test {
using namespace fracture_test;

struct Sum {
  double mass = 0;
  Vec3d first{};
  math::Mat3d about_origin = math::Mat3d::zero();
};
Sum sum_of(const Fracture& f) {
  Sum s;
  for (const Piece& p : f.pieces) {
    s.mass += p.mass.mass;
    s.first += p.mass.mass * p.mass.center;
    s.about_origin = s.about_origin + geometry::transfer_inertia(p.mass.inertia, p.mass.mass, p.mass.center);
  }
  return s;
}
double greatest(const math::Mat3d& m) {
  double g = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g = math::max(g, math::abs(m(i, j)));
  return g;
}

TEST(Chapter18Fracture, VoronoiPiecesAreTheWhole) {
  const geometry::Bounds3d box{{-1, -0.5, -2}, {1, 0.5, 2}};
  const ConvexCell whole(box);
  const auto sites = uniform_sites(whole, 200, 3);
  const auto pattern = voronoi_pattern(whole, sites);
  ASSERT_TRUE(pattern) << pattern.error().message;
  const auto f = fracture_convex(*pattern);
  ASSERT_TRUE(f) << f.error().message;
  EXPECT_EQ(f->pieces.size(), 200u);
  const auto expected = whole.mass_properties(1);
  const Sum s = sum_of(*f);
  EXPECT_NEAR(s.mass, expected.mass, 1e-9 * expected.mass);
  EXPECT_LT(length(s.first - expected.mass * expected.center), 1e-9);
  EXPECT_LT(greatest(s.about_origin - expected.inertia), 1e-9 * greatest(expected.inertia));
  for (const Piece& p : f->pieces) {
    EXPECT_TRUE(is_watertight(p));
    EXPECT_EQ(euler_characteristic(p), 2);
    ASSERT_EQ(p.hulls.size(), 1u);
    const auto sound = geometry::validate_hull(*p.hulls[0], {}, 2e-5);
    EXPECT_TRUE(sound.ok()) << sound.error().message;
  }
}

TEST(Chapter18Fracture, EveryPointIsInExactlyOneCell) {
  const ConvexCell box = unit_box();
  std::vector<Pattern> patterns;
  patterns.push_back(voronoi_pattern(box, clustered_sites(box, {0.5, 0.9, 0.1}, 0.1, 60, 5)).value());
  patterns.push_back(
      voronoi_pattern(box, *radial_sites(box, {.impact = {.4, .5, .5}, .axis = {0, 0, 1}, .first_radius = .05}, 2))
          .value());
  patterns.push_back(slab_pattern(box, {1, 2, 0.5}, 9, 0.8, 4).value());
  patterns.push_back(brick_pattern(box, {0.25, 0.1, 0.5}, {0.05, 0, 0}).value());
  for (const Pattern& pattern : patterns) {
    double volume = 0;
    for (const ConvexCell& cell : pattern.cells) volume += cell.volume();
    EXPECT_NEAR(volume, 1, 1e-12);
    math::Random random(9);
    for (int k = 0; k < 2000; ++k) {
      const Vec3d p{random.uniform(), random.uniform(), random.uniform()};
      int inside = 0;
      for (const ConvexCell& cell : pattern.cells) {
        bool in = !cell.empty();
        for (const auto& face : cell.faces()) in = in && dot(face.normal, p) <= face.offset;
        inside += in;
      }
      EXPECT_EQ(inside, 1);
    }
  }
}

// Signed solid angles of the triangles: 1 inside, 0 outside (A. Van Oosterom & J. Strackee, 1983).
double winding(const Piece& piece, Vec3d p) {
  double sum = 0;
  for (std::size_t t = 0; t < piece.triangles.size(); t += 3) {
    const Vec3d a = piece.vertices[piece.triangles[t]] - p, b = piece.vertices[piece.triangles[t + 1]] - p,
                c = piece.vertices[piece.triangles[t + 2]] - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * math::atan2(triple(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * math::pi);
}

TEST(Chapter18Fracture, MeshPiecesAreWatertightAndTheWhole) {
  for (const MeshCase& m : mesh_cases()) {
    const std::vector<Vec3d> vertices(m.mesh.positions.begin(), m.mesh.positions.end());
    const auto whole = geometry::mesh_mass_properties(vertices, m.mesh.indices, 1);
    ASSERT_TRUE(whole) << m.name << whole.error().message;
    const ConvexCell box = container_of(vertices);
    const auto bounds = geometry::Bounds3d{box.vertices()[0], box.vertices()[7]};
    for (const Pattern& pattern :
         {voronoi_pattern(box, uniform_sites(box, m.count, 11)).value(), slab_pattern(box, {0, 1, 0}, 7).value(),
          brick_pattern(box, {0.25, 0.125, 0.25}, {0, 0, 0}).value()}) {
      const auto f = fracture_mesh(vertices, m.mesh.indices, pattern, {.hulls = false});
      ASSERT_TRUE(f) << m.name << f.error().message;
      const auto& expected = whole->properties;
      const Sum s = sum_of(*f);
      EXPECT_NEAR(s.mass, expected.mass, 1e-9 * expected.mass) << m.name;
      EXPECT_LT(length(s.first - expected.mass * expected.center), 1e-9 * expected.mass) << m.name;
      const math::Mat3d inertia = geometry::transfer_inertia(expected.inertia, expected.mass, expected.center);
      EXPECT_LT(greatest(s.about_origin - inertia), 1e-9 * greatest(inertia)) << m.name;
      for (const Piece& p : f->pieces) {
        EXPECT_TRUE(is_watertight(p)) << m.name;
        const auto mass = geometry::mesh_mass_properties(p.vertices, p.triangles, 1);
        if (p.mass.mass > 1e-6 * expected.mass) {
          EXPECT_TRUE(mass) << m.name << (mass ? "" : mass.error().message);
          if (mass) EXPECT_NEAR(mass->volume, p.mass.mass, 1e-9 * expected.mass);
        }
      }
      // Every point in exactly one piece or outside all.
      math::Random random(3);
      for (int k = 0; k < 40; ++k) {
        const Vec3d p{random.uniform(bounds.low.x, bounds.high.x), random.uniform(bounds.low.y, bounds.high.y),
                      random.uniform(bounds.low.z, bounds.high.z)};
        Piece solid;
        solid.vertices = vertices;
        solid.triangles = m.mesh.indices;
        double sum = 0;
        int inside = 0;
        for (const Piece& piece : f->pieces) {
          const double w = winding(piece, p);
          sum += w;
          inside += w > 0.5;
          EXPECT_LT(math::abs(w - math::round(w)), 1e-6) << m.name;
        }
        EXPECT_NEAR(sum, winding(solid, p), 1e-6) << m.name;
        EXPECT_LE(inside, 1);
      }
    }
  }
}

TEST(Chapter18Fracture, MeshPiecesOfManyCellsAreBalls) {
  for (const MeshCase& m : mesh_cases()) {
    const std::vector<Vec3d> vertices(m.mesh.positions.begin(), m.mesh.positions.end());
    const ConvexCell box = container_of(vertices);
    const auto f = fracture_mesh(vertices, m.mesh.indices, voronoi_pattern(box, even_sites(box, 60, 2, 5)).value(),
                                 {.hulls = false});
    ASSERT_TRUE(f);
    for (const Piece& p : f->pieces) EXPECT_EQ(euler_characteristic(p), 2) << m.name;
  }
}

}  // namespace chapter_18_fracture_test
