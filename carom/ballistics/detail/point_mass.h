// The acceleration of a point mass, in one place and inline: flights, batches and the aim solver ask for it by the
// hundred thousand.
#pragma once

#include "carom/ballistics/flight.h"

namespace carom::ballistics::detail {

/// Gravity and what the turning of the frame adds.
inline math::Vec3d beside_drag(const Conditions& conditions, math::Vec3d position, math::Vec3d velocity) {
  math::Vec3d a{};
  switch (conditions.gravity_model) {
    case GravityModel::uniform:
      a.y -= conditions.gravity;
      break;
    case GravityModel::inverse_square:
      a.y -= conditions.gravity * math::square(conditions.earth_radius / (conditions.earth_radius + position.y));
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

/// Gravity is uniform and the frame does not turn: of the position the height alone matters.
inline bool only_height_matters(const Conditions& conditions) {
  return conditions.gravity_model == GravityModel::uniform && conditions.rotation == math::Vec3d{};
}

/// Of one projectile under one set of conditions, for loops: what does not change is decided before them.
class PointMassPull {
 public:
  PointMassPull(const Projectile& projectile, const Conditions& conditions)
      : projectile_(projectile),
        conditions_(conditions),
        half_area_(0.5 * projectile.area_per_mass),
        plain_(only_height_matters(conditions)) {}

  math::Vec3d operator()(math::Vec3d position, math::Vec3d velocity) const {
    return plain_ ? at<true>(position, velocity) : at<false>(position, velocity);
  }
  template <bool Plain>
  [[gnu::always_inline]] math::Vec3d at(math::Vec3d position, math::Vec3d velocity) const {
    math::Vec3d a{};
    if (half_area_ > 0) {
      const environment::AirColumn::Air air = conditions_.air.at(position.y);
      const math::Vec3d w = velocity - conditions_.wind.at(position.y);
      // What hangs on the height alone is known before the velocity is: the processor does not wait for it.
      const double slowness = 1 / air.speed_of_sound, weight = -half_area_ * air.density;
      const double speed = math::length(w);
      a = (projectile_.drag(speed * slowness) * (weight * speed)) * w;
    }
    return beside<Plain>(a, position, velocity);
  }

 private:
  template <bool Plain>
  [[gnu::always_inline]] math::Vec3d beside(math::Vec3d a, math::Vec3d position, math::Vec3d velocity) const {
    if constexpr (!Plain) return a + beside_drag(conditions_, position, velocity);
    a.y -= conditions_.gravity;
    return a;
  }
  const Projectile& projectile_;
  const Conditions& conditions_;
  double half_area_ = 0;  // m²/kg
  bool plain_ = true;
};

inline math::Vec3d point_mass_acceleration(const Projectile& projectile, const Conditions& conditions,
                                           math::Vec3d position, math::Vec3d velocity) {
  return PointMassPull(projectile, conditions)(position, velocity);
}

}  // namespace carom::ballistics::detail
