// Moving air: a steady wind and its profile over height.
#pragma once

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

enum class WindProfile {
  uniform,
  power,        ///< v(h) = v_ref (h/h_ref)^exponent: Hellmann; 1/7 over open land
  logarithmic,  ///< v(h) = v_ref ln(h/z₀)/ln(h_ref/z₀): neutral surface layer
};

/// Wind velocity at the reference height, and how it changes with height.
struct Wind {
  math::Vec3d velocity{};  ///< m/s, where the air goes to
  WindProfile profile = WindProfile::uniform;
  double reference_height = 10;  ///< m
  double exponent = 1.0 / 7;
  double roughness_length = 0.03;  ///< m, z₀: .0002 open sea, .03 grass, .5 suburb
};

/// Velocity (m/s) at `height` m above the ground; still at and below the ground, except where uniform.
inline math::Vec3d wind_at(const Wind& wind, double height) {
  if (wind.profile == WindProfile::uniform) return wind.velocity;
  if (wind.profile == WindProfile::power)
    return height > 0 ? wind.velocity * math::pow(height / wind.reference_height, wind.exponent) : math::Vec3d{};
  if (!(height > wind.roughness_length)) return {};
  return wind.velocity *
         (math::log(height / wind.roughness_length) / math::log(wind.reference_height / wind.roughness_length));
}

}  // namespace carom::environment
