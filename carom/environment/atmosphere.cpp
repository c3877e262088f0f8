#include "carom/environment/atmosphere.h"

#include <array>

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

namespace detail {

constexpr double earth_radius = 6356766.0, gas_constant = 287.05287, gravity = 9.80665, gamma = 1.4;
constexpr double sutherland_beta = 1.458e-6, sutherland_temperature = 110.4;

struct Layer {
  double base;         // m, geopotential
  double lapse;        // K/m
  double temperature;  // K at the base
  double pressure;     // Pa at the base
};

/// Table 4 of the standard; pressures at the bases by the same formulas as between them.
std::array<Layer, 7> make_layers() {
  std::array<Layer, 7> layers = {{{0, -0.0065, 288.15, 101325},
                                  {11000, 0, 0, 0},
                                  {20000, 0.001, 0, 0},
                                  {32000, 0.0028, 0, 0},
                                  {47000, 0, 0, 0},
                                  {51000, -0.0028, 0, 0},
                                  {71000, -0.002, 0, 0}}};
  for (std::size_t i = 1; i < layers.size(); ++i) {
    const Layer& below = layers[i - 1];
    const double dh = layers[i].base - below.base;
    layers[i].temperature = below.temperature + below.lapse * dh;
    layers[i].pressure = below.lapse == 0
                             ? below.pressure * math::exp(-gravity * dh / (gas_constant * below.temperature))
                             : below.pressure * math::pow(below.temperature / layers[i].temperature,
                                                          gravity / (gas_constant * below.lapse));
  }
  return layers;
}

}  // namespace detail

double geopotential_altitude(double z) { return detail::earth_radius * z / (detail::earth_radius + z); }
double geometric_altitude(double h) { return detail::earth_radius * h / (detail::earth_radius - h); }

AirState standard_atmosphere_geopotential(double altitude, const AtmosphereOffset& offset) {
  static const std::array<detail::Layer, 7> layers = detail::make_layers();
  constexpr double lowest = -5003.930, highest = 84852.046;  // geometric −5 km and 86 km
  const double h = math::clamp(altitude, lowest, highest);
  std::size_t i = layers.size() - 1;
  while (i > 0 && h < layers[i].base) --i;
  const detail::Layer& layer = layers[i];
  const double dh = h - layer.base;
  const double standard_temperature = layer.temperature + layer.lapse * dh;
  AirState air;
  air.pressure = layer.lapse == 0
                     ? layer.pressure * math::exp(-detail::gravity * dh / (detail::gas_constant * layer.temperature))
                     : layer.pressure * math::pow(layer.temperature / standard_temperature,
                                                  detail::gravity / (detail::gas_constant * layer.lapse));
  if (altitude > highest)
    air.pressure *= math::exp(-detail::gravity * (altitude - highest) / (detail::gas_constant * standard_temperature));
  air.pressure *= offset.sea_level_pressure / 101325.0;
  air.temperature = math::max(standard_temperature + offset.temperature, 1.0);
  // Water vapour has .622 of the molar mass of dry air; γ is taken as that of dry air.
  const double vapour = offset.relative_humidity * saturation_vapour_pressure(air.temperature);
  air.density = (air.pressure - 0.378 * math::min(vapour, air.pressure)) / (detail::gas_constant * air.temperature);
  air.speed_of_sound = math::sqrt(detail::gamma * air.pressure / air.density);
  air.viscosity = detail::sutherland_beta * air.temperature * math::sqrt(air.temperature) /
                  (air.temperature + detail::sutherland_temperature);
  return air;
}

double saturation_vapour_pressure(double temperature) {
  const double celsius = temperature - 273.15;
  return celsius > -100 ? 611.21 * math::exp(17.502 * celsius / (240.97 + celsius)) : 0;
}

AirState standard_atmosphere(double altitude, const AtmosphereOffset& offset) {
  return standard_atmosphere_geopotential(geopotential_altitude(math::max(altitude, -5000.0)), offset);
}

}  // namespace carom::environment
