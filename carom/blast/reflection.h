// A shock that meets the ground at an angle: regular and Mach reflection in air as an ideal gas, γ = 1.4
// (chapter 18.6).
//
// Regular: incident and reflected shock meet at the ground, and the second turns the flow back along it (two-shock
// theory; R. Courant & K. O. Friedrichs, Supersonic Flow and Shock Waves, 1948, chapter IV). Where no reflected shock
// can turn it so far, both run together above the ground and a third, the Mach stem, goes down to it square
// (three-shock theory, the same, the stem straight). In waves too weak for a triple point of that theory
// the stem's strength is that of a shock that changes its area along rays: G. B. Whitham, A new approach to problems of
// shock dynamics, J. Fluid Mech. 2 (1957) 145. Real air is hotter and reflects more where P_s is above some 700 kPa.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::blast {

struct ShockReflection {
  double factor = 1;      ///< peak overpressure at the ground by that of the incident shock
  bool mach = false;      ///< a stem stands on the ground
  double stem_angle = 0;  ///< rad, of the path of the stem's upper end above the ground; 0 where there is none
};
/// `side_on`: Pa above `ambient`, of the incident shock; `incidence`: rad between its way and the ground's normal, 0
/// (square on: 2 for weak, 8 for strong shocks) … π/2 (along the ground: 1). Errors: out of these, or side_on ≤ 0.
CAROM_API core::Result<ShockReflection> reflect(double side_on, double incidence, double ambient = 101325);

/// The greatest incidence (rad) of regular reflection: 39.97° of strong shocks, more of weak ones.
CAROM_API double greatest_regular_incidence(double side_on, double ambient = 101325);

}  // namespace carom::blast
