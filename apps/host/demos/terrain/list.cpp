#include "apps/host/demos/terrain/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> terrain_demos() {
  static constexpr DemoFactory list[] = {make_craters, make_quarry, make_fortress};
  return list;
}

}  // namespace carom::host::demo
