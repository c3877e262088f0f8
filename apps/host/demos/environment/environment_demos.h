// The demos of what is around bodies: sea, wind, fields.
#pragma once

#include <memory>

#include "apps/host/demo.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_sea_state();
std::unique_ptr<Demo> make_drag_crisis();
std::unique_ptr<Demo> make_windy_field();
std::unique_ptr<Demo> make_orbit_painter();

}  // namespace carom::host::demo
