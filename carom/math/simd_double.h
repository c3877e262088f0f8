// Lanes of doubles for the few kernels that need them: the same rules as simd.h, half as many lanes a register.
#pragma once

#include "carom/math/simd.h"

namespace carom::math {
inline namespace CAROM_SIMD_NAMESPACE {

template <int W>
struct DoubleVectors {
  static_assert(W == 2 || W == 4 || W == 8, "a width is 2, 4 or 8 lanes");
  typedef double Doubles __attribute__((vector_size(8 * W)));      // NOLINT(modernize-use-using)
  typedef std::int64_t Longs __attribute__((vector_size(8 * W)));  // NOLINT(modernize-use-using)
};

template <int W>
struct WideDouble {
  using Vector = typename DoubleVectors<W>::Doubles;
  using Mask = typename DoubleVectors<W>::Longs;  ///< all bits of a lane or none
  Vector v;

  CAROM_SIMD_INLINE static WideDouble splat(double x) { return {x - Vector{}}; }
  CAROM_SIMD_INLINE static WideDouble load_aligned(const double* p) {
    WideDouble r;
    __builtin_memcpy(&r.v, __builtin_assume_aligned(p, 8 * W), sizeof r.v);
    return r;
  }
  CAROM_SIMD_INLINE void store_aligned(double* p) const {
    __builtin_memcpy(__builtin_assume_aligned(p, 8 * W), &v, sizeof v);
  }
  CAROM_SIMD_INLINE friend WideDouble operator+(WideDouble a, WideDouble b) { return {a.v + b.v}; }
  CAROM_SIMD_INLINE friend WideDouble operator-(WideDouble a, WideDouble b) { return {a.v - b.v}; }
  CAROM_SIMD_INLINE friend WideDouble operator*(WideDouble a, WideDouble b) { return {a.v * b.v}; }
  CAROM_SIMD_INLINE friend WideDouble operator/(WideDouble a, WideDouble b) { return {a.v / b.v}; }
  CAROM_SIMD_INLINE friend Mask operator>(WideDouble a, WideDouble b) { return Mask(a.v > b.v); }
};

/// m ? a : b in each lane.
template <int W>
CAROM_SIMD_INLINE WideDouble<W> select(typename WideDouble<W>::Mask m, WideDouble<W> a, WideDouble<W> b) {
  return {m ? a.v : b.v};
}
/// Correctly rounded, as math::sqrt.
template <int W>
CAROM_SIMD_INLINE WideDouble<W> sqrt(WideDouble<W> a) {
  using V = typename WideDouble<W>::Vector;
#if defined(__AVX512F__)
  if constexpr (W == 8) return {V(_mm512_maskz_sqrt_pd(__mmask8(0xff), a.v))};
#endif
#if defined(__AVX__)
  if constexpr (W == 4) return {V(_mm256_sqrt_pd(a.v))};
#endif
#if defined(__SSE2__)
  if constexpr (W == 2) return {V(_mm_sqrt_pd(a.v))};
#elif defined(__wasm_simd128__)
  if constexpr (W == 2) return {V(wasm_f64x2_sqrt(a.v))};
#elif defined(__aarch64__)
  if constexpr (W == 2) return {V(vsqrtq_f64(a.v))};
#endif
  WideDouble<W> r;
  for (int i = 0; i < W; ++i) r.v[i] = __builtin_sqrt(a.v[i]);
  return r;
}
/// Is a lane of a mask of W lanes set?
template <int W>
CAROM_SIMD_INLINE bool any_of(typename WideDouble<W>::Mask m) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (W == 8) return _mm512_movepi64_mask(__m512i(m)) != 0;
#endif
#if defined(__AVX__)
  if constexpr (W == 4) return _mm256_movemask_pd(__m256d(m)) != 0;
#endif
#if defined(__SSE2__)
  if constexpr (W == 2) return _mm_movemask_pd(__m128d(m)) != 0;
#endif
  std::int64_t all = 0;
  for (int i = 0; i < W; ++i) all |= m[i];
  return all != 0;
}

}  // namespace CAROM_SIMD_NAMESPACE
}  // namespace carom::math
