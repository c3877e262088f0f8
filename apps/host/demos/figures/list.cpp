#include "apps/host/demos/figures/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> figure_demos() {
  static constexpr DemoFactory list[] = {make_powered_ragdoll, make_robot_arm};
  return list;
}

}  // namespace carom::host::demo
