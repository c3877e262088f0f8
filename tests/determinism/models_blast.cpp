#include "carom/blast/explosion.h"
#include "carom/blast/structure.h"
#include "carom/geometry/mesh_builders.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

namespace {

void hash_piece(core::StateHash& hash, const blast::Piece& piece) {
  for (const math::Vec3d& v : piece.vertices) hash.add(v.x).add(v.y).add(v.z);
  for (const std::uint32_t i : piece.triangles) hash.add(i);
  hash.add(piece.mass.mass);
  for (const auto& hull : piece.hulls)
    for (const math::Vec3f& v : hull->vertices) hash.add(v.x).add(v.y).add(v.z);
}

}  // namespace

void blast_models(int width) {
  using math::Vec3d;
  using rigid::Dim3;
  core::StateHash hash;
  const geometry::Triangles ring = geometry::make_torus_mesh(0.7f, 0.25f, 20, 10);
  const std::vector<Vec3d> vertices(ring.positions.begin(), ring.positions.end());
  const blast::ConvexCell box = blast::container_of(vertices);
  const auto pieces = blast::fracture_mesh(vertices, ring.indices,
                                           blast::voronoi_pattern(box, blast::even_sites(box, 30, 1, 5)).value());
  for (const blast::Piece& piece : pieces->pieces) hash_piece(hash, piece);
  for (const blast::Bond& bond : pieces->bonds) hash.add(bond.a).add(bond.b).add(bond.area);
  print_model("fracture_mesh", hash);

  // Every way to choose where things break: random draws in one order with every compiler.
  hash = {};
  blast::RadialSites rings;
  rings.impact = {0.2, 0.1, 0};
  const auto radial = blast::radial_sites(box, rings, 3);
  for (const auto& sites : {blast::uniform_sites(box, 40, 1), blast::even_sites(box, 40, 2, 2),
                            blast::clustered_sites(box, {0.5, 0, 0}, 0.2, 40, 3), radial.value()})
    for (const Vec3d& p : sites) hash.add(p.x).add(p.y).add(p.z);
  print_model("fracture_sites", hash);

  // A wall, a charge before it, and what is left a second later.
  hash = {};
  rigid::World3 world({.simd_width = width});
  rigid::BodyDef<Dim3> floor;
  floor.type = rigid::BodyType::fixed;
  const auto ground = world.create_body(floor).value();
  (void)world.add_shape(ground, geometry::Plane{});
  const blast::ConvexCell wall(geometry::Bounds3d{{-1.5, 0, -0.1}, {1.5, 1.6, 0.1}});
  auto d = blast::structure_of(
      blast::fracture_convex(blast::voronoi_pattern(wall, blast::uniform_sites(wall, 80, 3)).value()).value(), 1900);
  d.material = blast::bond_material(blast::Substance::brick_and_mortar);
  blast::anchor_below(d, 0.05);
  auto structure = blast::Structure3::make(world, d).value();
  blast::FractureStepper3 stepper;
  auto charge = blast::Explosion3::make({.position = {0.2, 0.3, 2}, .mass = 2}).value();
  for (int i = 0; i < 60; ++i) {
    (void)charge.apply(world, 1.0 / 60);
    for (const auto& load : charge.loads())
      if (const std::uint32_t part = structure.part_of(load.shape); part != blast::ground)
        structure.add_load(part, load.impulse, load.point, load.duration);
    (void)stepper.step(world, 1 / 60.f, structure);
  }
  hash.add(world.state_hash()).add(std::uint64_t(structure.cluster_count())).add(std::uint64_t(structure.broken()));
  print_model("blasted_wall", hash);
}

}  // namespace carom::determinism
