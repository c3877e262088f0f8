// Mechanisms with muscles: arms and figures.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_robot_arm();
std::unique_ptr<Demo> make_powered_ragdoll();

}  // namespace carom::host::demo
