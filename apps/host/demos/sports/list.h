// The demos of this folder.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_golf_hole();
std::unique_ptr<Demo> make_golf_swing();
std::unique_ptr<Demo> make_home_run();
std::unique_ptr<Demo> make_spin_lab();
std::unique_ptr<Demo> make_bowling();

}  // namespace carom::host::demo
