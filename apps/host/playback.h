// Runs as recordings: what `carom run` and a page write, and what a page plays.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apps/host/simulation.h"
#include "carom/scene/recording.h"

namespace carom::host {

scene::RecordingHeader recording_header(Simulation& simulation);
/// The run as it is now. Samples are those that `frame` holds already.
void capture_frame(Simulation& simulation, bool with_hash, scene::RecordedFrame& frame);

/// A recording as a run whose steps are its frames: nothing can be pulled at or set, any frame can be shown.
/// Errors name what is wrong with the file; one that ends early plays as far as it is whole, and says so.
core::Result<std::unique_ptr<Simulation>> open_recording(std::vector<std::uint8_t> bytes);

}  // namespace carom::host
