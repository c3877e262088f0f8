#include "apps/host/demos/terrain/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> terrain_demos() {
  static constexpr DemoEntry list[] = {{"craters", make_craters}, {"quarry", make_quarry}, {"fortress", make_fortress}};
  return list;
}

}  // namespace carom::host::demo
