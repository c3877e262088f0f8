// Unevaluated sums of two doubles: the working precision of the elementary functions.
#pragma once

#include <bit>
#include <cstdint>

#include "carom/math/vec.h"

namespace carom::math::detail {

struct Pair {
  double hi, lo;
};

constexpr std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }
constexpr double double_of(std::uint64_t b) { return std::bit_cast<double>(b); }
/// 2ᵏ for −1022 ≤ k ≤ 1023.
constexpr double power_of_two(int k) { return double_of(static_cast<std::uint64_t>(k + 1023) << 52); }
constexpr double magnitude(double x) { return double_of(bits_of(x) & 0x7fffffffffffffffULL); }
constexpr double with_sign(double x, double sign) {
  return double_of((bits_of(x) & 0x7fffffffffffffffULL) | (bits_of(sign) & 0x8000000000000000ULL));
}
constexpr bool is_negative(double x) { return (bits_of(x) >> 63) != 0; }
inline constexpr double infinity = __builtin_inf();
inline constexpr double not_a_number = __builtin_nan("");

/// a + b exactly (Knuth 1969).
constexpr Pair two_sum(double a, double b) {
  const double s = a + b;
  const double bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
/// a + b exactly where |a| ≥ |b| or a is zero (Dekker 1971).
constexpr Pair quick_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
/// x as two halves of 26 bits (Veltkamp); |x| < 2⁹⁹⁵.
constexpr Pair halves(double x) {
  const double t = 134217729.0 * x;
  const double hi = t - (t - x);
  return {hi, x - hi};
}
/// a · b exactly, where nothing underflows (Dekker 1971).
constexpr Pair two_product(double a, double b) {
  const double p = a * b;
  const Pair x = halves(a), y = halves(b);
  return {p, ((x.hi * y.hi - p) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo};
}
/// To about 2⁻¹⁰⁴ relative.
constexpr Pair product(Pair a, Pair b) {
  const Pair p = two_product(a.hi, b.hi);
  return quick_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
constexpr Pair sum(Pair a, Pair b) {
  const Pair s = two_sum(a.hi, b.hi);
  return quick_sum(s.hi, s.lo + (a.lo + b.lo));
}
constexpr Pair negate(Pair a) { return {-a.hi, -a.lo}; }
/// To about 2⁻¹⁰⁰ relative.
constexpr Pair quotient(Pair a, Pair b) {
  const double q = a.hi / b.hi;
  const Pair p = two_product(q, b.hi);
  return quick_sum(q, (((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo)) / b.hi);
}
inline Pair square_root(Pair a) {
  const double r = math::sqrt(a.hi);
  if (r == 0) return {0, 0};
  const Pair p = two_product(r, r);
  return quick_sum(r, (((a.hi - p.hi) - p.lo) + a.lo) / (2 * r));
}

/// c[0] + c[1] x + … by Horner's rule.
template <int N>
constexpr double polynomial(const double (&c)[N], double x) {
  double s = c[N - 1];
  for (int i = N - 2; i >= 0; --i) s = s * x + c[i];
  return s;
}

/// 2ᵏ (hi + lo), with hi + lo near one: an unrounded exponential.
struct ScaledPair {
  double hi, lo;
  int k;
};
/// e^(x.hi + x.lo) for |x| < 800, to about 2⁻⁵⁹ relative.
ScaledPair exponential(Pair x);
/// ln x for finite x > 0, to about 2⁻⁶⁷ relative.
Pair logarithm(double x);
/// Rounded to a double; overflows to infinity and underflows gradually.
double assemble(ScaledPair s);

}  // namespace carom::math::detail
