#include "apps/host/demos/billiards/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> billiards_demos() {
  static constexpr DemoFactory list[] = {make_pool_table, make_break_shot, make_billiards_lab, make_masse};
  return list;
}

}  // namespace carom::host::demo
