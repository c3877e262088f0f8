// Axis-aligned bounding boxes.
#pragma once

#include "carom/math/transform.h"

namespace carom::geometry {
using namespace math;

/// The set of points between `low` and `high`; empty where low > high.
template <class V>
struct Bounds {
  V low{}, high{};

  constexpr V center() const { return (low + high) * decltype(low.x)(0.5); }
  constexpr V extents() const { return (high - low) * decltype(low.x)(0.5); }
  friend constexpr bool operator==(const Bounds& a, const Bounds& b) { return a.low == b.low && a.high == b.high; }
};
using Bounds2f = Bounds<Vec2f>;
using Bounds2d = Bounds<Vec2d>;
using Bounds3f = Bounds<Vec3f>;
using Bounds3d = Bounds<Vec3d>;

template <class V>
constexpr Bounds<V> merge(const Bounds<V>& a, const Bounds<V>& b) {
  return {min(a.low, b.low), max(a.high, b.high)};
}
template <class T>
constexpr bool overlaps(const Bounds<Vec2<T>>& a, const Bounds<Vec2<T>>& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}
template <class T>
constexpr bool overlaps(const Bounds<Vec3<T>>& a, const Bounds<Vec3<T>>& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}
template <class V>
constexpr bool contains(const Bounds<V>& outer, const Bounds<V>& inner) {
  return min(outer.low, inner.low) == outer.low && max(outer.high, inner.high) == outer.high;
}
template <class T>
constexpr Bounds<Vec2<T>> grow(const Bounds<Vec2<T>>& b, T m) {
  return {b.low - Vec2<T>{m, m}, b.high + Vec2<T>{m, m}};
}
template <class T>
constexpr Bounds<Vec3<T>> grow(const Bounds<Vec3<T>>& b, T m) {
  return {b.low - Vec3<T>{m, m, m}, b.high + Vec3<T>{m, m, m}};
}

/// What a shape may measure, in metres: a radius or half extent from `min_shape_size` to `max_shape_size`, coordinates
/// of vertices at most `max_shape_size` in size. Within these limits no mass or inertia of an ordinary material
/// overflows a float.
inline constexpr double min_shape_size = 1e-6;
inline constexpr double max_shape_size = 1e7;

}  // namespace carom::geometry
