// Constant acceleration solved for whatever is missing (chapter 2.2).
#pragma once

#include <optional>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::forces {

/// Displacement s (m), initial velocity u and final velocity v (m/s), acceleration a (m/s²), time t (s).
struct ConstantAcceleration {
  double displacement = 0, initial_velocity = 0, final_velocity = 0, acceleration = 0, time = 0;
};
/// Exactly three of the five.
struct KnownMotion {
  std::optional<double> displacement, initial_velocity, final_velocity, acceleration, time;
};
struct MotionSolutions {
  ConstantAcceleration motion[2];
  int count = 0;  ///< solutions with t ≥ 0 come first, the sooner first
};

/// v = u + at; s = ut + ½at²; v² = u² + 2as; s = ½(u + v)t. Errors: not three numbers, one that is not finite, no
/// motion that fits them, or infinitely many.
CAROM_API core::Result<MotionSolutions> solve_constant_acceleration(const KnownMotion& known);

/// The greatest violation of the five equations, relative to the sizes in them: for checking.
CAROM_API double residual(const ConstantAcceleration& motion);

}  // namespace carom::forces
