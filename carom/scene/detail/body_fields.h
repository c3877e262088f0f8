// The tables of bodies and characters: shapes, what they are made of and how they are turned.
#pragma once

#include "carom/scene/detail/fields.h"

namespace carom::scene::detail {

extern const ObjectKind rotation_kind, material_kind, filter_kind, surface_kind, shape_kind, mass_properties_kind,
    body_kind, character_kind;

}  // namespace carom::scene::detail
