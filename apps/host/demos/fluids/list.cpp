#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {

std::span<const DemoFactory> fluid_demos() {
  static constexpr DemoFactory list[] = {make_fluid_tank, make_dam_break, make_water_jet};
  return list;
}

}  // namespace carom::host::demo
