// What a file or a user may know of a projectile's drag, and the projectile that it makes.
#pragma once

#include "carom/ballistics/flight.h"

namespace carom::ballistics {

/// One of `function`, `coefficient` and `table`; beside a function or a table a ballistic coefficient or several, or
/// none: then mass and diameter tell how much drag slows it.
struct DragData {
  std::optional<DragFunction> function{};
  std::optional<double> coefficient{};            ///< C_D at every speed, ≥ 0
  std::vector<DragPoint> table{};                 ///< by rising Mach number, smooth in between
  std::optional<double> ballistic_coefficient{};  ///< lb/in², > 0
  std::vector<BallisticCoefficientBand> bands{};  ///< instead of one coefficient, by rising Mach number
  double form_factor = 1;                         ///< multiplies the drag, > 0
};

/// `mass` (kg) and `diameter` (m) are needed where there is no ballistic coefficient. Errors name what is missing, too
/// much or out of range, by the names of the fields of preset and scene files: drag_function, drag_coefficient,
/// drag_table, ballistic_coefficient, ballistic_coefficients, form_factor, mass, diameter.
CAROM_API core::Result<Projectile> projectile_from(const DragData& data, double mass, double diameter);

}  // namespace carom::ballistics
