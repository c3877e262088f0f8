#include "apps/host/demos/ballistics/range.h"

namespace carom::host::demo {

std::span<const DemoEntry> ballistics_demos() {
  static constexpr DemoEntry list[] = {{"trajectory-lab", make_trajectory_lab},
                                       {"rocket-launch", make_rocket_launch},
                                       {"artillery", make_artillery},
                                       {"shooting-range", make_shooting_range},
                                       {"turret", make_turret},
                                       {"ballistic-pendulum", make_ballistic_pendulum}};
  return list;
}

}  // namespace carom::host::demo
