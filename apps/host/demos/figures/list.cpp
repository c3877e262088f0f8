#include "apps/host/demos/figures/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> figure_demos() {
  static constexpr DemoEntry list[] = {{"powered_ragdoll", make_powered_ragdoll}, {"robot_arm", make_robot_arm}};
  return list;
}

}  // namespace carom::host::demo
