// Sine, cosine, tangent and their inverses.
#include "carom/math/detail/double_double.h"
#include "carom/math/detail/elementary_tables.h"
#include "carom/math/elementary.h"

namespace carom::math {
namespace detail {
namespace {

/// An angle in [−π/4, π/4] and the number of quarter turns (modulo four) that were taken off.
struct Reduced {
  double hi, lo;
  int quarter;
};

constexpr double rounding_shift = 6755399441055744.0;  // 1.5 · 2⁵²: adding it rounds to an integer, ties to even

__extension__ typedef unsigned __int128 Unsigned128;  // NOLINT(modernize-use-using): wants a typedef

/// Payne and Hanek (1983): only those digits of 2/π that matter for x mod π/2 are multiplied.
Reduced reduce_large(double x) {
  const std::uint64_t b = bits_of(x);
  const int exponent = static_cast<int>((b >> 52) & 0x7ff) - 1075;  // |x| = mantissa · 2^exponent
  const std::uint64_t mantissa = (b & 0xfffffffffffffULL) | 0x10000000000000ULL;
  // Bits of 2/π worth 2^(2 − exponent) and more give multiples of four quarter turns: the window starts behind them.
  const int first = exponent > 2 ? exponent - 2 : 0;
  std::uint64_t p[5] = {};  // mantissa · window of 256 bits, highest word first
  for (int i = 3; i >= 0; --i) {
    const int word = first / 64 + i, offset = first % 64;
    std::uint64_t w = two_over_pi_words[word] << offset;
    if (offset != 0) w |= two_over_pi_words[word + 1] >> (64 - offset);
    const Unsigned128 t = static_cast<Unsigned128>(w) * mantissa + p[i + 1];
    p[i + 1] = static_cast<std::uint64_t>(t);
    p[i] = static_cast<std::uint64_t>(t >> 64);
  }
  // Bring the bit worth two quarter turns to the top; what lies above it does not matter.
  const int shift = exponent > 2 ? 64 : 62 + exponent;
  for (int i = 0; i < 4; ++i) p[i] = shift == 64 ? p[i + 1] : (p[i] << shift) | (p[i + 1] >> (64 - shift));
  int quarter = static_cast<int>(p[0] >> 62);
  for (int i = 0; i < 4; ++i) p[i] = (p[i] << 2) | (i < 3 ? p[i + 1] >> 62 : 0);
  const bool negative = (p[0] >> 63) != 0;  // fraction of one half or more: round the quarter up
  if (negative) {
    ++quarter;
    for (int i = 0; i < 4; ++i) p[i] = ~p[i];
  }
  int zeros = 0;
  while (zeros < 192 && (p[0] >> 63) == 0) {
    for (int i = 0; i < 4; ++i) p[i] = (p[i] << 1) | (i < 3 ? p[i + 1] >> 63 : 0);
    ++zeros;
  }
  Pair f = {static_cast<double>(p[0] >> 11) * power_of_two(-53),
            static_cast<double>(((p[0] & 0x7ff) << 42) | (p[1] >> 22)) * power_of_two(-106)};
  const double scale = power_of_two(-zeros);
  f = {f.hi * scale, f.lo * scale};
  Pair r = product(f, {half_pi[0][0], half_pi[0][1]});
  if (negative) r = negate(r);
  if (is_negative(x)) {
    r = negate(r);
    quarter = -quarter;
  }
  return {r.hi, r.lo, quarter & 3};
}

/// Cody and Waite (1980) with three parts of 33 bits: n · part is exact for |n| < 2²⁰.
Reduced reduce(double x) {
  if (magnitude(x) < 0.785398) return {x, 0, 0};
  if (magnitude(x) >= 1647099.0) return reduce_large(x);
  const double shifted = x * two_over_pi + rounding_shift;
  const double n = shifted - rounding_shift;
  const Pair a = two_sum(x - n * half_pi_parts[0], -n * half_pi_parts[1]);
  const Pair b = two_sum(a.hi, -n * half_pi_parts[2]);
  const Pair r = two_sum(b.hi, (a.lo + b.lo) - n * half_pi_parts[3]);
  return {r.hi, r.lo, static_cast<int>(bits_of(shifted) & 3)};
}

/// sin(r) as leading part and correction.
Pair sin_reduced(double r, double lo) {
  const double z = r * r;
  return quick_sum(r, r * z * polynomial(sin_terms, z) + lo * (1 - 0.5 * z));
}
/// cos(r) as leading part and correction.
Pair cos_reduced(double r, double lo) {
  const double z = r * r, half = 0.5 * z;
  const Pair one = quick_sum(1, -half);
  // half itself is rounded: its error is exact by the halves of r.
  const Pair h = halves(r);
  const double error = 0.5 * (((h.hi * h.hi - z) + 2 * h.hi * h.lo) + h.lo * h.lo);
  return quick_sum(one.hi, one.lo + (z * z * polynomial(cos_terms, z) - (r * lo + error)));
}
double rounded(Pair p) { return p.hi + p.lo; }

double sin_of(Reduced r) {
  const double s = (r.quarter & 1) ? rounded(cos_reduced(r.hi, r.lo)) : rounded(sin_reduced(r.hi, r.lo));
  return (r.quarter & 2) ? -s : s;
}
double cos_of(Reduced r) {
  const double c = (r.quarter & 1) ? rounded(sin_reduced(r.hi, r.lo)) : rounded(cos_reduced(r.hi, r.lo));
  return ((r.quarter + 1) & 2) ? -c : c;
}

/// atan(y/x) for 0 ≤ y ≤ x, x > 0, neither tiny nor huge.
Pair angle(Pair y, Pair x) {
  const int k = static_cast<int>(16 * (y.hi / x.hi) + 0.5);
  Pair num = y, den = x;
  if (k != 0) {
    // atan(y/x) = atan c + atan((y − c x)/(x + c y)), and c has four bits.
    const double c = k / 16.0;
    const Pair cx = two_product(c, x.hi), cy = two_product(c, y.hi);
    num = sum(y, {-cx.hi, -(cx.lo + c * x.lo)});
    den = sum(x, {cy.hi, cy.lo + c * y.lo});
  }
  const Pair t = quotient(num, den);
  const double z = t.hi * t.hi;
  const Pair base = quick_sum(atan_table[k][0], t.hi);
  return quick_sum(base.hi, base.lo + (atan_table[k][1] + (t.lo + t.hi * z * polynomial(atan_terms, z))));
}
/// The angle of (x, y) in [0, π/2] for y, x ≥ 0.
Pair first_quadrant(Pair y, Pair x) {
  if (y.hi <= x.hi) return angle(y, x);
  return sum({half_pi[0][0], half_pi[0][1]}, negate(angle(x, y)));
}
/// √(1 − x²) for |x| ≤ 1.
Pair cathetus(double x) {
  const Pair s = two_product(x, x);
  return square_root(sum({1, 0}, negate(s)));
}

}  // namespace
}  // namespace detail

using namespace detail;

double sin(double x) {
  if (!(magnitude(x) < infinity)) return not_a_number;
  if (magnitude(x) < 0x1p-27) return x;
  return sin_of(reduce(x));
}

double cos(double x) {
  if (!(magnitude(x) < infinity)) return not_a_number;
  return cos_of(reduce(x));
}

SinCos<double> sincos(double x) {
  if (!(magnitude(x) < infinity)) return {not_a_number, not_a_number};
  if (magnitude(x) < 0x1p-27) return {x, 1};
  const Reduced r = reduce(x);
  const double s = rounded(sin_reduced(r.hi, r.lo)), c = rounded(cos_reduced(r.hi, r.lo));
  const double sine = (r.quarter & 1) ? c : s, cosine = (r.quarter & 1) ? s : c;
  return {(r.quarter & 2) ? -sine : sine, ((r.quarter + 1) & 2) ? -cosine : cosine};
}

double tan(double x) {
  if (!(magnitude(x) < infinity)) return not_a_number;
  if (magnitude(x) < 0x1p-27) return x;
  const Reduced r = reduce(x);
  const Pair s = sin_reduced(r.hi, r.lo), c = cos_reduced(r.hi, r.lo);
  return (r.quarter & 1) ? -rounded(quotient(c, s)) : rounded(quotient(s, c));
}

double atan(double x) {
  if (x != x) return x;
  const double a = magnitude(x);
  if (a < 0x1p-27) return x;
  if (a > 0x1p60) return with_sign(half_pi[0][0], x);
  return with_sign(rounded(first_quadrant({a, 0}, {1, 0})), x);
}

double atan2(double y, double x) {
  if (x != x || y != y) return x + y;
  double ay = magnitude(y), ax = magnitude(x);
  if (ay == 0) return is_negative(x) ? with_sign(pi_pair[0][0], y) : y;
  if (ax == 0) return with_sign(half_pi[0][0], y);
  if (ay == infinity && ax == infinity) ay = ax = 1;
  const int exponent_y = static_cast<int>(bits_of(ay) >> 52), exponent_x = static_cast<int>(bits_of(ax) >> 52);
  if (exponent_y - exponent_x > 60) return with_sign(half_pi[0][0], y);
  if (exponent_x - exponent_y > 60) return with_sign(is_negative(x) ? pi_pair[0][0] : ay / ax, y);
  const double largest = math::max(ay, ax);
  const double scale = largest > 0x1p500 ? 0x1p-600 : (largest < 0x1p-500 ? 0x1p600 : 1.0);
  const Pair a = first_quadrant({ay * scale, 0}, {ax * scale, 0});
  if (!is_negative(x)) return with_sign(rounded(a), y);
  return with_sign(rounded(sum({pi_pair[0][0], pi_pair[0][1]}, negate(a))), y);
}

double asin(double x) {
  const double a = magnitude(x);
  if (!(a <= 1)) return not_a_number;
  if (a < 0x1p-27) return x;
  if (a == 1) return with_sign(half_pi[0][0], x);
  return with_sign(rounded(first_quadrant({a, 0}, cathetus(a))), x);
}

double acos(double x) {
  const double a = magnitude(x);
  if (!(a <= 1)) return not_a_number;
  if (a == 1) return x > 0 ? 0.0 : pi_pair[0][0];
  if (a < 0x1p-60) return half_pi[0][0];
  const Pair angle_of_magnitude = first_quadrant(cathetus(a), {a, 0});
  if (x > 0) return rounded(angle_of_magnitude);
  return rounded(sum({pi_pair[0][0], pi_pair[0][1]}, negate(angle_of_magnitude)));
}

}  // namespace carom::math
