// Rockets of carom/ballistics from preset files: {"description", "source", "values": {name: quantity, "stages": […]}}.
#pragma once

#include "carom/ballistics/rocket.h"
#include "carom/scene/weapon_presets.h"

namespace carom::scene {

/// presets/rocket/NAME.json: "diameter", "length", "nose_length"; "drag_coefficient" and "coasting_drag_coefficient"
/// (the same where it is not given), or "drag_table" and "coasting_drag_table" instead (Mach number, C_D, …);
/// "fin_count", "fin_root_chord", "fin_tip_chord", "fin_span", "fin_sweep", "fin_position"; "parachute_drag_area",
/// "parachute_height", "parachute_delay"; and "stages", the first to burn first, each with "motor" (a file of
/// presets/motor, asked of `resolver` as "presets/motor/NAME.eng"), "designation" (which motor of the file; its first
/// where it is not given), "dry_mass", "dry_centre", "motor_centre", "ignition_delay", "separation_delay". Errors name
/// file, line, value, what was found and what was expected.
CAROM_API core::Result<ballistics::Rocket> parse_rocket(std::string_view text, std::string_view file,
                                                        const PresetResolver& resolver);

}  // namespace carom::scene
