// Characters of a scene file.
#pragma once

#include "carom/scene/detail/shapes.h"
#include "carom/scene/scene_world.h"

namespace carom::scene::detail {

/// Makes the character of the object `o` in the world; its name and velocity are the caller's.
template <class D>
bool read_character(Reader& reader, const Object& o, rigid::World<D>& world, SceneCharacter& out);

}  // namespace carom::scene::detail
