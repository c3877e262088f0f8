// The state of a simulation as a PNG, drawn without a display.
#pragma once

#include <string>

#include "apps/host/simulation.h"

namespace carom::command {

core::Status write_picture(host::Simulation& simulation, const std::string& path, int width = 1280, int height = 720);

}  // namespace carom::command
