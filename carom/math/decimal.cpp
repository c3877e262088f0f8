#include "carom/math/decimal.h"

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "carom/math/detail/double_double.h"

namespace carom::math {
namespace {

__extension__ typedef unsigned __int128 DoubleWord;  // NOLINT(modernize-use-using): wants a typedef

/// A natural number of any size, lowest word first, without leading zero words.
class BigNatural {
 public:
  explicit BigNatural(std::uint64_t n) {
    if (n != 0) words_.push_back(n);
  }
  void multiply_add(std::uint64_t factor, std::uint64_t addend) {
    std::uint64_t carry = addend;
    for (std::uint64_t& w : words_) {
      const DoubleWord t = static_cast<DoubleWord>(w) * factor + carry;
      w = static_cast<std::uint64_t>(t);
      carry = static_cast<std::uint64_t>(t >> 64);
    }
    if (carry != 0) words_.push_back(carry);
  }
  void shift_left(int bits) {
    words_.insert(words_.begin(), static_cast<std::size_t>(bits / 64), 0);
    multiply_add(std::uint64_t{1} << (bits % 64), 0);
  }
  void times_power_of_ten(int n) {
    for (; n >= 19; n -= 19) multiply_add(10000000000000000000ULL, 0);
    for (; n > 0; --n) multiply_add(10, 0);
  }
  int bit_length() const { return static_cast<int>(words_.size()) * 64 - __builtin_clzll(words_.back()); }
  /// The highest 64 bits, the first of them one.
  std::uint64_t leading_bits() const {
    const int zeros = __builtin_clzll(words_.back());
    const std::uint64_t next = words_.size() > 1 ? words_[words_.size() - 2] : 0;
    return zeros == 0 ? words_.back() : (words_.back() << zeros) | (next >> (64 - zeros));
  }
  static int compare(const BigNatural& a, const BigNatural& b) {
    if (a.words_.size() != b.words_.size()) return a.words_.size() < b.words_.size() ? -1 : 1;
    for (std::size_t i = a.words_.size(); i-- > 0;) {
      if (a.words_[i] != b.words_[i]) return a.words_[i] < b.words_[i] ? -1 : 1;
    }
    return 0;
  }

 private:
  std::vector<std::uint64_t> words_;
};

/// The sign of numerator/denominator − m · 2^e.
int compare_ratio(BigNatural numerator, BigNatural denominator, std::uint64_t m, int e) {
  if (m == 0) return 1;
  denominator.multiply_add(m, 0);
  (e >= 0 ? denominator : numerator).shift_left(e >= 0 ? e : -e);
  return BigNatural::compare(numerator, denominator);
}

/// numerator/denominator to the nearest double; both above zero, the ratio between 1e-345 and 1e310.
double nearest_double(const BigNatural& numerator, const BigNatural& denominator) {
  const double ratio =
      static_cast<double>(numerator.leading_bits()) / static_cast<double>(denominator.leading_bits());  // in (½, 2)
  int e = numerator.bit_length() - denominator.bit_length() - 52 - (ratio < 1 ? 1 : 0);
  std::uint64_t m = static_cast<std::uint64_t>(ratio * (ratio < 1 ? 0x1p53 : 0x1p52));
  if (e < -1074) {
    m = -1074 - e > 63 ? 0 : m >> (-1074 - e);
    e = -1074;
  }
  // m · 2^e is within a few units of the ratio; make it the floor, then round.
  while (compare_ratio(numerator, denominator, m, e) < 0) --m;
  while (compare_ratio(numerator, denominator, m + 1, e) >= 0) ++m;
  const int half = compare_ratio(numerator, denominator, 2 * m + 1, e - 1);
  if (half > 0 || (half == 0 && (m & 1) != 0)) ++m;
  // Scaling in two steps is exact: m has at most 54 bits and e is at its floor where the result is subnormal.
  if (e > 971) return detail::infinity;
  const double v = static_cast<double>(m);
  return e < -1000 ? v * detail::power_of_two(e + 600) * detail::power_of_two(-600) : v * detail::power_of_two(e);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

DecimalResult parse_decimal(std::string_view text) {
  std::size_t i = 0;
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) ++i;

  // The first 19 digits fit a word; a double's exact midpoint has at most 767 digits, so beyond 800 only "not zero"
  // counts.
  std::string digits;
  long long exponent = 0;
  bool any = false, more = false, point = false;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '.' && !point) {
      if (!any && (i + 1 >= text.size() || !is_digit(text[i + 1]))) break;
      point = true;
      continue;
    }
    if (!is_digit(c)) break;
    any = true;
    if (digits.size() >= 800) {
      more = more || c != '0';
      if (!point) ++exponent;
      continue;
    }
    if (c != '0' || !digits.empty()) digits.push_back(c);
    if (point) --exponent;
  }
  if (!any) return {};
  if (i + 1 < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t j = i + 1;
    const bool minus = text[j] == '-';
    if (text[j] == '-' || text[j] == '+') ++j;
    if (j < text.size() && is_digit(text[j])) {
      long long e = 0;
      for (; j < text.size() && is_digit(text[j]); ++j) e = e < 100000000 ? 10 * e + (text[j] - '0') : e;
      exponent += minus ? -e : e;
      i = j;
    }
  }
  if (more) {
    digits.push_back('1');
    --exponent;
  }
  while (!digits.empty() && digits.back() == '0') {
    digits.pop_back();
    ++exponent;
  }
  const double sign = negative ? -1.0 : 1.0;
  if (digits.empty()) return {sign * 0.0, i};
  const long long top = exponent + static_cast<long long>(digits.size());  // value in [10^(top−1), 10^top)
  if (top > 310) return {sign * detail::infinity, i};
  if (top < -330) return {sign * 0.0, i};

