#include "apps/host/demos/environment/environment_demos.h"

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::span<const DemoEntry> environment_demos() {
  static constexpr DemoEntry list[] = {{"sea_state", make_sea_state},
                                       {"drag_crisis", make_drag_crisis},
                                       {"windy_field", make_windy_field},
                                       {"orbit_painter", make_orbit_painter}};
  return list;
}

}  // namespace carom::host::demo
