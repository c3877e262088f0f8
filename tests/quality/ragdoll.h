// A humanoid of fourteen capsules: the one of Box3D's rain scene (rigid-body.md 3.5).
#pragma once

#include "carom/rigid/world.h"

namespace carom::quality {

/// Adds one whose origin (between its feet) is at `origin`, all shapes in the negative `group`.
void add_ragdoll(rigid::World3& world, math::Vec3d origin, int group);

}  // namespace carom::quality
