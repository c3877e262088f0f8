#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_pool_table();
std::unique_ptr<Demo> make_break_shot();
std::unique_ptr<Demo> make_billiards_lab();
std::unique_ptr<Demo> make_masse();

std::span<const DemoFactory> billiards_demos() {
  static constexpr DemoFactory list[] = {make_pool_table, make_break_shot, make_billiards_lab, make_masse};
  return list;
}

}  // namespace carom::host::demo
