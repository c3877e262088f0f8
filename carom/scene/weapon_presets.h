// Guns, ammunition, sights and walls of carom/ballistics from preset files: {"description", "source", "values":
// {name: quantity or name}}; a wall's values are a list, a layer each.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "carom/ballistics/shell.h"
#include "carom/ballistics/weapon.h"
#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::scene {

/// Gives the text of presets/KIND/NAME.json.
using PresetResolver = std::function<core::Result<std::string>(std::string_view path)>;

// Errors name file, line, value, what was found and what was expected; `file` is how they call the text.
/// presets/ammunition/NAME.json: "drag_function" (by name), "drag_coefficient" or "drag_table" (Mach number, C_D, …),
/// "ballistic_coefficient", "ballistic_coefficients" (Mach number, lb/in², …) or none (then by mass, diameter and
/// form_factor), "mass", "diameter", "length", "muzzle_speed", "speed_deviation",
/// "powder_mass", "gas_speed"; "shell" by name, asked of `resolver` as "presets/shell/NAME.json".
CAROM_API core::Result<ballistics::Ammunition> parse_ammunition(std::string_view text, std::string_view file,
                                                                const PresetResolver& resolver = {});
/// presets/sight/NAME.json: "height", "offset", "click", "spacing", "magnification", "parallax_free".
CAROM_API core::Result<ballistics::Sight> parse_sight(std::string_view text, std::string_view file);
/// presets/gun/NAME.json: "ammunition" and "sight" by name, asked of `resolver` as "presets/ammunition/NAME.json"; the
/// numbers of a Weapon and, as "mount_…", of its mount.
CAROM_API core::Result<ballistics::Weapon> parse_gun(std::string_view text, std::string_view file,
                                                     const PresetResolver& resolver);
/// presets/shell/NAME.json: "mass", "diameter", "axial_inertia", "transverse_inertia", "twist" (calibres a turn),
/// "length" and "centre" of its body where they are told, and "aerodynamics", a list of rows by rising Mach number:
/// "mach" and the coefficients by their names in a ShellCoefficients, 0 where they are not given (but for
/// "overturning").
CAROM_API core::Result<ballistics::Shell> parse_shell(std::string_view text, std::string_view file);
/// presets/wall/NAME.json: layers from the side of the shooter.
CAROM_API core::Result<std::vector<ballistics::Layer>> parse_wall(std::string_view text, std::string_view file);

}  // namespace carom::scene
