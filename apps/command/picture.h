// The state of a simulation as a PNG, drawn without a display.
#pragma once

#include <string>

#include "apps/command/canvas.h"
#include "apps/host/simulation.h"

namespace carom::command {

/// 32-bit pixels, 0x00RRGGBB; without lettering where a picture is to stand for the demo, small, beside its name.
Surface picture_of(host::Simulation& simulation, int width, int height, bool lettering = true);
core::Status write_picture(host::Simulation& simulation, const std::string& path, int width = 1280, int height = 720);

}  // namespace carom::command
