// The U.S. Standard Atmosphere 1976 up to 86 km.
#pragma once

#include "carom/export.h"

namespace carom::environment {

struct AirState {
  double temperature = 288.15;      ///< K (molecular-scale)
  double pressure = 101325;         ///< Pa
  double density = 1.225;           ///< kg/m³
  double speed_of_sound = 340.294;  ///< m/s
  double viscosity = 1.7894e-5;     ///< Pa·s, dynamic
};

/// A day that differs from the standard one: everywhere warmer or colder, pressure altitude by another setting.
struct AtmosphereOffset {
  double temperature = 0;              ///< K, added at every height
  double sea_level_pressure = 101325;  ///< Pa (QNH)
  double relative_humidity = 0;  ///< 0 … 1, the same at every height; damp air is lighter and carries sound faster
};

/// H = r₀Z/(r₀ + Z) with r₀ = 6 356 766 m, and back.
CAROM_API double geopotential_altitude(double geometric);
CAROM_API double geometric_altitude(double geopotential);

/// Air at the geometric altitude Z (m). Exact to the standard for −5 km ≤ Z ≤ 86 km; lower altitudes give the values at
/// −5 km, higher ones go on isothermally from 86 km, which the standard does not.
/// Source: U.S. Standard Atmosphere, 1976, equations 33, 42, 50, 51 (NOAA-S/T 76-1562); constants R = 287.05287,
/// g₀ = 9.80665, γ = 1.4, Sutherland β = 1.458e-6, S = 110.4.
CAROM_API AirState standard_atmosphere(double altitude, const AtmosphereOffset& offset = {});
/// The same by geopotential altitude H (m).
CAROM_API AirState standard_atmosphere_geopotential(double altitude, const AtmosphereOffset& offset = {});
/// Pressure (Pa) of water vapour over water at saturation; temperature in K. A. L. Buck, J. Appl. Meteorol. 20 (1981)
/// 1527–1532, e_w1: within .2 % from −40 to 50 °C.
CAROM_API double saturation_vapour_pressure(double temperature);

}  // namespace carom::environment
