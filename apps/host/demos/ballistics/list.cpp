#include "apps/host/demos/ballistics/range.h"

namespace carom::host::demo {

std::span<const DemoFactory> ballistics_demos() {
  static constexpr DemoFactory list[] = {make_trajectory_lab, make_rocket_launch, make_artillery,
                                         make_shooting_range, make_turret,        make_ballistic_pendulum};
  return list;
}

}  // namespace carom::host::demo
