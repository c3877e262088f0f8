// Water: flat, or a sum of deep-water sine waves (Airy). The y axis is up.
#pragma once

#include <span>

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::environment {

/// One long-crested wave that travels toward (direction_x, direction_z).
struct Wave {
  double amplitude = 0;                     ///< m, half the height from trough to crest
  double wavelength = 10;                   ///< m, > 0
  double phase = 0;                         ///< rad
  double direction_x = 1, direction_z = 0;  ///< unit vector in the horizontal plane
};

/// η(x, z, t) = level + Σ a sin(k·x − ω t + φ), ω² = g k (deep water: depth above half a wavelength). First order
/// in the steepness a·k, so keep that below about 0.1.
struct Water {
  double level = 0;               ///< m
  std::span<const Wave> waves{};  ///< must outlive the Water
  math::Vec3d current{};          ///< m/s
  double density = 1025;          ///< kg/m³
  double gravity = 9.80665;       ///< m/s²
};

struct WaterPoint {
  double height = 0;            ///< m: y of the surface above or below the point asked for
  math::Vec3d normal{0, 1, 0};  ///< of the surface there, upward
  math::Vec3d velocity{};       ///< m/s of the water at the point (at the surface for points above it)
  math::Vec3d acceleration{};   ///< m/s²
};

/// The water at (x, y, z) at time t. Orbital motion decays with e^{k(y − level)} below the mean level.
CAROM_API WaterPoint sample(const Water& water, math::Vec3d point, double time);
/// The height of the surface alone.
CAROM_API double surface_height(const Water& water, double x, double z, double time);

/// ω = √(g k), rad/s, and phase speed √(g/k), m/s, of a deep-water wave.
CAROM_API double wave_frequency(double wavelength, double gravity = 9.80665);
CAROM_API double wave_speed(double wavelength, double gravity = 9.80665);

}  // namespace carom::environment
