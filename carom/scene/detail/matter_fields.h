// The tables of what a scene has besides bodies: ropes, cloth, soft bodies, liquids, grains and particles.
#pragma once

#include "carom/scene/detail/body_fields.h"

namespace carom::scene::detail {

extern const ObjectKind rope_kind, rope_attachment_kind, rope_winch_kind, rope_lump_kind, cloth_kind, pin_kind,
    soft_body_kind, liquid_kind, fill_kind, tap_kind, drain_kind, grains_kind, particles_kind, emitter_kind,
    sub_emission_kind, attractor_kind, touch_kind, burst_kind;

}  // namespace carom::scene::detail
