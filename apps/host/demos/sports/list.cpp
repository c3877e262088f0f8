#include "apps/host/demos/sports/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> sports_demos() {
  static constexpr DemoFactory list[] = {make_golf_hole, make_golf_swing, make_home_run, make_spin_lab, make_bowling};
  return list;
}

}  // namespace carom::host::demo
