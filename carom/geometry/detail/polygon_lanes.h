// The corners and the normals of a polygon side by side in lanes.
#pragma once

#include "carom/geometry/shape2.h"
#include "carom/math/simd.h"

namespace carom::geometry::detail::polygon_pair {

using Lanes = WideFloat<4>;

/// The even and the odd ones of eight floats.
CAROM_SIMD_INLINE void part(const float* p, Lanes& even, Lanes& odd) {
  const Lanes low = Lanes::load(p), high = Lanes::load(p + 4);
  even.v = __builtin_shufflevector(low.v, high.v, 0, 2, 4, 6);
  odd.v = __builtin_shufflevector(low.v, high.v, 1, 3, 5, 7);
}
CAROM_SIMD_INLINE float least_of(Lanes a) { return min(min(a[0], a[1]), min(a[2], a[3])); }
CAROM_SIMD_INLINE float greatest_of(Lanes a) { return max(max(a[0], a[1]), max(a[2], a[3])); }

/// Vectors in N·4 lanes; those beyond the last repeat it.
template <int N>
struct Vectors {
  Lanes x[N], y[N];

  CAROM_SIMD_INLINE void load(const Vec2f* from, int count) {
    for (int k = 0; k < N; ++k) {
      part(&from[4 * k].x, x[k], y[k]);
      if (count == 4 * (k + 1)) continue;
      const auto exists = WideInt<4>::lanes() < WideInt<4>::splat(count - 4 * k);
      x[k] = select(exists, x[k], Lanes::splat(from[count - 1].x));
      y[k] = select(exists, y[k], Lanes::splat(from[count - 1].y));
    }
  }
  CAROM_SIMD_INLINE void turn(const Rot2f& q) {
    const Lanes c = Lanes::splat(q.c), s = Lanes::splat(q.s);
    for (int k = 0; k < N; ++k) {
      const Lanes before = x[k];
      x[k] = c * before - s * y[k];
      y[k] = s * before + c * y[k];
    }
  }
  CAROM_SIMD_INLINE void move(const Vec2f& way) {
    for (int k = 0; k < N; ++k) x[k] += Lanes::splat(way.x), y[k] += Lanes::splat(way.y);
  }
  CAROM_SIMD_INLINE Lanes along(int k, const Vec2f& n) const {
    return Lanes::splat(n.x) * x[k] + Lanes::splat(n.y) * y[k];
  }
  CAROM_SIMD_INLINE float least_along(const Vec2f& n) const {
    Lanes least = along(0, n);
    for (int k = 1; k < N; ++k) least = min(least, along(k, n));
    return least_of(least);
  }
};

/// The first of the lanes that holds `value`.
template <int N>
CAROM_SIMD_INLINE int place_of(const Lanes (&a)[N], float value) {
  std::uint32_t where = 1u << (4 * N - 1);
  for (int k = 0; k < N; ++k) where |= bitmask(a[k] == Lanes::splat(value)) << (4 * k);
  return __builtin_ctz(where);
}
template <int N>
CAROM_SIMD_INLINE int lowest_along(const Vectors<N>& a, const Vec2f& n) {
  Lanes d[N];
  Lanes least = d[0] = a.along(0, n);
  for (int k = 1; k < N; ++k) least = min(least, d[k] = a.along(k, n));
  return place_of<N>(d, least_of(least));
}

/// Half the smallest thickness, roughly, of a polygon whose corners and normals these are.
template <int N>
CAROM_SIMD_INLINE float size_of(const Vectors<N>& v, const Vectors<N>& n, const Polygon& p) {
  const Lanes cx = Lanes::splat(p.centroid.x), cy = Lanes::splat(p.centroid.y);
  Lanes least = n.x[0] * (v.x[0] - cx) + n.y[0] * (v.y[0] - cy);
  for (int k = 1; k < N; ++k) least = min(least, n.x[k] * (v.x[k] - cx) + n.y[k] * (v.y[k] - cy));
  return least_of(least) + p.radius;
}

}  // namespace carom::geometry::detail::polygon_pair
