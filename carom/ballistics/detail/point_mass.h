// The acceleration of a point mass, in one place and inline: flights, batches and the aim solver ask for it by the
// hundred thousand.
#pragma once

#include "carom/ballistics/flight.h"

namespace carom::ballistics::detail {

inline math::Vec3d point_mass_acceleration(const Projectile& projectile, const Conditions& conditions,
                                           math::Vec3d position, math::Vec3d velocity) {
  const double height = position.y;
  math::Vec3d a{};
  if (projectile.area_per_mass > 0) {
    const environment::AirColumn::Air air = conditions.air.at(height);
    const math::Vec3d w = velocity - conditions.wind.at(height);
    // What hangs on the height alone is known before the velocity is: the processor does not wait for it.
    const double slowness = 1 / air.speed_of_sound, weight = -0.5 * air.density * projectile.area_per_mass;
    const double speed = math::length(w);
    a = (projectile.drag(speed * slowness) * (weight * speed)) * w;
  }
  switch (conditions.gravity_model) {
    case GravityModel::uniform:
      a.y -= conditions.gravity;
      break;
    case GravityModel::inverse_square:
      a.y -= conditions.gravity * math::square(conditions.earth_radius / (conditions.earth_radius + height));
      break;
    case GravityModel::round_earth: {
      const math::Vec3d r = position + math::Vec3d{0, conditions.earth_radius, 0};
      const double distance = math::length(r);
      a -= (conditions.gravity * math::square(conditions.earth_radius / distance) / distance) * r;
      break;
    }
  }
  return a - 2.0 * math::cross(conditions.rotation, velocity);
}

}  // namespace carom::ballistics::detail
