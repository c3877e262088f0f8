// A scene file opened as a demo: its declarations map one to one.
#pragma once

#include <memory>

#include "apps/host/demo.h"
#include "carom/scene/scene.h"

namespace carom::host {

/// Menu entry of a scene: id (as `open` takes it), group "Scenes".
Declaration declaration_of(const scene::Scene& scene, std::string id);
/// Errors: those of instantiating the scene come when the demo is opened.
std::unique_ptr<Demo> make_scene_demo(scene::Scene scene, std::string id);

}  // namespace carom::host
