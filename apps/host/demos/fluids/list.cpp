#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {

std::span<const DemoEntry> fluid_demos() {
  static constexpr DemoEntry list[] = {{"fluid-tank", make_fluid_tank},
                                       {"dam-break", make_dam_break},
                                       {"water-fountain", make_water_fountain},
                                       {"sand-pile", make_sand_pile}};
  return list;
}

}  // namespace carom::host::demo
