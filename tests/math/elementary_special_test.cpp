// Special values of the elementary functions as C99 annex F gives them, exact cases, and the bits over a fixed sample.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carom/math/elementary.h"
#include "carom/math/vec.h"
#include "tests/math/elementary_hash.h"

namespace carom::test::elementary_special_tests {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

void expect_zero(double x, bool negative) {
  EXPECT_EQ(x, 0);
  EXPECT_EQ(std::signbit(x), negative);
}

// The same number is checked by the WASM and the clang builds: it is the promise of equal bits.
TEST(ElementaryBits, HashOverAFixedSampleIsTheGoldenOne) { EXPECT_EQ(elementary_hash(), 0xfcc48fcebffceba1ULL); }

TEST(ElementarySpecial, ZeroKeepsItsSignInOddFunctions) {
  for (double (*f)(double) : {static_cast<double (*)(double)>(math::sin), static_cast<double (*)(double)>(math::tan),
                              static_cast<double (*)(double)>(math::asin), static_cast<double (*)(double)>(math::atan),
                              static_cast<double (*)(double)>(math::sinh), static_cast<double (*)(double)>(math::tanh),
                              static_cast<double (*)(double)>(math::cbrt), static_cast<double (*)(double)>(math::expm1),
                              static_cast<double (*)(double)>(math::log1p)}) {
    expect_zero(f(0.0), false);
    expect_zero(f(-0.0), true);
    EXPECT_TRUE(std::isnan(f(nan_value)));
  }
}

TEST(ElementarySpecial, DomainErrorsAreNaN) {
  EXPECT_TRUE(std::isnan(math::sin(inf)) && std::isnan(math::cos(-inf)) && std::isnan(math::tan(inf)));
  EXPECT_TRUE(std::isnan(math::asin(1.0000001)) && std::isnan(math::acos(-1.0000001)));
  EXPECT_TRUE(std::isnan(math::log(-1.0)) && std::isnan(math::log2(-inf)) && std::isnan(math::log10(-0.5)));
  EXPECT_TRUE(std::isnan(math::log1p(-1.5)) && std::isnan(math::pow(-8.0, 1.0 / 3)));
  EXPECT_TRUE(std::isnan(math::fmod(1.0, 0.0)) && std::isnan(math::fmod(inf, 1.0)));
}

TEST(ElementarySpecial, PolesAndLimits) {
  EXPECT_EQ(math::log(0.0), -inf);
  EXPECT_EQ(math::log(-0.0), -inf);
  EXPECT_EQ(math::log1p(-1.0), -inf);
  EXPECT_EQ(math::log(inf), inf);
  EXPECT_EQ(math::exp(-inf), 0);
  EXPECT_EQ(math::exp(inf), inf);
  EXPECT_EQ(math::exp(710.0), inf);
  EXPECT_EQ(math::exp(-750.0), 0);
  EXPECT_EQ(math::expm1(-inf), -1);
  EXPECT_EQ(math::tanh(inf), 1);
  EXPECT_EQ(math::tanh(-inf), -1);
  EXPECT_EQ(math::sinh(-inf), -inf);
  EXPECT_EQ(math::cosh(-inf), inf);
  EXPECT_EQ(math::cosh(0.0), 1);
  EXPECT_EQ(math::atan(inf), math::pi / 2);
  EXPECT_EQ(math::cos(0.0), 1);
  EXPECT_EQ(math::acos(1.0), 0);
  EXPECT_EQ(math::acos(-1.0), math::pi);
  EXPECT_EQ(math::asin(-1.0), -math::pi / 2);
}

TEST(ElementarySpecial, ExactResultsAreExact) {
  for (int k = -1074; k < 1024; ++k) {
    EXPECT_EQ(math::exp2(static_cast<double>(k)), std::ldexp(1.0, k));
    EXPECT_EQ(math::log2(std::ldexp(1.0, k)), k);
  }
  double ten = 1;
  for (int k = 0; k <= 22; ++k, ten *= 10) {
    EXPECT_EQ(math::log10(ten), k);
    EXPECT_EQ(math::pow(10.0, static_cast<double>(k)), ten);
  }
  for (int k = 1; k < 2000; ++k) {
    EXPECT_EQ(math::cbrt(static_cast<double>(k) * k * k), k);
    EXPECT_EQ(math::hypot(3.0 * k, 4.0 * k), 5.0 * k);
    EXPECT_EQ(math::pow(static_cast<double>(k), 2.0), static_cast<double>(k) * k);
    EXPECT_EQ(math::pow(static_cast<double>(k) * k, 0.5), k);
  }
}

// C99 F.9.1.4.
TEST(ElementarySpecial, Atan2AtZerosAndInfinities) {
  expect_zero(math::atan2(0.0, 1.0), false);
  expect_zero(math::atan2(-0.0, 1.0), true);
  EXPECT_EQ(math::atan2(0.0, -1.0), math::pi);
  EXPECT_EQ(math::atan2(-0.0, -1.0), -math::pi);
  EXPECT_EQ(math::atan2(0.0, -0.0), math::pi);
  EXPECT_EQ(math::atan2(-0.0, -0.0), -math::pi);
  expect_zero(math::atan2(-0.0, 0.0), true);
  EXPECT_EQ(math::atan2(-2.0, 0.0), -math::pi / 2);
  EXPECT_EQ(math::atan2(inf, inf), math::pi / 4);
  EXPECT_EQ(math::atan2(-inf, -inf), -2.356194490192345);
  expect_zero(math::atan2(1.0, inf), false);
  EXPECT_EQ(math::atan2(1.0, -inf), math::pi);
  EXPECT_EQ(math::atan2(inf, 3.0), math::pi / 2);
  EXPECT_EQ(math::atan2(0x1p-1074, 0x1p-1074), math::pi / 4);
  EXPECT_EQ(math::atan2(0x1p1023, 0x1p1023), math::pi / 4);
}

// C99 F.9.4.4.
TEST(ElementarySpecial, Pow) {
  EXPECT_EQ(math::pow(nan_value, 0.0), 1);
  EXPECT_EQ(math::pow(1.0, nan_value), 1);
  EXPECT_EQ(math::pow(-1.0, inf), 1);
  EXPECT_EQ(math::pow(-1.0, 3.0), -1);
  EXPECT_EQ(math::pow(-1.0, 0x1p60), 1);
  EXPECT_EQ(math::pow(0.5, inf), 0);
  EXPECT_EQ(math::pow(0.5, -inf), inf);
  EXPECT_EQ(math::pow(2.0, inf), inf);
  EXPECT_EQ(math::pow(2.0, -inf), 0);
  expect_zero(math::pow(-0.0, 3.0), true);
  expect_zero(math::pow(-0.0, 2.0), false);
  EXPECT_EQ(math::pow(-0.0, -3.0), -inf);
  EXPECT_EQ(math::pow(0.0, -0.5), inf);
  expect_zero(math::pow(-inf, -3.0), true);
  EXPECT_EQ(math::pow(-inf, 3.0), -inf);
  EXPECT_EQ(math::pow(-inf, 0.5), inf);
  EXPECT_EQ(math::pow(-2.0, 3.0), -8);
  EXPECT_EQ(math::pow(2.0, 1024.0), inf);
  EXPECT_EQ(math::pow(-2.0, 1025.0), -inf);
  EXPECT_EQ(math::pow(2.0, -1074.0), 0x1p-1074);
  EXPECT_EQ(math::pow(2.0, 1e300), inf);
  EXPECT_EQ(math::pow(0.5, 1e300), 0);
}

TEST(ElementarySpecial, HypotOfInfinityAndNaN) {
  EXPECT_EQ(math::hypot(inf, nan_value), inf);
  EXPECT_EQ(math::hypot(nan_value, -inf), inf);
  EXPECT_TRUE(std::isnan(math::hypot(nan_value, 1.0)));
  EXPECT_EQ(math::hypot(0x1p1023, 0x1p1023), 0x1.6a09e667f3bcdp1023);
  EXPECT_EQ(math::hypot(3 * 0x1p-1074, 4 * 0x1p-1074), 5 * 0x1p-1074);
}

TEST(ElementarySpecial, SincosHasTheBitsOfSinAndCos) {
  for (double x = -1000; x < 1000; x += 0.37) {
    const math::SinCos<double> r = math::sincos(x);
    EXPECT_EQ(r.sin, math::sin(x));
    EXPECT_EQ(r.cos, math::cos(x));
    const math::SinCos<float> f = math::sincos(static_cast<float>(x));
    EXPECT_EQ(f.sin, math::sin(static_cast<float>(x)));
    EXPECT_EQ(f.cos, math::cos(static_cast<float>(x)));
  }
}

}  // namespace
}  // namespace carom::test::elementary_special_tests
