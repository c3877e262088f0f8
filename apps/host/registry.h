// The demos that Carom carries, in the order a newcomer should see them.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "apps/host/demo.h"

namespace carom::host {

using DemoFactory = std::unique_ptr<Demo> (*)();
std::span<const DemoFactory> demos();
/// Everything by this id, the stress scenes (stress_demo.h) too; null where none has it.
std::unique_ptr<Demo> make_demo(std::string_view id);

}  // namespace carom::host
