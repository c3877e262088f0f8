// A block of concrete is cut into cells, dropped, and breaks; then a charge goes off beside what is left.
#include <cstdio>

#include "carom/blast/explosion.h"
#include "carom/blast/structure.h"

using namespace carom;

int main() {
  rigid::World3 world;
  const auto floor = world.create_body({.type = rigid::BodyType::fixed}).value();
  world.add_shape(floor, geometry::Plane{}).value();

  // Sixty pieces of about one size, held together by bonds.
  const blast::ConvexCell block(geometry::Bounds3d{{-0.5, -0.25, -0.5}, {0.5, 0.25, 0.5}});
  const auto sites = blast::even_sites(block, 60, 2, 1);
  const auto pieces = blast::fracture_convex(blast::voronoi_pattern(block, sites).value()).value();
  auto definition = blast::structure_of(pieces, blast::density_of(blast::Substance::concrete));
  definition.material = blast::bond_material(blast::Substance::concrete);
  definition.pose.position = {0, 3, 0};
  definition.angular_velocity = {0.5f, 0, 1.5f};
  auto structure = blast::Structure3::make(world, definition).value();
  blast::FractureStepper3 stepper;
  auto charge = blast::Explosion3::make({.position = {4, 0.1, 0}, .mass = 2, .time = 2}).value();

  constexpr float dt = 1.0f / 60;
  for (int i = 0; i < 240; ++i) {
    charge.apply(world, dt).value();
    for (const auto& load : charge.loads())
      if (const auto part = structure.part_of(load.shape); part != blast::ground)
        structure.add_load(part, load.impulse, load.point, load.duration);
    stepper.step(world, dt, structure).value();
    if (!structure.events().empty())
      std::printf("%.2f s: %zu bonds broke, %zu bodies\n", world.time(), structure.events().size(),
                  structure.cluster_count());
  }
  const auto totals = world.totals();
  std::printf("%.3f kg in %zu bodies, %.1f J\n", totals.mass, structure.cluster_count(), totals.kinetic_energy);
}
