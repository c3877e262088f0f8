#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> rope_demos() {
  static constexpr DemoFactory list[] = {make_rope_bridge, make_flag_and_sail, make_trebuchet,
                                         make_capstan,     make_torsion_chain, make_soft_bodies};
  return list;
}

}  // namespace carom::host::demo
