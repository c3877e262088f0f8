#include "carom/environment/water.h"

#include "carom/math/elementary.h"

namespace carom::environment {
using math::Vec3d;

namespace detail {
constexpr double wave_number(double wavelength) { return 2 * math::pi / wavelength; }
}  // namespace detail

double wave_frequency(double wavelength, double gravity) {
  return math::sqrt(gravity * detail::wave_number(wavelength));
}
double wave_speed(double wavelength, double gravity) { return math::sqrt(gravity / detail::wave_number(wavelength)); }

double surface_height(const Water& water, double x, double z, double time) {
  double height = water.level;
  for (const Wave& wave : water.waves) {
    const double k = detail::wave_number(wave.wavelength), omega = math::sqrt(water.gravity * k);
    const double along = (wave.direction_x * x + wave.direction_z * z) * k;
    height += wave.amplitude * math::sin(along - omega * time + wave.phase);
  }
  return height;
}

WaterPoint sample(const Water& water, Vec3d point, double time) {
  WaterPoint result;
  result.height = water.level;
  result.velocity = water.current;
  const double depth = math::min(point.y - water.level, 0.0);  // the mean level stands for the surface, to first order
  double slope_x = 0, slope_z = 0;
  for (const Wave& wave : water.waves) {
    const double k = detail::wave_number(wave.wavelength), omega = math::sqrt(water.gravity * k);
    const double along = (wave.direction_x * point.x + wave.direction_z * point.z) * k;
    const math::SinCos<double> phase = math::sincos(along - omega * time + wave.phase);
    const double slope = wave.amplitude * k * phase.cos;
    result.height += wave.amplitude * phase.sin;
    slope_x += slope * wave.direction_x;
    slope_z += slope * wave.direction_z;
    const double speed = wave.amplitude * omega * math::exp(k * depth);
    result.velocity += speed * Vec3d{wave.direction_x * phase.sin, -phase.cos, wave.direction_z * phase.sin};
    result.acceleration -= speed * omega * Vec3d{wave.direction_x * phase.cos, phase.sin, wave.direction_z * phase.cos};
  }
  result.normal = math::normalize(Vec3d{-slope_x, 1, -slope_z});
  return result;
}

}  // namespace carom::environment
