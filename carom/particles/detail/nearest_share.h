// Where a triangle is nearest to a point.
#pragma once

#include "carom/math/vec.h"

namespace carom::particles::detail {

/// The shares of the corners at the point of a triangle that is nearest to `p` from its first corner (Ericson,
/// "Real-Time Collision Detection", 2005, 5.1.5).
inline math::Vec3f nearest_share(math::Vec3f u, math::Vec3f v, math::Vec3f p) {
  const float d1 = dot(u, p), d2 = dot(v, p);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const math::Vec3f pb = p - u, pc = p - v;
  const float d3 = dot(u, pb), d4 = dot(v, pb);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const float d5 = dot(u, pc), d6 = dot(v, pc);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const float t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const float t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const float t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const float inverse = 1 / (va + vb + vc);
  return {va * inverse, vb * inverse, vc * inverse};
}

}  // namespace carom::particles::detail
