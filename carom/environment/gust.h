// Single gusts of the shape 1 − cos, and what the rules for aircraft ask for.
#pragma once

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

/// A wall of air across `direction` that rises from nothing to `velocity` over `gradient_distance` m as
/// ½ (1 − cos(π s/H)) and falls again over the next (14 CFR 25.341), or stays (MIL-F-8785C 3.7.3).
struct Gust {
  math::Vec3d velocity{};          ///< m/s, the peak
  math::Vec3d direction{1, 0, 0};  ///< unit vector, the way it travels: the gust lies behind its front
  double front = 0;                ///< m: dot(direction, x) of the front at time 0
  double gradient_distance = 50;   ///< m, H > 0: from nothing to the peak
  double speed = 0;                ///< m/s, of its travel
  bool lasting = false;            ///< stays at the peak
};
/// The gust's part of the wind at a place and time (m/s).
inline math::Vec3d gust_at(const Gust& gust, math::Vec3d point, double time) {
  // s: how deep in the gust the point is.
  const double s = gust.front + gust.speed * time - math::dot(gust.direction, point);
  const double h = gust.gradient_distance;
  if (!(s > 0)) return {};
  if (s >= h && gust.lasting) return gust.velocity;
  if (s >= 2 * h) return {};
  return gust.velocity * (0.5 * (1 - math::cos(math::pi * s / h)));
}

/// Design gust speed of 14 CFR 25.341(a)(5)(i), m/s equivalent airspeed, by altitude (m): 17.07 at sea level, 13.41 at
/// 4572 m, 6.36 at 18 288 m, linear between, for the flight profile factor 1 and H (m, 9 … 107):
/// U_ds = U_ref (H/107)^(1/6).
inline double design_gust_speed(double altitude, double gradient_distance) {
  const double low = math::clamp(altitude / 4572, 0.0, 1.0);
  const double high = math::clamp((altitude - 4572) / (18288 - 4572.0), 0.0, 1.0);
  const double reference = 17.07 + low * (13.41 - 17.07) + high * (6.36 - 13.41);
  return reference * math::pow(gradient_distance / 107, 1.0 / 6);
}

}  // namespace carom::environment
