// Lanes of floats, integers and masks over a width parameter: one source for SSE, AVX2, AVX-512, NEON and WASM.
//
// Every operation works lane by lane with the same IEEE arithmetic as the scalar code (no fused multiply-add, no
// approximate reciprocal), so a lane's bits never depend on the width.
//
// How kernels are written and where the trap lies: a hot loop is a template over the width, in a header of its own, and
// is instantiated once in a baseline source, once in NAME_avx2.cpp and once in NAME_avx512.cpp, which CMake compiles
// with the flags of that instruction set. An inline function that such a source leaves out of line would be emitted
// with AVX instructions under the same linker name as its baseline twin, and the linker keeps only one of the two: the
// program then dies on an older machine. Hence
//   1. everything here lives in an inline namespace named after the instruction set of the translation unit, so the
//      types and all templates over them are distinct symbols per instruction set, and every function is always
//      inlined;
//   2. a kernel template takes its data as plain pointers and Wide types, and lies in a namespace named with
//      CAROM_SIMD_NAMESPACE itself; it may use structs of other headers, but must not call their inline functions
//      (the operators of Vec3, std:: algorithms, containers) except those that are always inlined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__)
#define CAROM_SIMD_NAMESPACE simd_avx512
#define CAROM_SIMD_NATIVE_WIDTH 16
#elif defined(__AVX2__)
#define CAROM_SIMD_NAMESPACE simd_avx2
#define CAROM_SIMD_NATIVE_WIDTH 8
#else
#define CAROM_SIMD_NAMESPACE simd_baseline
#define CAROM_SIMD_NATIVE_WIDTH 4
#endif
#define CAROM_SIMD_INLINE [[gnu::always_inline]] inline

