// The settings of the engine that a scene file gives.
#pragma once

#include "carom/rigid/world.h"
#include "carom/scene/detail/reader.h"
#include "carom/scene/scene_world.h"

namespace carom::scene::detail {

/// False: an error is with the reader.
template <class D>
bool read_world(Reader& reader, const Object& scene, const InstantiateOptions& options, rigid::WorldDef<D>& def);
/// world.material_pairs.
template <class D>
bool read_material_pairs(Reader& reader, const Object& scene, rigid::World<D>& world);

}  // namespace carom::scene::detail
