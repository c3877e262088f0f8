#include "apps/host/registry.h"

#include <vector>

#include "apps/host/demos/demos.h"
#include "apps/host/stress_demo.h"

namespace carom::host {

namespace {
/// The engine's own; what stands on it has a list in its folder of demos/.
constexpr DemoEntry engine[] = {
    {"wrecking-ball", demo::make_wrecking_ball},
    {"pyramids", demo::make_pyramids},
    {"joints", demo::make_joints},
    {"joints-2d", demo::make_joints_plane},
    {"paths", demo::make_paths},
    {"machines", demo::make_machines},
    {"free-axes", demo::make_free_axes},
    {"bridge", demo::make_bridge},
    {"adviser", demo::make_adviser},
    {"rewind", demo::make_rewind},
    {"walker", demo::make_walker},
    {"strong_walker", demo::make_strong_walker},
    {"hovercraft", demo::make_hovercraft},
    {"collision-lab-3d", demo::make_collision_lab3},
    {"collision-lab-2d", demo::make_collision_lab2},
    {"conveyor", demo::make_conveyor},
    {"ground-materials", demo::make_ground_materials},
    {"moving-meshes", demo::make_moving_meshes},
    {"ellipsoids", demo::make_ellipsoids},
    {"rounded", demo::make_rounded},
    {"decomposition", demo::make_decomposition},
    {"decomposition-2d", demo::make_decomposition_plane},
    {"card-house", demo::make_card_house},
    {"events", demo::make_events},
    {"hooks", demo::make_hooks},
    {"platforms", demo::make_platforms},
    {"rolling", demo::make_rolling},
    {"bullets", demo::make_bullets},
    {"chain", demo::make_chain},
    {"far-away", demo::make_far_away},
    {"hit-the-target", demo::make_target},
    {"mass-properties", demo::make_mass_properties},
    {"race-orbit", demo::make_race_orbit},
    {"race-spring", demo::make_race_spring},
    {"race-ship", demo::make_race_ship},
    {"tumbling-brick", demo::make_tumbling_brick},
    {"intermediate-axis", demo::make_intermediate_axis},
};
}  // namespace

std::span<const DemoEntry> demos() {
  static const std::vector<DemoEntry> all = [] {
    std::vector<DemoEntry> list(std::begin(engine), std::end(engine));
    for (const std::span<const DemoEntry> group :
         {demo::figure_demos(), demo::rule_demos(), demo::terrain_demos(), demo::particle_demos(), demo::fluid_demos(),
          demo::rope_demos(), demo::environment_demos(), demo::ballistics_demos(), demo::blast_demos(),
          demo::sports_demos(), demo::billiards_demos()})
      list.insert(list.end(), group.begin(), group.end());
    return list;
  }();
  return all;
}

std::unique_ptr<Demo> make_demo(std::string_view id) {
  for (const DemoEntry& demo : demos())
    if (demo.id == id) return demo.make();
  return make_stress_demo(id);
}

}  // namespace carom::host
