// The way back from messages to views: what a recording's header shows, for pictures of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/host/declaration.h"
#include "apps/host/views.h"
#include "carom/core/result.h"

namespace carom::host {

/// Bodies and ground of a `scene` message (docs/protocol.md). Meshes are named by their place in `mesh_count` meshes.
/// Errors name the body and the field.
struct SceneViews {
  std::vector<BodyView> bodies;
  std::optional<double> ground;
};
core::Result<SceneViews> read_scene(const std::string& text, std::size_t mesh_count);
/// The bodies that a `bodies` message adds.
core::Result<std::vector<BodyView>> read_arrivals(const std::string& text, std::size_t mesh_count);
/// A binary `mesh` message.
core::Result<Mesh> read_mesh(const std::string& bytes);
/// The camera of an `opened` message; what is missing or no number stays as `camera` has it.
void read_camera(const std::string& opened, Camera& camera);

}  // namespace carom::host
