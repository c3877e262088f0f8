// A recording as a run, for who wants to look at it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apps/host/simulation.h"
#include "carom/scene/recording.h"

namespace carom::host {

/// A recording as a run whose steps are its frames: nothing can be pulled at or set, any frame can be shown.
/// Errors name what is wrong with the file; one that ends early plays as far as it is whole, and says so.
[[gnu::noinline]] core::Result<std::unique_ptr<Simulation>> open_recording(std::vector<std::uint8_t> bytes);

}  // namespace carom::host
