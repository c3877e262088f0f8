// Errors of our elementary functions in units in the last place, measured against MPFR with 200 bits.
#pragma once

#include <mpfr.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace carom::test {

using MpfrUnary = int (*)(mpfr_t, const mpfr_t, mpfr_rnd_t);
using MpfrBinary = int (*)(mpfr_t, const mpfr_t, const mpfr_t, mpfr_rnd_t);

class MpfrReference {
 public:
  MpfrReference() { mpfr_inits2(200, x_, y_, exact_, error_, nullptr); }
  ~MpfrReference() { mpfr_clears(x_, y_, exact_, error_, nullptr); }
  MpfrReference(const MpfrReference&) = delete;
  MpfrReference& operator=(const MpfrReference&) = delete;

  template <class T>
  double unary(MpfrUnary f, T x, T result) {
    mpfr_set_d(x_, static_cast<double>(x), MPFR_RNDN);
    f(exact_, x_, MPFR_RNDN);
    return error_of(result);
  }
  template <class T>
  double binary(MpfrBinary f, T x, T y, T result) {
    mpfr_set_d(x_, static_cast<double>(x), MPFR_RNDN);
    mpfr_set_d(y_, static_cast<double>(y), MPFR_RNDN);
    f(exact_, x_, y_, MPFR_RNDN);
    return error_of(result);
  }

 private:
  /// |result − exact| over the spacing of T at the exact value; infinite where the kinds differ.
  template <class T>
  double error_of(T result) {
    using Limits = std::numeric_limits<T>;
    const T rounded = sizeof(T) == 4 ? static_cast<T>(mpfr_get_flt(exact_, MPFR_RNDN))
                                     : static_cast<T>(mpfr_get_d(exact_, MPFR_RNDN));
    if (std::isnan(rounded) || std::isnan(result)) return std::isnan(rounded) == std::isnan(result) ? 0 : HUGE_VAL;
    if (std::isinf(rounded) || std::isinf(result)) {
      if (rounded == result) return 0;
      // One of the two neighbours of the overflow threshold is at most one unit away.
      const bool neighbour = std::abs(rounded) == Limits::max() || std::abs(result) == Limits::max();
      return neighbour && std::signbit(rounded) == std::signbit(result) ? 1 : HUGE_VAL;
    }
    if (mpfr_zero_p(exact_)) return result == 0 ? 0 : HUGE_VAL;
    const long exponent = mpfr_get_exp(exact_) - Limits::digits;
    const long lowest = Limits::min_exponent - Limits::digits;
    mpfr_set_d(error_, static_cast<double>(result), MPFR_RNDN);
    mpfr_sub(error_, error_, exact_, MPFR_RNDN);
    mpfr_mul_2si(error_, error_, -(exponent < lowest ? lowest : exponent), MPFR_RNDN);
    return std::abs(mpfr_get_d(error_, MPFR_RNDN));
  }
  mpfr_t x_, y_, exact_, error_;
};

/// A small generator of test arguments, independent of the library's own.
class Arguments {
 public:
  explicit Arguments(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return state_ * 0x2545f4914f6cdd1dULL;
  }
  /// Uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53); }
  /// Either sign, magnitude spread evenly over the binades from 2^low to 2^high.
  double spread(int low, int high) {
    const double m = between(1, 2);
    const int e = low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low));
    return std::ldexp((bits() & 1) != 0 ? m : -m, e);
  }

 private:
  std::uint64_t state_;
};

}  // namespace carom::test
