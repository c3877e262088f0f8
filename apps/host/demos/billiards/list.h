// The demos of this folder.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_pool_table();
std::unique_ptr<Demo> make_break_shot();
std::unique_ptr<Demo> make_billiards_lab();
std::unique_ptr<Demo> make_masse();

}  // namespace carom::host::demo
