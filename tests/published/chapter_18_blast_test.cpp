// Chapter 18.6 to 18.8, explosions: published numbers and laws. Source: ballistics-sports.md 2.9, 2.14 and 3.
#include <gtest/gtest.h>

#include "carom/blast/explosion.h"
#include "carom/blast/fragments.h"
#include "carom/blast/structure.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"

namespace carom::published {
namespace chapter_18_blast_test {

using namespace carom::blast;
using math::Vec3d;
using rigid::Dim3;

TEST(Chapter18Blast, OneKilogramInFreeAirAtTenMetres) {
  // Kinney & Graham: 9.985 kPa.
  EXPECT_NEAR(kinney_graham_pressure(1, 10), 9985, 5);
}

TEST(Chapter18Blast, ASquareMetreAtFifteenMetresOfAHundredKilograms) {
  // Swisdak's fits: i_r 954.938 Pa·s on a face square to the wave. A thin plate that looks at the charge, so small that
  // all of it is at that distance; behind it the side-on impulse pushes back, less the suction of the wind.
  rigid::World3 world({.gravity = {0, 0, 0}});
  rigid::BodyDef<Dim3> body;
  body.position = {15, 0.05, 0};
  const auto id = world.create_body(body).value();
  ASSERT_TRUE(world.add_shape(id, geometry::Box{{0.001f, 0.05f, 0.05f}}, {.density = 1e6}));
  auto explosion = Explosion3::make({.mass = 100, .clearing = false}).value();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(explosion.apply(world, 1.0 / 60));
    ASSERT_TRUE(world.step(1 / 60.f));
  }
  const double rear = SurfaceLoad(explosion.wave_at(15), -1).impulse();
  EXPECT_NEAR(explosion.impulse_given().x / 0.01 + rear, 954.938, 0.005 * 954.938);
  EXPECT_NEAR(explosion.wave_at(15).impulse, 404.203, 0.01);
}

TEST(Chapter18Blast, FragmentsLeaveTheBurstWithoutMomentum) {
  const auto spray = fragment_spray(0.3, gurney_speed(CaseShape::sphere, 1.5), 500, 3).value();
  Vec3d sum{};
  double mass = 0;
  for (const Fragment& f : spray) sum += f.mass * f.velocity, mass += f.mass;
  EXPECT_NEAR(mass, 0.3, 1e-9 * 0.3);
  EXPECT_LT(length(sum), 1e-9 * 0.3 * length(spray[0].velocity));
}

// Poisson–Voronoi cells have 2 + 48π²/35 faces on average, 96π²/35 vertices and 144π²/35 edges (J. L. Meijering,
// "Interface area, edge length, and number of vertices in crystal aggregates with random nucleation", 1953); the
// variance of volumes is .179 (E. N. Gilbert, "Random subdivisions of space into crystals",
// 1962): 15.535457, 27.070915, 40.606372; an existing library (voro++, 1e5 cells) gives 15.5430 and .17995. A periodic
// box.
TEST(Chapter18Blast, StatisticsOfPoissonVoronoiCells) {
  constexpr int n = 2500;
  std::vector<Vec3d> sites = uniform_sites(ConvexCell(geometry::Bounds3d{{0, 0, 0}, {1, 1, 1}}), n, 17);
  const double margin = 0.2;
  for (int copy = 0; copy < 27; ++copy) {
    const Vec3d shift{double(copy % 3 - 1), double(copy / 3 % 3 - 1), double(copy / 9 - 1)};
    if (copy == 13) continue;
    for (int i = 0; i < n; ++i) {
      const Vec3d p = sites[std::size_t(i)] + shift;
      if (math::min(math::min(p.x, p.y), p.z) > -margin && math::max(math::max(p.x, p.y), p.z) < 1 + margin)
        sites.push_back(p);
    }
  }
  const auto pattern = voronoi_pattern(ConvexCell(geometry::Bounds3d{{-.5, -.5, -.5}, {1.5, 1.5, 1.5}}), sites);
  ASSERT_TRUE(pattern);
  double faces = 0, vertices = 0, edges = 0, volume = 0, squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const ConvexCell& cell = pattern->cells[i];
    faces += double(cell.faces().size()) / n;
    vertices += double(cell.vertices().size()) / n;
    edges += double(cell.edge_count()) / n;
    const double v = cell.volume();
    volume += v;
    squares += v * v * n;
  }
  const double pi2 = math::pi * math::pi;
  // A cell's number of faces scatters by 3.3, so that the mean of 2500 does by .066: three of that.
  EXPECT_NEAR(faces, 2 + 48 * pi2 / 35, 0.2);
  EXPECT_NEAR(vertices, 96 * pi2 / 35, 0.4);
  EXPECT_NEAR(edges, 144 * pi2 / 35, 0.6);
  EXPECT_NEAR(vertices, 2 * (faces - 2), 1e-9) << "three faces at every corner, and Euler's formula";
  EXPECT_NEAR(volume, 1, 1e-11) << "periodic cells tile the box";
  EXPECT_NEAR(squares - 1, 0.179, 0.02);
}

TEST(Chapter18Blast, AMeshInPiecesIsTheMesh) {
  // 18.8: Σm and ΣV to 1e-9.
  const geometry::Triangles ring = geometry::make_torus_mesh(0.6f, 0.2f, 32, 16);
  const std::vector<Vec3d> vertices(ring.positions.begin(), ring.positions.end());
  const auto whole = geometry::mesh_mass_properties(vertices, ring.indices, 1).value();
  const ConvexCell box = container_of(vertices);
  const auto f =
      fracture_mesh(vertices, ring.indices, voronoi_pattern(box, uniform_sites(box, 80, 1)).value(), {.hulls = false})
          .value();
  double volume = 0;
  for (const Piece& piece : f.pieces) volume += piece.mass.mass;
  EXPECT_NEAR(volume, whole.volume, 1e-9 * whole.volume);
}

TEST(Chapter18Blast, HandOverConservesMomentum) {
  // Section 6: 1e-6.
  rigid::World3 world({.gravity = {0, 0, 0}});
  const ConvexCell box(geometry::Bounds3d{{-0.5, -0.3, -0.4}, {0.5, 0.3, 0.4}});
  auto d = structure_of(
      fracture_convex(voronoi_pattern(box, uniform_sites(box, 200, 6)).value(), {.meshes = false}).value(), 2500);
  d.linear_velocity = {10, 5, -3};
  d.angular_velocity = {3, -7, 11};
  auto structure = Structure3::make(world, d).value();
  const auto before = world.totals();
  for (std::uint32_t i = 0; i < d.bonds.size(); ++i) structure.break_bond(i);
  ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
  const auto after = world.totals();
  EXPECT_EQ(structure.cluster_count(), 200u);
  EXPECT_NEAR(after.mass, before.mass, 1e-6 * before.mass);
  EXPECT_LT(length(after.momentum - before.momentum), 1e-6 * length(before.momentum));
  EXPECT_LT(length(after.angular_momentum - before.angular_momentum), 1e-6 * length(before.angular_momentum));
}

}  // namespace chapter_18_blast_test
}  // namespace carom::published
