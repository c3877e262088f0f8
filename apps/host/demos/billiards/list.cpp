#include "apps/host/demos/billiards/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> billiards_demos() {
  static constexpr DemoEntry list[] = {{"pool-table", make_pool_table},
                                       {"break-shot", make_break_shot},
                                       {"billiards-lab", make_billiards_lab},
                                       {"masse", make_masse}};
  return list;
}

}  // namespace carom::host::demo
