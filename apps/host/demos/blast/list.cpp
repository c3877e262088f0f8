#include "apps/host/demos/blast/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> blast_demos() {
  static constexpr DemoFactory list[] = {make_blast_field, make_grenade, make_shatter,
                                         make_pane,        make_vase,    make_fracture_mesh};
  return list;
}

}  // namespace carom::host::demo
