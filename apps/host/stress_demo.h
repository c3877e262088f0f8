// The benchmark scenes (benchmarks/scene.h) as demos: the stress tests of the field, live.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "apps/host/demo.h"

namespace carom::host {

/// Those that a page can show, suite by suite; ids such as "box3d-large-pyramid".
std::vector<std::unique_ptr<Demo>> stress_demos();
/// Null where none has this id.
std::unique_ptr<Demo> make_stress_demo(std::string_view id);

}  // namespace carom::host
