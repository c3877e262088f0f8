// The acceleration of a point mass, roughly: what the aim solver's paths feel before their error is measured.
#pragma once

#include "carom/ballistics/detail/point_mass.h"

namespace carom::ballistics::detail {

/// By DragCurve::roughly: half the time of a step, which is one long chain of such questions.
class RoughPull {
 public:
  RoughPull(const Projectile& projectile, const Conditions& conditions)
      : drag_(projectile.drag),
        conditions_(conditions),
        half_area_(0.5 * projectile.area_per_mass),
        plain_(only_height_matters(conditions)) {}

  [[gnu::always_inline]] math::Vec3d at(math::Vec3d position, math::Vec3d velocity) const {
    const environment::AirColumn::Air air = conditions_.air.at(position.y);
    const math::Vec3d w = velocity - conditions_.wind.at(position.y);
    // What hangs on the height alone is known before the velocity is, and the root while the cell is found.
    const double slow = 1 / math::square(air.speed_of_sound), weight = -half_area_ * air.density;
    const double square = math::length_squared(w);
    math::Vec3d a = weight * math::sqrt(square) * drag_.roughly(square * slow).coefficient * w;
    if (!plain_) return a + beside_drag(conditions_, position, velocity);
    a.y -= conditions_.gravity;
    return a;
  }

 private:
  const DragCurve& drag_;
  const Conditions& conditions_;
  double half_area_ = 0;  // m²/kg
  bool plain_;            // nothing beside drag but gravity, the same everywhere
};

}  // namespace carom::ballistics::detail
