#include "apps/host/demos/blast/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> blast_demos() {
  static constexpr DemoEntry list[] = {
      {"blast-field", make_blast_field}, {"grenade", make_grenade}, {"shatter-wall", make_shatter},
      {"glass-pane", make_pane},         {"vase", make_vase},       {"fracture-mesh", make_fracture_mesh}};
  return list;
}

}  // namespace carom::host::demo
