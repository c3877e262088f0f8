// Where shots fall about the mark, and how likely they hit (chapter 18.2).
#pragma once

#include "carom/ballistics/sights.h"

namespace carom::ballistics {

/// Gaussian σ of each axis → radius of half the shots (√(2 ln 2) σ), mean radius (√(π/2) σ).
constexpr double circular_error_probable(double sigma) { return 1.1774100225154747 * sigma; }
constexpr double mean_radius(double sigma) { return 1.2533141373155003 * sigma; }

/// Shots with the mean (m) off the centre and σ (m) across and up, uncorrelated.
struct Spread {
  math::Vec2d mean{}, sigma{};
};
/// Probability to hit a rectangle of half extents (m) about the centre: exact.
CAROM_API double hit_probability(const Spread& spread, math::Vec2d half_extents);
/// Probability to hit a circle about the centre; by quadrature, to 1e-7.
CAROM_API double hit_probability(const Spread& spread, double radius);

/// Standard deviations of what varies from shot to shot.
struct ShotVariation {
  double muzzle_speed = 0;  ///< m/s
  double wind = 0;          ///< m/s, across
  double aim = 0;           ///< rad, each axis: gun, ammunition and shooter
  double range = 0;         ///< m, error of the estimated distance
};
/// The spread at a distance (m) of a gun aimed by `aiming`, by the derivatives of the flight. Errors as `fire`; or the
/// shot does not get there.
CAROM_API core::Result<Spread> spread_at(const Gun& gun, const Conditions& conditions, const Aiming& aiming,
                                         double distance, const ShotVariation& variation);

}  // namespace carom::ballistics
