#include "apps/host/registry.h"

#include <vector>

#include "apps/host/demos/demos.h"
#include "apps/host/stress_demo.h"

namespace carom::host {

namespace {
/// The engine's own; what stands on it has a list in its folder of demos/.
constexpr DemoFactory engine[] = {
    demo::make_wrecking_ball,
    demo::make_pyramids,
    demo::make_joints,
    demo::make_paths,
    demo::make_machines,
    demo::make_free_axes,
    demo::make_bridge,
    demo::make_adviser,
    demo::make_rewind,
    demo::make_walker,
    demo::make_strong_walker,
    demo::make_hovercraft,
    demo::make_collision_lab3,
    demo::make_collision_lab2,
    demo::make_conveyor,
    demo::make_ground_materials,
    demo::make_moving_meshes,
    demo::make_ellipsoids,
    demo::make_rounded,
    demo::make_decomposition,
    demo::make_card_house,
    demo::make_events,
    demo::make_hooks,
    demo::make_platforms,
    demo::make_rolling,
    demo::make_bullets,
    demo::make_chain,
    demo::make_far_away,
    demo::make_target,
    demo::make_mass_properties,
    demo::make_race_orbit,
    demo::make_race_spring,
    demo::make_race_ship,
    demo::make_tumbling_brick,
    demo::make_intermediate_axis,
};
}  // namespace

std::span<const DemoFactory> demos() {
  static const std::vector<DemoFactory> all = [] {
    std::vector<DemoFactory> list(std::begin(engine), std::end(engine));
    for (const std::span<const DemoFactory> group :
         {demo::figure_demos(), demo::rule_demos(), demo::terrain_demos(), demo::particle_demos(), demo::fluid_demos(),
          demo::rope_demos(), demo::environment_demos(), demo::ballistics_demos(), demo::blast_demos(),
          demo::sports_demos(), demo::billiards_demos()})
      list.insert(list.end(), group.begin(), group.end());
    return list;
  }();
  return all;
}

std::unique_ptr<Demo> make_demo(std::string_view id) {
  for (const DemoFactory make : demos()) {
    std::unique_ptr<Demo> demo = make();
    if (demo->declaration().id == id) return demo;
  }
  return make_stress_demo(id);
}

}  // namespace carom::host
