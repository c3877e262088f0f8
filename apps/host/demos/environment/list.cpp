#include "apps/host/demos/environment/environment_demos.h"

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::span<const DemoFactory> environment_demos() {
  static constexpr DemoFactory list[] = {make_sea_state, make_drag_crisis, make_windy_field, make_orbit_painter};
  return list;
}

}  // namespace carom::host::demo
