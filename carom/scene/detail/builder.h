// Makes the world that a scene file describes, or brings a running one to new parameter values.
#pragma once

#include "carom/scene/detail/shapes.h"
#include "carom/scene/scene.h"

namespace carom::scene::detail {

/// The variables of expressions: the scene's parameters with their values, `values` in place of the defaults.
core::Status set_variables(Reader& reader, const Scene& scene, std::span<const ParameterValue> values);

/// Makes out.world2 or out.world3 and everything in it. The reader has the variables and holds the error.
bool build_world(Reader& reader, const Scene& scene, const InstantiateOptions& options, SceneWorld& out);
/// Gravity, effectors, joints' motors, limits and springs, materials, damping and speeds of kinematic bodies.
bool update_world(Reader& reader, const Scene& scene, SceneWorld& world);

}  // namespace carom::scene::detail
