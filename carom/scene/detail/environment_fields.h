// The tables of the key "environment" of a scene.
#pragma once

#include "carom/scene/detail/fields.h"

namespace carom::scene::detail {

extern const ObjectKind environment_kind, gravity_field_kind, turning_frame_kind, air_kind, wind_field_kind,
    wind_layer_kind, gust_kind, turbulence_kind, thermal_kind, obstacle_kind, wake_kind, sea_kind, sea_wave_kind;

}  // namespace carom::scene::detail
