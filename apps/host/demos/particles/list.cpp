#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {

std::span<const DemoEntry> particle_demos() {
  static constexpr DemoEntry list[] = {{"wind-on-obstacles", make_wind_on_obstacles},
                                       {"spark-burst", make_spark_burst},
                                       {"snow", make_snow},
                                       {"drop-fountain", make_drop_fountain},
                                       {"hail-on-pegs", make_hail},
                                       {"fire-and-smoke", make_fire},
                                       {"fireball", make_fireball},
                                       {"sand-heap", make_sand_heap}};
  return list;
}

}  // namespace carom::host::demo
