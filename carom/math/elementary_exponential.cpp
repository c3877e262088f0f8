// Exponentials, logarithms, powers, roots and hyperbolic functions.
#include "carom/math/detail/double_double.h"
#include "carom/math/detail/elementary_tables.h"
#include "carom/math/elementary.h"

namespace carom::math {
namespace detail {

namespace {

constexpr double exponential_shift = 6755399441055744.0;  // 1.5 · 2⁵²

/// 2^(n/32) · eʳ for |r| ≤ ln 2/63 and |r.lo| at most half a unit in the last place of r.hi.
ScaledPair exponential_of(int n, Pair r) {
  const double* entry = exp2_table[n & 31];
  const double p = r.hi + (r.lo + r.hi * r.hi * polynomial(exp_terms, r.hi));
  const Pair s = quick_sum(entry[0], entry[1] + entry[0] * p);
  return {s.hi, s.lo, n >> 5};
}

}  // namespace

ScaledPair exponential(Pair x) {
  const double shifted = x.hi * thirty_two_over_ln2 + exponential_shift;
  const double n = shifted - exponential_shift;
  const double head = x.hi - n * ln2_over_32[0], tail = n * ln2_over_32[1];
  const double r = head - tail;
  return exponential_of(static_cast<int>(n), two_sum(r, ((head - r) - tail) + x.lo));
}

double assemble(ScaledPair s) {
  const double v = s.hi + s.lo;
  if (s.k > 1023) return s.k > 1100 ? infinity : v * power_of_two(1023) * power_of_two(s.k - 1023);
  if (s.k >= -1021) return v * power_of_two(s.k);
  return s.k < -1100 ? 0.0 : v * power_of_two(s.k + 200) * power_of_two(-200);
}

namespace {

/// head + tail + ln(1 + r) for |r| < 2⁻⁷, where head is zero or above |r|.
Pair logarithm_of(Pair r, double head, double tail) {
  const Pair square = two_product(r.hi, r.hi);
  const double cubic = r.hi * square.hi * polynomial(log_terms, r.hi);
  const Pair a = two_sum(head, r.hi);
  const Pair c = two_sum(a.hi, -0.5 * square.hi);
  const double rest = tail + (r.lo - (0.5 * square.lo + r.hi * r.lo));
  return quick_sum(c.hi, (a.lo + c.lo) + (rest + cubic));
}

}  // namespace

Pair logarithm(double x) {
  std::uint64_t b = bits_of(x);
  int k = 0;
  if (b < 0x0010000000000000ULL) {  // subnormal
    b = bits_of(x * 0x1p54);
    k = -54;
  }
  const std::uint64_t t = b - log_offset;
  const int binade = static_cast<int>(static_cast<std::int64_t>(t) >> 52);
  k += binade;
  const double* cell = log_table[(t >> 45) & 127];
  const double m = double_of(b - (static_cast<std::uint64_t>(static_cast<std::int64_t>(binade)) << 52));
  // r = m c − 1 exactly: c has ten bits, so both halves of m times c are exact.
  const double m_head = double_of(bits_of(m) & 0xffffffff00000000ULL);
  const Pair r = two_sum(m_head * cell[0] - 1, (m - m_head) * cell[0]);
  return logarithm_of(r, k * ln2_grid[0] + cell[1], k * ln2_grid[1] + cell[2]);  // the first sum is exact
}

namespace {

/// What a logarithm gives outside the positive finite numbers; x is none of these.
double logarithm_special(double x) { return x != x || x == infinity ? x : (x == 0 ? -infinity : not_a_number); }
bool is_ordinary(double x) { return x > 0 && x < infinity; }

/// (eˣ + sign e⁻ˣ)/2 for x ≥ 0.
double half_sum_of_exponentials(double x, double sign) {
  ScaledPair e = exponential({x, 0});
  if (x < 40) {
    const ScaledPair i = exponential({-x, 0});
    const double scale = power_of_two(i.k - e.k) * sign;  // |i.k − e.k| < 120
    const Pair s = sum({e.hi, e.lo}, {i.hi * scale, i.lo * scale});
    e.hi = s.hi;
    e.lo = s.lo;
  }
  --e.k;
  return assemble(e);
}

/// 0: not an integer, 1: odd, 2: even.
int integer_kind(double y) {
  const double a = magnitude(y);
  if (a >= 0x1p53) return 2;
  if (a < 1) return 0;
  const std::int64_t n = static_cast<std::int64_t>(a);
  if (static_cast<double>(n) != a) return 0;
  return (n & 1) != 0 ? 1 : 2;
}

}  // namespace
}  // namespace detail

using namespace detail;

double exp(double x) {
  if (x != x) return x;
  if (x > 709.9) return infinity;
  if (x < -746) return 0;
  return assemble(exponential({x, 0}));
}

double exp2(double x) {
  if (x != x) return x;
  if (x >= 1024) return infinity;
  if (x < -1076) return 0;
  const double n = (32 * x + exponential_shift) - exponential_shift;
  const double f = x - n * 0.03125;
  return assemble(exponential_of(static_cast<int>(n), product({f, 0}, {ln2[0][0], ln2[0][1]})));
}

double expm1(double x) {
  if (x != x) return x;
  if (x > 709.9) return infinity;
  if (x < -40) return -1;
  if (magnitude(x) < 0x1p-54) return x;
  if (magnitude(x) <= 0.3) {
    const Pair square = two_product(x, x);
    const Pair s = quick_sum(x, 0.5 * square.hi);
    return s.hi + (s.lo + (0.5 * square.lo + x * square.hi * polynomial(expm1_terms, x)));
  }
  const ScaledPair e = exponential({x, 0});
  if (e.k > 110) return assemble(e);
  const double scale = power_of_two(e.k);
  const Pair s = sum({e.hi * scale, e.lo * scale}, {-1, 0});
  return s.hi + s.lo;
}

double log(double x) {
  if (!is_ordinary(x)) return logarithm_special(x);
  const Pair l = logarithm(x);
  return l.hi + l.lo;
}

double log2(double x) {
  if (!is_ordinary(x)) return logarithm_special(x);
  const Pair l = product(logarithm(x), {one_over_ln2[0][0], one_over_ln2[0][1]});
  return l.hi + l.lo;
}

double log10(double x) {
  if (!is_ordinary(x)) return logarithm_special(x);
  const Pair l = product(logarithm(x), {one_over_ln10[0][0], one_over_ln10[0][1]});
  return l.hi + l.lo;
}

double log1p(double x) {
  if (magnitude(x) < 0x1p-54) return x;
  if (!(x > -1) || x == infinity) return x == -1 ? -infinity : (x == infinity || x != x ? x : not_a_number);
  if (x > 0x1p60) return log(x);
  if (magnitude(x) < 0x1p-8) {
    const Pair l = logarithm_of({x, 0}, 0, 0);
    return l.hi + l.lo;
  }
  // ln(s + e) = ln s + e/s: the rest of the rounded sum is far below a unit in its last place.
  const Pair s = two_sum(1, x);
  const Pair l = sum(logarithm(s.hi), {s.lo / s.hi, 0});
  return l.hi + l.lo;
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (x != x || y != y) return x + y;
  const double a = magnitude(x);
  if (magnitude(y) == infinity) {
    if (a == 1) return 1;
    return (a > 1) == (y > 0) ? infinity : 0.0;
  }
  const int kind = integer_kind(y);
  const double sign = is_negative(x) && kind == 1 ? -1.0 : 1.0;
  if (a == 0 || a == infinity) return sign * ((y > 0) == (a == infinity) ? infinity : 0.0);
  if (x < 0 && kind == 0) return not_a_number;
  if (a == 1) return sign;
  if (magnitude(y) > 0x1p64) return (a > 1) == (y > 0) ? infinity : 0.0;
  if (magnitude(y) < 0x1p-70) return 1;
  const Pair l = logarithm(a);
  const Pair p = two_product(y, l.hi);
  if (p.hi > 709.9) return sign * infinity;
  if (p.hi < -746) return sign * 0.0;
  return sign * assemble(exponential(quick_sum(p.hi, p.lo + y * l.lo)));
}

double cbrt(double x) {
  if (x == 0 || !(magnitude(x) < infinity)) return x;
  double a = magnitude(x);
  int shift = 0;
  if (a < 0x1p-1022) {
    a *= 0x1p54;
    shift = -18;
  }
  const int exponent = static_cast<int>(bits_of(a) >> 52) - 1023;
  const int third = (exponent + 3 * 400) / 3 - 400;  // floor
  const double m = double_of(bits_of(a) - (static_cast<std::uint64_t>(static_cast<std::int64_t>(3 * third)) << 52));
  double r = polynomial(cbrt_terms, m);
  for (int i = 0; i < 2; ++i) {  // Halley's iteration triples the digits
    const double cube = r * r * r;
    r = r * (cube + 2 * m) / (2 * cube + m);
  }
  const Pair square = two_product(r, r);
  const Pair cube = product(square, {r, 0});
  const double correction = ((m - cube.hi) - cube.lo) / (3 * square.hi);
  return with_sign((r + correction) * power_of_two(third + shift), x);
}

double hypot(double x, double y) {
  const double ax = magnitude(x), ay = magnitude(y);
  if (ax == infinity || ay == infinity) return infinity;
  if (ax != ax || ay != ay) return ax + ay;
  const double large = math::max(ax, ay), small = math::min(ax, ay);
  if (small == 0 || large * 0x1p-60 > small) return large + small;
  const double scale = large > 0x1p500 ? 0x1p-600 : (large < 0x1p-400 ? 0x1p600 : 1.0);
  const double back = large > 0x1p500 ? 0x1p600 : (large < 0x1p-400 ? 0x1p-600 : 1.0);
  const Pair s = sum(two_product(large * scale, large * scale), two_product(small * scale, small * scale));
  const Pair r = square_root(s);
  return (r.hi + r.lo) * back;
}

double sinh(double x) {
  if (!(magnitude(x) < infinity)) return x;
  const double a = magnitude(x);
  if (a < 0x1p-27) return x;
  if (a > 711) return with_sign(infinity, x);
  if (a <= 0.3) {
    const double z = x * x;
    return x + x * z * polynomial(sinh_terms, z);
  }
  return with_sign(half_sum_of_exponentials(a, -1), x);
}

double cosh(double x) {
  if (x != x) return x;
  const double a = magnitude(x);
  return a > 711 ? infinity : half_sum_of_exponentials(a, 1);
}

double tanh(double x) {
  if (x != x) return x;
  const double a = magnitude(x);
  if (a < 0x1p-27) return x;
  if (a > 20) return with_sign(1, x);
  if (a <= 0.3) {
    const double z = x * x;
    return x + x * z * polynomial(tanh_terms, z);
  }
  const ScaledPair e = exponential({2 * a, 0});
  const double scale = power_of_two(e.k);
  const Pair t = quotient(sum({e.hi * scale, e.lo * scale}, {-1, 0}), sum({e.hi * scale, e.lo * scale}, {1, 0}));
  return with_sign(t.hi + t.lo, x);
}

double fmod(double x, double y) {
  std::uint64_t a = bits_of(magnitude(x)), b = bits_of(magnitude(y));
  constexpr std::uint64_t top = 0x7ff0000000000000ULL, hidden = 0x0010000000000000ULL;
  if (b == 0 || a >= top || b > top) return not_a_number;
  if (a < b) return x;
  // Integers m · 2^e with the exponent of subnormals; the quotient is taken eleven bits at a time.
  int ea = static_cast<int>(a >> 52), eb = static_cast<int>(b >> 52);
  std::uint64_t ma = ea == 0 ? a : ((a & (hidden - 1)) | hidden), mb = eb == 0 ? b : ((b & (hidden - 1)) | hidden);
  ea = ea == 0 ? 1 : ea;
  eb = eb == 0 ? 1 : eb;
  ma %= mb;
  for (int left = ea - eb; left > 0 && ma != 0;) {
    const int step = left < 11 ? left : 11;
    ma = (ma << step) % mb;
    left -= step;
  }
  if (ma == 0) return with_sign(0, x);
  while (ma < hidden && eb > 1) {
    ma <<= 1;
    --eb;
  }
  const std::uint64_t r = ma < hidden ? ma : ((ma - hidden) | (static_cast<std::uint64_t>(eb) << 52));
  return with_sign(double_of(r), x);
}

}  // namespace carom::math
