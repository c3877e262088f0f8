// The plane as a part of space, for mechanics that is written once.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

inline Vec3d in_space(Vec2d v) { return {v.x, v.y, 0}; }
inline Vec3d in_space(Vec2f v) { return {double(v.x), double(v.y), 0}; }
inline Vec3d in_space(const Vec3d& v) { return v; }
inline Vec3d in_space(const Vec3f& v) { return Vec3d(v); }
inline Vec3d turn_in_space(float w) { return {0, 0, double(w)}; }
inline Vec3d turn_in_space(const Vec3f& w) { return Vec3d(w); }
/// cos φ/2 and sin φ/2 from cos φ and sin φ, the greater of them first.
inline Quatd turn_in_space(Rot2f q) {
  const double c = double(q.c), s = double(q.s);
  if (c >= 0) {
    const double w = math::sqrt((1 + c) / 2);
    return normalize(Quatd{w, 0, 0, s / (2 * w)});
  }
  const double z = math::copysign(math::sqrt((1 - c) / 2), s);
  return normalize(Quatd{s / (2 * z), 0, 0, z});
}
inline Quatd turn_in_space(const Quatf& q) { return normalize(Quatd(q)); }

template <class D>
typename D::Position lowered(const Vec3d& v) {
  if constexpr (D::dimension == 2)
    return {v.x, v.y};
  else
    return v;
}
template <class D>
typename D::Angular lowered_turn(const Vec3d& v) {
  if constexpr (D::dimension == 2)
    return float(v.z);
  else
    return Vec3f(v);
}

}  // namespace carom::rigid::detail
