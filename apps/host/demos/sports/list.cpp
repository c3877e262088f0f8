#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_golf_hole();
std::unique_ptr<Demo> make_golf_swing();
std::unique_ptr<Demo> make_home_run();
std::unique_ptr<Demo> make_spin_lab();
std::unique_ptr<Demo> make_bowling();

std::span<const DemoFactory> sports_demos() {
  static constexpr DemoFactory list[] = {make_golf_hole, make_golf_swing, make_home_run, make_spin_lab, make_bowling};
  return list;
}

}  // namespace carom::host::demo
