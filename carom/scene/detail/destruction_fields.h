// The tables of explosions, guns and structures.
#pragma once

#include "carom/scene/detail/body_fields.h"

namespace carom::scene::detail {

extern const ObjectKind explosion_kind, gun_kind, ammunition_kind, sight_kind, penetration_kind, layer_kind,
    structure_kind;

}  // namespace carom::scene::detail
