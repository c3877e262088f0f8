// The balls of many sports as numbers, each with its source and how far it can be trusted (chapters 6.3 and 19).
#pragma once

#include <span>
#include <string_view>

#include "carom/sports/ball.h"

namespace carom::sports {

struct BallPreset {
  std::string_view name;  ///< "golf"
  std::string_view description;
  std::string_view source;
  double drag_band = 0;  ///< relative half width of what is known of C_D
  double lift_band = 0;  ///< and of C_L; 0 where there is none
  Ball ball{};
};
/// golf, baseball, soccer, tennis, table_tennis, basketball, cricket, bowling, arrow, shuttlecock, knuckleball,
/// floating_soccer, sphere.
CAROM_API std::span<const BallPreset> ball_presets();
/// Errors name the presets there are.
CAROM_API core::Result<Ball> ball_preset(std::string_view name);

/// A number with its name, as a file holds it: "drag_crisis", SI.
struct Number {
  std::string_view name;
  double value = 0;
};
/// A ball from named numbers; those that are not named stay as in a `Ball`. `side` says which side force, by the names
/// none, held_seam, turning_seam, wandering_wake. Errors: an unknown name, a number named twice, or one that cannot be.
CAROM_API core::Result<Ball> ball_from_numbers(std::span<const Number> numbers, std::string_view side = "none");
/// Names and units of the numbers, for readers and schemas.
struct NumberName {
  std::string_view name, unit;
};
CAROM_API std::span<const NumberName> ball_number_names();
/// The numbers of a ball, in the order of the names.
CAROM_API std::vector<double> ball_numbers(const Ball& ball);

}  // namespace carom::sports
