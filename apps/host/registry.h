// The demos that Carom carries, in the order a newcomer should see them.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "apps/host/demo.h"

namespace carom::host {

struct DemoEntry {
  std::string_view id;  ///< as the demo declares it, so that one is found without making the others
  std::unique_ptr<Demo> (*make)();
};
std::span<const DemoEntry> demos();
/// The one of this id, of the stress scenes (stress_demo.h) too; null where none has it.
std::unique_ptr<Demo> make_demo(std::string_view id);

}  // namespace carom::host
