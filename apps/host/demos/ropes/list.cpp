#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> rope_demos() {
  static constexpr DemoEntry list[] = {{"rope-bridge", make_rope_bridge},     {"flag-and-sail", make_flag_and_sail},
                                       {"trebuchet", make_trebuchet},         {"capstan", make_capstan},
                                       {"torsion-chain", make_torsion_chain}, {"soft-bodies", make_soft_bodies}};
  return list;
}

}  // namespace carom::host::demo
