// How games are played, from preset files: {"description", "source", "values": {name: quantity}}.
#pragma once

#include <string_view>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/sports/game_presets.h"

namespace carom::scene {

// Errors name file, line, value, what was found and what was expected; `file` is how they call the text.
/// presets/pitch/NAME.json: "speed", "elevation", "azimuth", "spin", "tilt", "gyro", "release_height", "release_side".
CAROM_API core::Result<sports::Pitch> parse_pitch(std::string_view text, std::string_view file);
/// presets/bat/NAME.json: "effective_mass", "radius", "restitution", "friction", "tangential_restitution".
CAROM_API core::Result<sports::Bat> parse_bat(std::string_view text, std::string_view file);
/// presets/cricket/NAME.json: "speed", "elevation", "azimuth", "spin", "tilt", "gyro", "seam", "height", "side".
CAROM_API core::Result<sports::CricketDelivery> parse_cricket_delivery(std::string_view text, std::string_view file);
/// presets/bowling_ball/NAME.json: "mass", "radius", "gyration", "cover".
CAROM_API core::Result<sports::BowlingBall> parse_bowling_ball(std::string_view text, std::string_view file);
/// presets/bowling/NAME.json: "speed", "angle", "spin", "axis_rotation", "start".
CAROM_API core::Result<sports::Delivery> parse_bowling_delivery(std::string_view text, std::string_view file);
/// presets/lane/NAME.json: "length", "width", "gravity", and "stretches", a list of {"end", "friction"}.
CAROM_API core::Result<sports::Lane> parse_lane(std::string_view text, std::string_view file);
/// presets/swing/NAME.json: "plane", "gravity", "impact" (head_below_hub, club_vertical or ball), "ball", "hub" (pairs
/// of s and m/s²), "shaft" {"frequency", "damping_ratio", "head_mass", "shaft_mass"}, and "links", two to four of
/// {"mass", "length", "centre", "inertia", "angle", "rate", "torque" (pairs of s and N m), "hold" ("free", "opens" or a
/// time)}.
CAROM_API core::Result<sports::Swing> parse_swing(std::string_view text, std::string_view file);

}  // namespace carom::scene
