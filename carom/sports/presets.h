// The balls of many sports as numbers, each with its source and how far it can be trusted (chapters 6.3 and 19).
#pragma once

#include <span>
#include <string_view>

#include "carom/sports/numbers.h"

namespace carom::sports {

struct BallPreset {
  std::string_view name;  ///< "golf"
  std::string_view description;
  std::string_view source;
  double drag_band = 0;  ///< relative half width of what is known of C_D
  double lift_band = 0;  ///< and of C_L; 0 where there is none
  Ball ball{};
};
/// golf, baseball, soccer, tennis, table_tennis, basketball, cricket, bowling, arrow, arrow_large_vanes, shuttlecock,
/// knuckleball, floating_soccer, sphere.
CAROM_API std::span<const BallPreset> ball_presets();
/// Errors name the presets there are.
CAROM_API core::Result<Ball> ball_preset(std::string_view name);

}  // namespace carom::sports
