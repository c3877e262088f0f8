// The tables of joints and of the forces that act on their own.
#pragma once

#include "carom/scene/detail/fields.h"

namespace carom::scene::detail {

extern const ObjectKind frame_kind, spring_kind, limit_kind, motor_kind, joint_axis_kind, joint_axes_kind, joint_kind,
    wave_kind, effector_kind, ball_air_kind, bowled_kind, pitched_kind, golf_shot_kind;

}  // namespace carom::scene::detail
