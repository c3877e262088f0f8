// When a point on a parabola first comes within `reach` of something convex.
//
// d(t) = d + v t + h t² is the way from the nearest point of the obstacle. Along the unit vector n = d/|d| the distance
// is bounded from below by the projection n·d(t), a quadratic of the time, because what is convex lies behind the plane
// through its nearest point. So the first moment at which that quadratic falls to `reach` cannot be later than the
// contact, and stepping to it again and again approaches the contact from before: never past the first root, and
// quadratically, since the bound touches the distance to first order (conservative advancement, Mirtich 1996, with
// quadratic instead of constant bounds). A grazing contact converges by halves. No coefficients of a quartic are
// formed, so nothing cancels.
#pragma once

#include <limits>

#include "carom/math/vec.h"

namespace carom::sports::detail {

/// m: what is nearer than this touches.
inline constexpr double touching = 4e-13;

/// The first time in [0, limit) at which the moving point, approaching, is within `reach` of the obstacle; infinity if
/// there is none. `offset(p)` gives the vector to p from the obstacle's nearest point. Whoever is within reach already
/// and goes away is outside; whoever is within reach and approaches meets it at 0.
template <class Vec, class Offset>
inline double first_contact(Vec p, Vec v, Vec h, double reach, double limit, Offset&& offset) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double t = 0;
  for (int i = 0; i < 80; ++i) {
    const Vec d = offset(p + t * (v + t * h));
    const Vec w = v + (2 * t) * h;
    const double r = math::sqrt(dot(d, d)), gap = r - reach;
    const double b = dot(d, w), c = dot(d, h);
    double step;
    if (gap <= touching) {
      if (b < 0 || (b == 0 && c < 0)) return t;
      if (c >= 0) return none;
      step = -b / c;
    } else {
      if (b >= 0 && c >= 0) return none;
      // r times the quadratic g + b τ + c τ².
      const double g = gap * r, left = limit - t;
      if (g + math::min(b, 0.0) * left + math::min(c, 0.0) * left * left > 0) return none;
      const double root = b * b - 4 * c * g;
      if (root <= 0 && c > 0) return none;
      const double s = math::sqrt(root);
      step = b < 0 ? 2 * g / (s - b) : (b + s) / (-2 * c);
    }
    t += step;
    if (!(t < limit)) return none;
  }
  // It grazes: halved eighty times it is as near as doubles can tell.
  const Vec d = offset(p + t * (v + t * h));
  return math::sqrt(dot(d, d)) - reach <= 1e-12 && dot(d, v + (2 * t) * h) < 0 ? t : none;
}

/// The obstacle is the origin.
template <class Vec>
inline double first_contact(Vec d, Vec v, Vec h, double reach, double limit) {
  return first_contact(d, v, h, reach, limit, [](Vec x) { return x; });
}

/// The first time in [0, limit) at which s + v t + h t² comes down to zero (from above, or from within `slack` of it).
inline double first_descent(double s, double v, double h, double limit) {
  constexpr double none = std::numeric_limits<double>::infinity(), slack = 1e-9;
  if (s + math::min(v, 0.0) * limit + math::min(h, 0.0) * limit * limit > 0) return none;
  double t = none;
  if (s > touching) {
    const double root = v * v - 4 * h * s;
    if (h < 0)
      t = v < 0 ? 2 * s / (math::sqrt(root) - v) : (v + math::sqrt(root)) / (-2 * h);
    else if (v < 0 && root > 0)
      t = 2 * s / (math::sqrt(root) - v);
  } else if (s > -slack) {
    if (v < 0 || (v == 0 && h < 0))
      t = 0;
    else if (h < 0)
      t = v / -h;
  } else if (h < 0 && v > 0) {
    const double root = v * v - 4 * h * s;
    if (root > 0) t = (v + math::sqrt(root)) / (-2 * h);
  }
  return t < limit ? t : none;
}

}  // namespace carom::sports::detail
