// Balls, surfaces and club heads of carom/sports from preset files: {"description", "source", "values": {name:
// quantity}}.
#pragma once

#include <string_view>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/sports/numbers.h"

namespace carom::scene {

/// presets/flight/NAME.json. Values are quantities with units ("45.93 g") or plain numbers, "side_kind" and
/// "lift_shape" by name. Errors name file, line, value, what was found and what was expected; `file` is how they call
/// the text.
CAROM_API core::Result<sports::Ball> parse_ball(std::string_view text, std::string_view file);
/// presets/surface/NAME.json.
CAROM_API core::Result<sports::Surface> parse_surface(std::string_view text, std::string_view file);
/// presets/club/NAME.json.
CAROM_API core::Result<sports::ClubHead> parse_club(std::string_view text, std::string_view file);

}  // namespace carom::scene
