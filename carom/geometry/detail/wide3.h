// Vectors of three in lanes, for the kernels of triangles.
#pragma once

#include "carom/math/simd.h"
#include "carom/math/vec.h"

namespace carom::geometry::detail {
inline namespace CAROM_SIMD_NAMESPACE {

template <int W>
struct Wide3 {
  using F = math::WideFloat<W>;
  F x, y, z;

  CAROM_SIMD_INLINE static Wide3 splat(const math::Vec3f& v) { return {F::splat(v.x), F::splat(v.y), F::splat(v.z)}; }
  /// A vector of those kept by fours.
  CAROM_SIMD_INLINE static Wide3 splat_of(const float* fours, int i, int rows = 3) {
    const float* lane = fours + 4 * rows * (i / 4) + i % 4;
    return {F::splat(lane[0]), F::splat(lane[4]), F::splat(lane[8])};
  }
  template <int N>
  CAROM_SIMD_INLINE static Wide3 load(const float (&rows)[3][N], int lane = 0) {
    return {F::load(rows[0] + lane), F::load(rows[1] + lane), F::load(rows[2] + lane)};
  }
  CAROM_SIMD_INLINE friend Wide3 operator+(const Wide3& a, const Wide3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  CAROM_SIMD_INLINE friend Wide3 operator-(const Wide3& a, const Wide3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  CAROM_SIMD_INLINE friend Wide3 operator*(const Wide3& a, F s) { return {a.x * s, a.y * s, a.z * s}; }
  CAROM_SIMD_INLINE friend F dot(const Wide3& a, const Wide3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  CAROM_SIMD_INLINE friend Wide3 cross(const Wide3& a, const Wide3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  CAROM_SIMD_INLINE friend Wide3 select(math::WideMask<W> m, const Wide3& a, const Wide3& b) {
    return {math::select(m, a.x, b.x), math::select(m, a.y, b.y), math::select(m, a.z, b.z)};
  }
};

}  // namespace CAROM_SIMD_NAMESPACE
}  // namespace carom::geometry::detail
