#include "apps/host/demos/sports/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> sports_demos() {
  static constexpr DemoEntry list[] = {{"golf-hole", make_golf_hole},
                                       {"golf-swing", make_golf_swing},
                                       {"home-run", make_home_run},
                                       {"ball-spin", make_spin_lab},
                                       {"bowling", make_bowling}};
  return list;
}

}  // namespace carom::host::demo
