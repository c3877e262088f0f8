// The demos of this folder.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_rope_bridge();
std::unique_ptr<Demo> make_flag_and_sail();
std::unique_ptr<Demo> make_trebuchet();
std::unique_ptr<Demo> make_capstan();
std::unique_ptr<Demo> make_torsion_chain();
std::unique_ptr<Demo> make_soft_bodies();

}  // namespace carom::host::demo