namespace carom::math {
inline namespace CAROM_SIMD_NAMESPACE {

/// Lanes of the widest register of this translation unit's instruction set. Wider types work too, in pieces.
inline constexpr int native_width = CAROM_SIMD_NATIVE_WIDTH;

template <int W>
struct WideVectors {
  static_assert(W == 4 || W == 8 || W == 16, "a width is 4, 8 or 16 lanes");
  // gcc takes this attribute with a dependent size on a typedef only.
  typedef float Floats __attribute__((vector_size(4 * W)));       // NOLINT(modernize-use-using)
  typedef std::int32_t Ints __attribute__((vector_size(4 * W)));  // NOLINT(modernize-use-using)
};

/// One truth value per lane: all bits set or none.
template <int W>
struct WideMask {
  using Vector = typename WideVectors<W>::Ints;
  Vector v;

  CAROM_SIMD_INLINE static WideMask none() { return {Vector{}}; }
  CAROM_SIMD_INLINE static WideMask all() { return {~Vector{}}; }
  CAROM_SIMD_INLINE friend WideMask operator&(WideMask a, WideMask b) { return {a.v & b.v}; }
  CAROM_SIMD_INLINE friend WideMask operator|(WideMask a, WideMask b) { return {a.v | b.v}; }
  CAROM_SIMD_INLINE friend WideMask operator^(WideMask a, WideMask b) { return {a.v ^ b.v}; }
  CAROM_SIMD_INLINE friend WideMask operator!(WideMask a) { return {~a.v}; }
  CAROM_SIMD_INLINE bool operator[](int lane) const { return v[lane] != 0; }
};

template <int W>
struct WideInt {
  using Vector = typename WideVectors<W>::Ints;
  static constexpr int width = W;
  Vector v;

  CAROM_SIMD_INLINE static WideInt zero() { return {Vector{}}; }
  CAROM_SIMD_INLINE static WideInt splat(std::int32_t x) { return {Vector{} + x}; }
  CAROM_SIMD_INLINE static WideInt load(const std::int32_t* p) {
    WideInt r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  CAROM_SIMD_INLINE void store(std::int32_t* p) const { __builtin_memcpy(p, &v, sizeof v); }
  /// 0, 1, 2, …
  CAROM_SIMD_INLINE static WideInt lanes() {
    return [&]<int... I>(std::integer_sequence<int, I...>)
               __attribute__((always_inline)) { return WideInt{Vector{I...}}; }(std::make_integer_sequence<int, W>{});
  }
  CAROM_SIMD_INLINE std::int32_t operator[](int lane) const { return v[lane]; }
  CAROM_SIMD_INLINE friend WideInt operator+(WideInt a, WideInt b) { return {a.v + b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator-(WideInt a, WideInt b) { return {a.v - b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator*(WideInt a, WideInt b) { return {a.v * b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator&(WideInt a, WideInt b) { return {a.v & b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator|(WideInt a, WideInt b) { return {a.v | b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator^(WideInt a, WideInt b) { return {a.v ^ b.v}; }
  CAROM_SIMD_INLINE friend WideInt operator<<(WideInt a, int bits) { return {a.v << bits}; }
  /// Arithmetic shift.
  CAROM_SIMD_INLINE friend WideInt operator>>(WideInt a, int bits) { return {a.v >> bits}; }
  CAROM_SIMD_INLINE friend WideMask<W> operator==(WideInt a, WideInt b) { return {a.v == b.v}; }
  CAROM_SIMD_INLINE friend WideMask<W> operator!=(WideInt a, WideInt b) { return {a.v != b.v}; }
  CAROM_SIMD_INLINE friend WideMask<W> operator<(WideInt a, WideInt b) { return {a.v < b.v}; }
  CAROM_SIMD_INLINE friend WideMask<W> operator>(WideInt a, WideInt b) { return {a.v > b.v}; }
};

template <int W>
struct WideFloat {
  using Vector = typename WideVectors<W>::Floats;
  using Mask = WideMask<W>;
  static constexpr int width = W;
  Vector v;

  CAROM_SIMD_INLINE static WideFloat zero() { return {Vector{}}; }
  CAROM_SIMD_INLINE static WideFloat splat(float x) {
#if defined(__AVX512F__)
    if constexpr (W == 16) return {Vector(_mm512_set1_ps(x))};
#endif
    return [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
      return WideFloat{Vector{(static_cast<void>(I), x)...}};
    }(std::make_integer_sequence<int, W>{});
  }
  /// W floats from any address.
  CAROM_SIMD_INLINE static WideFloat load(const float* p) {
    WideFloat r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  CAROM_SIMD_INLINE void store(float* p) const { __builtin_memcpy(p, &v, sizeof v); }
  /// W floats from an address that is a multiple of 4 W bytes.
  CAROM_SIMD_INLINE static WideFloat load_aligned(const float* p) {
    WideFloat r;
    __builtin_memcpy(&r.v, __builtin_assume_aligned(p, 4 * W), sizeof r.v);
    return r;
  }
  CAROM_SIMD_INLINE void store_aligned(float* p) const {
    __builtin_memcpy(__builtin_assume_aligned(p, 4 * W), &v, sizeof v);
  }
  CAROM_SIMD_INLINE float operator[](int lane) const { return v[lane]; }
  CAROM_SIMD_INLINE void set(int lane, float x) { v[lane] = x; }

  CAROM_SIMD_INLINE friend WideFloat operator+(WideFloat a, WideFloat b) { return {a.v + b.v}; }
  CAROM_SIMD_INLINE friend WideFloat operator-(WideFloat a, WideFloat b) { return {a.v - b.v}; }
  CAROM_SIMD_INLINE friend WideFloat operator*(WideFloat a, WideFloat b) { return {a.v * b.v}; }
  CAROM_SIMD_INLINE friend WideFloat operator/(WideFloat a, WideFloat b) { return {a.v / b.v}; }
  CAROM_SIMD_INLINE friend WideFloat operator-(WideFloat a) { return {-a.v}; }
  CAROM_SIMD_INLINE WideFloat& operator+=(WideFloat b) {
    v = v + b.v;
    return *this;
  }
  CAROM_SIMD_INLINE WideFloat& operator-=(WideFloat b) {
    v = v - b.v;
    return *this;
  }
  CAROM_SIMD_INLINE WideFloat& operator*=(WideFloat b) {
    v = v * b.v;
    return *this;
  }
  CAROM_SIMD_INLINE friend Mask operator<(WideFloat a, WideFloat b) { return {a.v < b.v}; }
  CAROM_SIMD_INLINE friend Mask operator<=(WideFloat a, WideFloat b) { return {a.v <= b.v}; }
  CAROM_SIMD_INLINE friend Mask operator>(WideFloat a, WideFloat b) { return {a.v > b.v}; }
  CAROM_SIMD_INLINE friend Mask operator>=(WideFloat a, WideFloat b) { return {a.v >= b.v}; }
  CAROM_SIMD_INLINE friend Mask operator==(WideFloat a, WideFloat b) { return {a.v == b.v}; }
  CAROM_SIMD_INLINE friend Mask operator!=(WideFloat a, WideFloat b) { return {a.v != b.v}; }
};

template <int W>
CAROM_SIMD_INLINE WideInt<W> bits(WideFloat<W> a) {
  return {reinterpret_cast<typename WideInt<W>::Vector>(a.v)};
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> float_of_bits(WideInt<W> a) {
  return {reinterpret_cast<typename WideFloat<W>::Vector>(a.v)};
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> to_float(WideInt<W> a) {
  return {__builtin_convertvector(a.v, typename WideFloat<W>::Vector)};
}
/// Towards zero. A lane outside (−2³¹, 2³¹) or NaN has no portable result: keep it out.
template <int W>
CAROM_SIMD_INLINE WideInt<W> to_int(WideFloat<W> a) {
  return {__builtin_convertvector(a.v, typename WideInt<W>::Vector)};
}

/// m ? a : b in each lane.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> select(WideMask<W> m, WideFloat<W> a, WideFloat<W> b) {
  return {m.v ? a.v : b.v};
}
template <int W>
CAROM_SIMD_INLINE WideInt<W> select(WideMask<W> m, WideInt<W> a, WideInt<W> b) {
  return {m.v ? a.v : b.v};
}
/// a where m, else +0.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> keep(WideMask<W> m, WideFloat<W> a) {
  return float_of_bits(WideInt<W>{bits(a).v & m.v});
}

/// b < a ? b : a, as math::min (so a NaN in either leaves a).
template <int W>
CAROM_SIMD_INLINE WideFloat<W> min(WideFloat<W> a, WideFloat<W> b) {
  using V = typename WideFloat<W>::Vector;
#if defined(__AVX512F__)
  if constexpr (W == 16) return {V(_mm512_maskz_min_ps(__mmask16(0xffff), b.v, a.v))};
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return {V(_mm256_min_ps(b.v, a.v))};
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return {V(_mm_min_ps(b.v, a.v))};
#elif defined(__wasm_simd128__)
  if constexpr (W == 4) return {V(wasm_f32x4_pmin(a.v, b.v))};
#endif
  return {b.v < a.v ? b.v : a.v};
}
/// a < b ? b : a, as math::max.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> max(WideFloat<W> a, WideFloat<W> b) {
  using V = typename WideFloat<W>::Vector;
#if defined(__AVX512F__)
  if constexpr (W == 16) return {V(_mm512_maskz_max_ps(__mmask16(0xffff), b.v, a.v))};
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return {V(_mm256_max_ps(b.v, a.v))};
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return {V(_mm_max_ps(b.v, a.v))};
#elif defined(__wasm_simd128__)
  if constexpr (W == 4) return {V(wasm_f32x4_pmax(a.v, b.v))};
#endif
  return {a.v < b.v ? b.v : a.v};
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> clamp(WideFloat<W> x, WideFloat<W> low, WideFloat<W> high) {
  return min(max(x, low), high);
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> abs(WideFloat<W> a) {
  return float_of_bits(bits(a) & WideInt<W>::splat(0x7fffffff));
}
/// |a| with the sign of b.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> copysign(WideFloat<W> a, WideFloat<W> b) {
  const auto sign = WideInt<W>::splat(static_cast<std::int32_t>(0x80000000u));
  return float_of_bits((bits(a) & (sign ^ WideInt<W>::splat(-1))) | (bits(b) & sign));
}
/// Correctly rounded, as math::sqrt.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> sqrt(WideFloat<W> a) {
  using V = typename WideFloat<W>::Vector;
#if defined(__AVX512F__)
  // Masked, because gcc 12 warns of an undefined operand inside the plain intrinsic.
  if constexpr (W == 16) return {V(_mm512_maskz_sqrt_ps(__mmask16(0xffff), a.v))};
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return {V(_mm256_sqrt_ps(a.v))};
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return {V(_mm_sqrt_ps(a.v))};
#elif defined(__wasm_simd128__)
  if constexpr (W == 4) return {V(wasm_f32x4_sqrt(a.v))};
#elif defined(__aarch64__)
  if constexpr (W == 4) return {V(vsqrtq_f32(a.v))};
#endif
  WideFloat<W> r;
  for (int i = 0; i < W; ++i) r.v[i] = __builtin_sqrtf(a.v[i]);
  return r;
}

/// Bit i is lane i.
template <int W>
CAROM_SIMD_INLINE std::uint32_t bitmask(WideMask<W> m) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (W == 16) return _mm512_movepi32_mask(__m512i(m.v));
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return static_cast<std::uint32_t>(_mm256_movemask_ps(__m256(m.v)));
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) return static_cast<std::uint32_t>(_mm_movemask_ps(__m128(m.v)));
#elif defined(__wasm_simd128__)
  if constexpr (W == 4) return wasm_i32x4_bitmask(m.v);
#endif
  std::uint32_t r = 0;
  for (int i = 0; i < W; ++i) r |= (m.v[i] != 0 ? 1u : 0u) << i;
  return r;
}
template <int W>
CAROM_SIMD_INLINE bool any(WideMask<W> m) {
  return bitmask(m) != 0;
}
template <int W>
CAROM_SIMD_INLINE bool all(WideMask<W> m) {
  return bitmask(m) == (1u << W) - 1u;
}
template <int W>
CAROM_SIMD_INLINE bool none(WideMask<W> m) {
  return bitmask(m) == 0;
}

CAROM_SIMD_INLINE void prefetch(const void* p) { __builtin_prefetch(p, 0, 3); }
CAROM_SIMD_INLINE void prefetch_write(void* p) { __builtin_prefetch(p, 1, 3); }

namespace simd_detail {

using Four = WideVectors<4>::Floats;

template <int I>
struct Index {
  static constexpr int value = I;
};
/// f(Index<0>), …, f(Index<N−1>) as straight code, so that arrays of registers stay registers.
template <int N, class F>
CAROM_SIMD_INLINE void unrolled(F f) {
  [&]<int... I>(std::integer_sequence<int, I...>)
      __attribute__((always_inline)) { (f(Index<I>{}), ...); }(std::make_integer_sequence<int, N>{});
}

CAROM_SIMD_INLINE Four load_four(const float* p) {
  Four r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}

/// A wide register from the four floats at p[K], p[K + 4], …, each `offset` further on.
template <int W, int K>
CAROM_SIMD_INLINE typename WideVectors<W>::Floats join_four(const float* const (&p)[W], int offset) {
  const Four a = load_four(p[K] + offset);
  if constexpr (W == 4) return a;
  // gcc makes shuffles of registers of what follows, of which a core does one at a time: the loads can place their
  // rows.
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  if constexpr (W == 16) {
    __m512 r = _mm512_castps128_ps512(__m128(a));
    r = _mm512_mask_broadcast_f32x4(r, __mmask16(0x00f0), __m128(load_four(p[K + 4] + offset)));
    r = _mm512_mask_broadcast_f32x4(r, __mmask16(0x0f00), __m128(load_four(p[K + 8] + offset)));
    return WideVectors<16>::Floats(
        _mm512_mask_broadcast_f32x4(r, __mmask16(0xf000), __m128(load_four(p[K + 12] + offset))));
  }
#endif
#if defined(__AVX__)
  if constexpr (W == 8)
    return WideVectors<8>::Floats(
        _mm256_insertf128_ps(_mm256_castps128_ps256(__m128(a)), __m128(load_four(p[K + 4] + offset)), 1));
#endif
  if constexpr (W > 4) {
    const auto ab = __builtin_shufflevector(a, load_four(p[K + 4] + offset), 0, 1, 2, 3, 4, 5, 6, 7);
    if constexpr (W == 8) {
      return ab;
    } else {
      const auto cd =
          __builtin_shufflevector(load_four(p[K + 8] + offset), load_four(p[K + 12] + offset), 0, 1, 2, 3, 4, 5, 6, 7);
      return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
  }
}
template <int W, int Block>
CAROM_SIMD_INLINE Four block_of(typename WideVectors<W>::Floats v) {
  if constexpr (W == 4) return v;
#if defined(__AVX__)
  // As in join_four: what is stored need not be shuffled before.
  if constexpr (W == 8) return Four(_mm256_extractf128_ps(__m256(v), Block));
#if defined(__AVX512F__)
  if constexpr (W == 16) {
    using Half = WideVectors<8>::Floats;
    constexpr int first = Block / 2 * 8;
    const Half half = __builtin_shufflevector(v, v, first, first + 1, first + 2, first + 3, first + 4, first + 5,
                                              first + 6, first + 7);
    return block_of<8, Block % 2>(half);
  }
#endif
#endif
  if constexpr (W > 4) return __builtin_shufflevector(v, v, 4 * Block, 4 * Block + 1, 4 * Block + 2, 4 * Block + 3);
}

template <int W, int A, int B, int C, int D>
CAROM_SIMD_INLINE typename WideVectors<W>::Floats blockwise(typename WideVectors<W>::Floats a,
                                                            typename WideVectors<W>::Floats b) {
  constexpr auto pick = [](int s, int block) { return (s < 4 ? s : s - 4 + W) + 4 * block; };
  if constexpr (W == 4) {
    return __builtin_shufflevector(a, b, A, B, C, D);
  } else if constexpr (W == 8) {
    return __builtin_shufflevector(a, b, pick(A, 0), pick(B, 0), pick(C, 0), pick(D, 0), pick(A, 1), pick(B, 1),
                                   pick(C, 1), pick(D, 1));
  } else {
    return __builtin_shufflevector(a, b, pick(A, 0), pick(B, 0), pick(C, 0), pick(D, 0), pick(A, 1), pick(B, 1),
                                   pick(C, 1), pick(D, 1), pick(A, 2), pick(B, 2), pick(C, 2), pick(D, 2), pick(A, 3),
                                   pick(B, 3), pick(C, 3), pick(D, 3));
  }
}

/// The 4×4 transpose inside each block of four lanes, in place.
template <int W>
CAROM_SIMD_INLINE void transpose_blocks(typename WideVectors<W>::Floats (&r)[4]) {
  const auto t0 = blockwise<W, 0, 4, 1, 5>(r[0], r[1]), t1 = blockwise<W, 0, 4, 1, 5>(r[2], r[3]);
  const auto t2 = blockwise<W, 2, 6, 3, 7>(r[0], r[1]), t3 = blockwise<W, 2, 6, 3, 7>(r[2], r[3]);
  r[0] = blockwise<W, 0, 1, 4, 5>(t0, t1);
  r[1] = blockwise<W, 2, 3, 6, 7>(t0, t1);
  r[2] = blockwise<W, 0, 1, 4, 5>(t2, t3);
  r[3] = blockwise<W, 2, 3, 6, 7>(t2, t3);
}

}  // namespace simd_detail

/// columns[c] lane i = rows[i][c]: W records of Columns floats (a multiple of four) from any addresses, transposed.
template <int Columns, int W>
CAROM_SIMD_INLINE void gather_rows(const float* const (&rows)[W], WideFloat<W> (&columns)[Columns]) {
  static_assert(Columns % 4 == 0);
  simd_detail::unrolled<Columns / 4>([&](auto group) __attribute__((always_inline)) {
    constexpr int c = 4 * decltype(group)::value;
    typename WideFloat<W>::Vector r[4] = {simd_detail::join_four<W, 0>(rows, c), simd_detail::join_four<W, 1>(rows, c),
                                          simd_detail::join_four<W, 2>(rows, c), simd_detail::join_four<W, 3>(rows, c)};
    simd_detail::transpose_blocks<W>(r);
    columns[c].v = r[0];
    columns[c + 1].v = r[1];
    columns[c + 2].v = r[2];
    columns[c + 3].v = r[3];
  });
}
/// The same from an array of records: record i is base[Columns · index[i] …].
template <int Columns, int W>
CAROM_SIMD_INLINE void gather_rows(const float* base, const std::int32_t* index, WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  simd_detail::unrolled<W>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = base + static_cast<std::ptrdiff_t>(index[i]) * Columns;
  });
  gather_rows<Columns, W>(rows, columns);
}
/// The same, where a negative index reads the record `fallback`.
template <int Columns, int W>
CAROM_SIMD_INLINE void gather_rows(const float* base, const std::int32_t* index, const float* fallback,
                                   WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  simd_detail::unrolled<W>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = index[i] >= 0 ? base + static_cast<std::ptrdiff_t>(index[i]) * Columns : fallback;
  });
  gather_rows<Columns, W>(rows, columns);
}

/// Record index[i] of base, of Stride floats, gets columns[·] lane i at its front (Columns is a multiple of four), in
/// the order of the lanes. A record with negative index is not written.
template <int Stride, int Columns, int W>
CAROM_SIMD_INLINE void scatter_rows(float* base, const std::int32_t* index, const WideFloat<W> (&columns)[Columns]) {
  static_assert(Columns % 4 == 0 && Columns <= Stride);
  using Vector = typename WideFloat<W>::Vector;
  Vector rows[Columns / 4][4];
  simd_detail::unrolled<Columns / 4>([&](auto group) __attribute__((always_inline)) {
    constexpr int g = decltype(group)::value;
    Vector r[4] = {columns[4 * g].v, columns[4 * g + 1].v, columns[4 * g + 2].v, columns[4 * g + 3].v};
    simd_detail::transpose_blocks<W>(r);
    rows[g][0] = r[0];
    rows[g][1] = r[1];
    rows[g][2] = r[2];
    rows[g][3] = r[3];
  });
  simd_detail::unrolled<W>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    if (index[i] < 0) return;
    float* p = base + static_cast<std::ptrdiff_t>(index[i]) * Stride;
    simd_detail::unrolled<Columns / 4>([&](auto group) __attribute__((always_inline)) {
      constexpr int g = decltype(group)::value;
      const simd_detail::Four four = simd_detail::block_of<W, i / 4>(rows[g][i % 4]);
      __builtin_memcpy(p + 4 * g, &four, sizeof four);
    });
  });
}

}  // namespace CAROM_SIMD_NAMESPACE
}  // namespace carom::math
