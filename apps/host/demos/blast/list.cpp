#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_blast_field();
std::unique_ptr<Demo> make_grenade();
std::unique_ptr<Demo> make_shatter();
std::unique_ptr<Demo> make_pane();
std::unique_ptr<Demo> make_vase();
std::unique_ptr<Demo> make_fracture_mesh();

std::span<const DemoFactory> blast_demos() {
  static constexpr DemoFactory list[] = {make_blast_field, make_grenade, make_shatter,
                                         make_pane,        make_vase,    make_fracture_mesh};
  return list;
}

}  // namespace carom::host::demo
