#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_rope_bridge();
std::unique_ptr<Demo> make_flag_and_sail();
std::unique_ptr<Demo> make_trebuchet();
std::unique_ptr<Demo> make_capstan();
std::unique_ptr<Demo> make_torsion_chain();
std::unique_ptr<Demo> make_soft_bodies();

std::span<const DemoFactory> rope_demos() {
  static constexpr DemoFactory list[] = {make_rope_bridge, make_flag_and_sail, make_trebuchet,
                                         make_capstan,     make_torsion_chain, make_soft_bodies};
  return list;
}

}  // namespace carom::host::demo
