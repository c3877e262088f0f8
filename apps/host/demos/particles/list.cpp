#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {

std::span<const DemoFactory> particle_demos() {
  static constexpr DemoFactory list[] = {make_wind_on_obstacles, make_spark_burst, make_snow,
                                         make_drop_fountain,     make_hail,        make_fire,
                                         make_fireball,          make_sand_heap};
  return list;
}

}  // namespace carom::host::demo
