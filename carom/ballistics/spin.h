// What spin does to small-arms bullets, by the formulas of the field (chapter 18.1). Units are those the formulas were
// published in. For artillery shells and for curves instead of fits: shell.h.
#pragma once

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

struct BulletShape {
  double mass = 168;       ///< grains
  double diameter = .308;  ///< in
  double length = 1.215;   ///< in
};

/// Gyroscopic stability S_g = 30 m/(t² d³ l (1 + l²)) (v/2800)^⅓ (density factor); twist t and length l in calibres.
/// `twist` in inches a turn, `speed` in ft/s, `density_ratio` against 1.225 kg/m³ (S_g grows as it falls).
/// D. G. Miller, Precision Shooting, March 2005.
inline double miller_stability(const BulletShape& bullet, double twist, double speed, double density_ratio = 1) {
  const double t = twist / bullet.diameter, l = bullet.length / bullet.diameter, d = bullet.diameter;
  return 30 * bullet.mass / (t * t * d * d * d * l * (1 + l * l)) * math::cbrt(speed / 2800) / density_ratio;
}
/// Drift (in) to the side of the twist after `time` s: 1.25 (S_g + 1.2) t^1.83. B. Litz, Applied Ballistics.
inline double spin_drift(double stability, double time) { return 1.25 * (stability + 1.2) * math::pow(time, 1.83); }
/// Vertical jump (MOA for each mph of crosswind) of a right-hand twist: .01 S_g − .0024 L + .032, L in calibres; up for
/// wind from the right. B. Litz, eq. 5.4.
inline double aerodynamic_jump(double stability, const BulletShape& bullet) {
  return .01 * stability - .0024 * (bullet.length / bullet.diameter) + .032;
}

}  // namespace carom::ballistics
