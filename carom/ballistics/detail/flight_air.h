// The air as flights meet it that are not asked by the hundred thousand: the wind may be a field of place and time.
#pragma once

#include "carom/ballistics/detail/point_mass.h"

namespace carom::ballistics::detail {

inline constexpr double longest_field_step = 0.02;  ///< s: a narrow gust must not lie between two steps

/// m/s, `time` s after the flight began.
inline math::Vec3d wind_of(const Conditions& conditions, math::Vec3d position, double time) {
  if (conditions.field) return conditions.field(position, conditions.field_time + time);
  return conditions.wind.at(position.y);
}

/// Of drag alone, at the velocity w through the air.
inline math::Vec3d drag_acceleration(const Projectile& projectile, const environment::AirColumn::Air& air,
                                     math::Vec3d w) {
  if (!(projectile.area_per_mass > 0)) return {};
  const double speed = math::length(w);
  return (-0.5 * projectile.area_per_mass * air.density * projectile.drag(speed / air.speed_of_sound) * speed) * w;
}

inline math::Vec3d flight_acceleration(const Projectile& projectile, const Conditions& conditions, math::Vec3d position,
                                       math::Vec3d velocity, double time) {
  if (!conditions.field) return point_mass_acceleration(projectile, conditions, position, velocity);
  return drag_acceleration(projectile, conditions.air.at(position.y), velocity - wind_of(conditions, position, time)) +
         beside_drag(conditions, position, velocity);
}

}  // namespace carom::ballistics::detail
