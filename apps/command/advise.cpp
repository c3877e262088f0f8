// `carom doctor SCENE`: the adviser's word on a scene before its first step.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/command/command.h"
#include "carom/rigid/advice.h"

namespace carom::command {

std::vector<std::string> advice_for(host::Simulation& simulation) {
  const float dt = float(simulation.declaration().dt);
  std::vector<rigid::Advice> all;
  if (const rigid::World2* world = simulation.world2()) all = rigid::advise(*world, dt);
  if (const rigid::World3* world = simulation.world3()) all = rigid::advise(*world, dt);
  std::vector<std::string> out;
  for (rigid::Advice& advice : all) out.push_back(std::move(advice.message));
  return out;
}

int advise_scene(const std::string& name, bool json) {
  core::Result<std::unique_ptr<host::Demo>> demo = open_demo(name);
  if (!demo.ok()) return fail(exit_input, demo.error().message);
  host::Demo& chosen = **demo;
  core::Result<std::unique_ptr<host::Simulation>> simulation = chosen.open(std::move(demo).value(), {}, {});
  if (!simulation.ok()) return fail(exit_input, simulation.error().message);
  const std::vector<std::string> advice = advice_for(**simulation);
  if (json) {
    std::printf("%s\n", nlohmann::ordered_json({{"scene", name}, {"advice", advice}}).dump(2).c_str());
  } else {
    for (const std::string& line : advice) std::printf("%s\n", line.c_str());
    if (advice.empty()) std::printf("Nothing to change: the settings hold this scene.\n");
  }
  return exit_ok;
}

}  // namespace carom::command
