// The suites' own lists of scenes.
#pragma once

#include "benchmarks/scene.h"

namespace carom::bench {

std::span<const SceneInfo> common_scenes();
std::span<const SceneInfo> box3d_scenes();
std::span<const SceneInfo> box2d_scenes();
std::span<const SceneInfo> jolt_scenes();

}  // namespace carom::bench