  if (digits.size() <= 15 && exponent >= -22 && exponent <= 22) {
    // Both factors are exact doubles, so one rounding remains (Clinger 1990).
    double m = 0, p = 1;
    for (const char c : digits) m = 10 * m + (c - '0');
    for (long long k = exponent < 0 ? -exponent : exponent; k > 0; --k) p *= 10;
    return {sign * (exponent < 0 ? m / p : m * p), i};
  }
  BigNatural numerator(0), denominator(1);
  for (const char c : digits) numerator.multiply_add(10, static_cast<std::uint64_t>(c - '0'));
  (exponent >= 0 ? numerator : denominator).times_power_of_ten(static_cast<int>(exponent >= 0 ? exponent : -exponent));
  return {sign * nearest_double(numerator, denominator), i};
}

namespace {

#if defined(__wasm__)
// The C++ library prints by tables that would be an eighth of the module that a page loads. The C library there prints
// exactly as well, knows one locale, and has no tables; it is slower, which texts do not mind.
std::string print(const char* form, int digits, double x) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, form, digits, x);
  return buffer;
}

template <class T>
std::string shortest(T x) {
  int precision = 0;
  std::string text = print("%.*e", precision, double(x));
  while (T(parse_decimal(text).value) != x && precision < 17) text = print("%.*e", ++precision, double(x));
  // As std::to_chars: without exponent where that is not longer.
  const int exponent = std::atoi(text.c_str() + text.find('e') + 1);
  const std::string plain = print("%.*f", precision > exponent ? precision - exponent : 0, double(x));
  return plain.size() <= text.size() ? plain : text;
}
std::string scientific(double x, int digits) { return print("%.*e", digits, x); }
#else
template <class T>
std::string shortest(T x) {
  char buffer[40];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr);
}
std::string scientific(double x, int digits) {
  char buffer[64];
  return std::string(buffer,
                     std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::scientific, digits).ptr);
}
#endif

std::string not_finite(double x) { return x != x ? "nan" : (x > 0 ? "inf" : "-inf"); }

}  // namespace

std::string format_decimal(double x) { return is_finite(x) ? shortest(x) : not_finite(x); }
std::string format_decimal(float x) { return is_finite(double(x)) ? shortest(x) : not_finite(double(x)); }

std::string format_decimal(double x, int digits) {
  if (!is_finite(x)) return not_finite(x);
  return format_decimal(parse_decimal(scientific(x, clamp(digits, 1, 17) - 1)).value);
}

std::string format_fixed(double x, int digits) {
  if (!is_finite(x)) return not_finite(x);
#if defined(__wasm__)
  return print("%.*f", clamp(digits, 0, 99), x);
#else
  char buffer[512];
  return std::string(
      buffer, std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::fixed, clamp(digits, 0, 99)).ptr);
#endif
}

}  // namespace carom::math
