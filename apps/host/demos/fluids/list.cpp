#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {

std::span<const DemoFactory> fluid_demos() {
  static constexpr DemoFactory list[] = {make_fluid_tank, make_dam_break, make_water_fountain, make_sand_pile};
  return list;
}

}  // namespace carom::host::demo
