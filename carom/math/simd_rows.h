// Records of eight or four floats to lanes and back, by the addresses of the records, which are all written.
// As simd.h, to be included by kernels alone.
#pragma once

#include "carom/math/simd.h"

namespace carom::math {
inline namespace CAROM_SIMD_NAMESPACE {
namespace simd_detail {

template <int W = 8>
CAROM_SIMD_INLINE typename WideVectors<W>::Floats load_eight(const float* p) {
  typename WideVectors<W>::Floats r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}
/// Two records of eight side by side.
template <int W = 16>
CAROM_SIMD_INLINE typename WideVectors<W>::Floats join_eight(const float* p, const float* q) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return WideVectors<16>::Floats(_mm512_mask_broadcast_f32x8(_mm512_castps256_ps512(__m256(load_eight(p))),
                                                             __mmask16(0xff00), __m256(load_eight(q))));
#else
  return __builtin_shufflevector(load_eight(p), load_eight(q), 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
}
template <int W = 16>
CAROM_SIMD_INLINE void part_eight(typename WideVectors<W>::Floats v, float* p, float* q) {
  const auto low = __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  const __m256 high = _mm512_maskz_extractf32x8_ps(__mmask8(0xff), __m512(v), 1);
#else
  const auto high = __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
  __builtin_memcpy(p, &low, sizeof low);
  __builtin_memcpy(q, &high, sizeof high);
}

}  // namespace simd_detail

/// columns[c] lane i = rows[i][c].
template <int W>
CAROM_SIMD_INLINE void gather_records(float* const (&rows)[W], WideFloat<W> (&columns)[8]) {
  using namespace simd_detail;
  if constexpr (W == 4) {
    const float* from[W] = {rows[0], rows[1], rows[2], rows[3]};
    gather_rows<8, W>(from, columns);
  } else {
    using Vector = typename WideFloat<W>::Vector;
    Vector r[2][4];
    unrolled<4>([&](auto k) __attribute__((always_inline)) {
      constexpr int i = decltype(k)::value;
      if constexpr (W == 8) {
        r[0][i] = load_eight(rows[i]);
        r[1][i] = load_eight(rows[i + 4]);
      } else {
        r[0][i] = join_eight(rows[i], rows[i + 4]);
        r[1][i] = join_eight(rows[i + 8], rows[i + 12]);
      }
    });
    transpose_blocks<W>(r[0]);
    transpose_blocks<W>(r[1]);
    unrolled<4>([&](auto k) __attribute__((always_inline)) {
      constexpr int i = decltype(k)::value;
      if constexpr (W == 8) {
        columns[i].v = __builtin_shufflevector(r[0][i], r[1][i], 0, 1, 2, 3, 8, 9, 10, 11);
        columns[i + 4].v = __builtin_shufflevector(r[0][i], r[1][i], 4, 5, 6, 7, 12, 13, 14, 15);
      } else {
        columns[i].v =
            __builtin_shufflevector(r[0][i], r[1][i], 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27);
        columns[i + 4].v =
            __builtin_shufflevector(r[0][i], r[1][i], 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31);
      }
    });
  }
}
template <int W>
CAROM_SIMD_INLINE void gather_records(float* const (&rows)[W], WideFloat<W> (&columns)[4]) {
  const float* from[W];
  simd_detail::unrolled<W>([&](auto k) __attribute__((always_inline)) {
    constexpr int i = decltype(k)::value;
    from[i] = rows[i];
  });
  gather_rows<4, W>(from, columns);
}

/// rows[i][c] = columns[c] lane i, in the order of the lanes or in another.
template <int W>
CAROM_SIMD_INLINE void scatter_records(float* const (&rows)[W], const WideFloat<W> (&columns)[4]) {
  using namespace simd_detail;
  typename WideFloat<W>::Vector r[4] = {columns[0].v, columns[1].v, columns[2].v, columns[3].v};
  transpose_blocks<W>(r);
  unrolled<4>([&](auto k) __attribute__((always_inline)) {
    constexpr int i = decltype(k)::value;
    unrolled<W / 4>([&](auto b) __attribute__((always_inline)) {
      constexpr int block = decltype(b)::value;
#if defined(__AVX512F__) && defined(__AVX512DQ__)
      if constexpr (W == 16) {
        const Four four = Four(_mm512_maskz_extractf32x4_ps(0xf, __m512(r[i]), block));
        __builtin_memcpy(rows[i + 4 * block], &four, sizeof four);
        return;
      }
#endif
      const Four four = block_of<W, block>(r[i]);
      __builtin_memcpy(rows[i + 4 * block], &four, sizeof four);
    });
  });
}
template <int W>
CAROM_SIMD_INLINE void scatter_records(float* const (&rows)[W], const WideFloat<W> (&columns)[8]) {
  using namespace simd_detail;
  if constexpr (W == 4) {
    for (int half = 0; half < 2; ++half) {
      float* const to[W] = {rows[0] + 4 * half, rows[1] + 4 * half, rows[2] + 4 * half, rows[3] + 4 * half};
      const WideFloat<W> part[4] = {columns[4 * half], columns[4 * half + 1], columns[4 * half + 2],
                                    columns[4 * half + 3]};
      scatter_records<W>(to, part);
    }
  } else {
    using Vector = typename WideFloat<W>::Vector;
    Vector r[2][4];
    unrolled<4>([&](auto k) __attribute__((always_inline)) {
      constexpr int i = decltype(k)::value;
      const Vector a = columns[i].v, b = columns[i + 4].v;
      if constexpr (W == 8) {
        r[0][i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
        r[1][i] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
      } else {
        r[0][i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23);
        r[1][i] = __builtin_shufflevector(a, b, 8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31);
      }
    });
    transpose_blocks<W>(r[0]);
    transpose_blocks<W>(r[1]);
    unrolled<4>([&](auto k) __attribute__((always_inline)) {
      constexpr int i = decltype(k)::value;
      if constexpr (W == 8) {
        __builtin_memcpy(rows[i], &r[0][i], sizeof(Vector));
        __builtin_memcpy(rows[i + 4], &r[1][i], sizeof(Vector));
      } else {
        part_eight(r[0][i], rows[i], rows[i + 4]);
        part_eight(r[1][i], rows[i + 8], rows[i + 12]);
      }
    });
  }
}

}  // namespace CAROM_SIMD_NAMESPACE
}  // namespace carom::math
