#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::span<const DemoFactory> ballistics_demos() {
  return {};  // static constexpr DemoFactory list[] = {make_…}; return list;
}

}  // namespace carom::host::demo
