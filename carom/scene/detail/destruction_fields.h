// The tables of explosions, guns, structures, rockets and shells.
#pragma once

#include "carom/scene/detail/body_fields.h"

namespace carom::scene::detail {

extern const ObjectKind explosion_kind, case_kind, gun_kind, sway_kind, ammunition_kind, sight_kind, penetration_kind,
    layer_kind, structure_kind, rocket_kind, stage_kind, rocket_motor_kind, shell_kind, shell_row_kind,
    fired_shell_kind;

}  // namespace carom::scene::detail
