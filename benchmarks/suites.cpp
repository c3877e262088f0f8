#include "benchmarks/suites.h"

#include "benchmarks/scene_list.h"

namespace carom::bench {

// Two scenes that any engine can build, with engine defaults and sleeping off.
std::span<const SceneInfo> common_scenes() {
  static const SceneInfo scenes[] = {
      {.suite = "common",
       .name = "twenty_pyramids",
       .steps = 300,
       .hash_steps = 60,
       .make3 = [] { return list_scene<rigid::Dim3>(twenty_pyramids()); }},
      {.suite = "common",
       .name = "heap",
       .steps = 300,
       .hash_steps = 60,
       .make3 = [] { return list_scene<rigid::Dim3>(heap()); }},
  };
  return scenes;
}

std::span<const SceneInfo> all_scenes() {
  static const std::vector<SceneInfo> all = [] {
    std::vector<SceneInfo> scenes;
    for (const std::span<const SceneInfo> suite : {common_scenes(), box3d_scenes(), box2d_scenes(), jolt_scenes()})
      scenes.insert(scenes.end(), suite.begin(), suite.end());
    return scenes;
  }();
  return all;
}

std::vector<const SceneInfo*> find_scenes(const std::string& name) {
  std::vector<const SceneInfo*> found;
  for (const SceneInfo& scene : all_scenes())
    if (name == scene.suite || name == scene.name || name == scene.path() || name == "all") found.push_back(&scene);
  return found;
}

}  // namespace carom::bench
