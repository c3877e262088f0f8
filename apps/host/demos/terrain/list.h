// Ground that changes while one plays.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_craters();
std::unique_ptr<Demo> make_quarry();
std::unique_ptr<Demo> make_fortress();

}  // namespace carom::host::demo
