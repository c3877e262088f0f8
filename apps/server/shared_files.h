// What a scene from elsewhere may read of this machine.
#pragma once

#include <string>
#include <vector>

#include "carom/scene/scene.h"

namespace carom::server {

/// Finds what a scene that was dropped on the page includes or names: presets ("presets/ball/golf.json") in the folders
/// of presets, everything else in the scenes folders; nothing outside of them, not even by a link, and nothing longer
/// than 16 MiB.
scene::Resolver shared_files(std::vector<std::string> scenes, std::vector<std::string> presets);

}  // namespace carom::server
