// The demos of this folder.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_blast_field();
std::unique_ptr<Demo> make_grenade();
std::unique_ptr<Demo> make_shatter();
std::unique_ptr<Demo> make_pane();
std::unique_ptr<Demo> make_vase();
std::unique_ptr<Demo> make_fracture_mesh();

}  // namespace carom::host::demo
