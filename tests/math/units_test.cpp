// Quantities as text: factors from BIPM 2019 and NIST SP 811, dimension checking, round trips and messages.
#include "carom/math/units.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "carom/math/decimal.h"
#include "carom/math/quantity.h"
#include "tests/math/mpfr_reference.h"

namespace carom::test::units_tests {
namespace {

using namespace math::literals;
namespace dim = math::dimensions;

struct Row {
  const char* text;
  double si;
  math::Dimension dimension;
};

TEST(Units, TextToSi) {
  const Row rows[] = {
      {"30 mph", 13.4112, dim::speed},
      {"12 ft", 3.6576, dim::length},
      {"7.62 mm", 0.00762, dim::length},
      {"168 gr", 168 * 64.79891e-6, dim::mass},
      {"1200 kg/m^3", 1200, dim::density},
      {"1200kg/m³", 1200, dim::density},
      {"25 degC", 298.15, dim::temperature},
      {"-40 degF", 233.15, dim::temperature},
      {"−40 °F", 233.15, dim::temperature},
      {"5 deg", 5 * math::pi / 180, dim::angle},
      {"5°", 5 * math::pi / 180, dim::angle},
      {"30 rpm", math::pi, dim::angular_velocity},
      {"10 kN", 10000, dim::force},
      {"2 hp", 2 * 745.69987158227022, dim::power},
      {"1 slug", 14.593902937206364, dim::mass},
      {"14.7 psi", 14.7 * 6894.757293168361, dim::pressure},
      {"30 kn", 15.433333333333334, dim::speed},
      {"1 atm", 101325, dim::pressure},
      {"20 Hz", 20, dim::frequency},
      {"3 m/s^2", 3, dim::acceleration},
      {"3 m s^-2", 3, dim::acceleration},
      {"1.5 N*m", 1.5, dim::torque},
      {"1.5 N·m", 1.5, dim::torque},
      {"4 kg*m^2", 4, dim::moment_of_inertia},
      {"4 kg·m²", 4, dim::moment_of_inertia},
      {"50 %", 0.5, dim::none},
      {"0.25", 0.25, dim::none},
      {"1e-3 m", 0.001, dim::length},
      {"+2 km", 2000, dim::length},
      {"9 km/h", 2.5, dim::speed},
      {"5 /s", 5, dim::frequency},
      {"5 1/s", 5, dim::frequency},
      {"3 µm", 3e-6, dim::length},
      {"2 J/kg/K", 2, {0, 2, -2, -1}},
      {"2 J/(kg*K)", 2, {0, 2, -2, -1}},
      {"9 W/(m^2*degC)", 9, {1, 0, -3, -1}},
      {"9 delta_degF", 5, dim::temperature},
      {"8 slug*ft^2", 8 * 1.3558179483314004, dim::moment_of_inertia},
      {"1 lbf*s/ft", 14.593902937206364, dim::damping},
      {"2 m⁻¹", 2, {0, -1}},
      {"2 (m/s)^2", 4 / 2.0, {0, 2, -2}},
      {"1 cSt", 1e-6, dim::kinematic_viscosity},
      {"3 g0", 29.41995, dim::acceleration},
      {"3 N*m/rad", 3, dim::rotational_stiffness},
      {"1 min", 60, dim::time},
      {"1 kt", 1852.0 / 3600, dim::speed},
      {"12 inHg", 12 * 3386.388640341, dim::pressure},
  };
  for (const Row& row : rows) {
    const math::QuantityResult r = math::parse_quantity(row.text);
    EXPECT_TRUE(r.ok) << r.error;
    EXPECT_NEAR(r.si, row.si, 4e-16 * std::fabs(row.si)) << row.text;
    EXPECT_TRUE(r.dimension == row.dimension) << row.text << " " << to_string(r.dimension);
    EXPECT_TRUE(math::parse_quantity(row.text, row.dimension).ok) << row.text;
  }
}

TEST(Units, ErrorsSayWhatWasFoundAndWhatWasExpected) {
  const auto message = [](const char* text, math::Dimension d = dim::speed) {
    const math::QuantityResult r = math::parse_quantity(text, d);
    EXPECT_FALSE(r.ok) << text;
    return r.error;
  };
  const auto contains = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  contains(message("30 mhp"), "did you mean 'mph'");
  contains(message("30 Mph"), "did you mean 'mph'");
  contains(message("3 Kg", dim::mass), "did you mean 'kg'");
  contains(message("30 kg"), "found a mass [kg], expected a speed [m/s], such as '30 mph'");
  contains(message("30"), "found a plain number, expected a speed");
  contains(message("5 A", dim::force), "found an electric current [A], expected a force [N]");
  contains(message("mph"), "found no number");
  contains(message(""), "found no number");
  contains(message("nan m/s"), "found no number");
  contains(message("3 m/"), "where a unit name was expected");
  contains(message("3 m^x"), "no whole number behind '^'");
  contains(message("3 (m/s"), "no closing parenthesis");
  contains(message("3 m/s)"), "a stray ')'");
  contains(message("3 m^99"), "an exponent above 20");
  contains(message("1e999 m/s"), "beyond the largest double");
  contains(message("20 Hz", dim::angular_velocity), "Hz counts cycles");
  contains(message("20 rpm", dim::frequency), "counts cycles");
  contains(message("3 frobs"), "'frobs', which is no unit known here");
  EXPECT_TRUE(math::parse_quantity("20 1/s", dim::angular_velocity).ok);
  EXPECT_TRUE(math::parse_quantity("20 Hz*deg", dim::angular_velocity).ok) << "degrees a second (found by the fuzzer)";
}

TEST(Units, AdversarialTextIsRefusedNotFollowed) {
  std::string deep = "1 ";
  for (int i = 0; i < 100000; ++i) deep += "(";
  EXPECT_FALSE(math::parse_quantity(deep).ok);
  std::string many = "1 m";
  for (int i = 0; i < 100000; ++i) many += "*m";
  EXPECT_FALSE(math::parse_quantity(many).ok);
  EXPECT_FALSE(math::parse_quantity("1 km^20*km^20*km^20*km^20*km^20*km^20").ok);
  EXPECT_FALSE(math::parse_quantity("1 (((km^20)^20)^20)").ok);
  Arguments arguments(42);
  const char alphabet[] = "0123456789.eE+-*/^() mkgsNPaHzdeC\xc2\xb2\xb0%\xff";
  for (int i = 0; i < 20000; ++i) {
    std::string text = (i & 1) != 0 ? "1 " : "";
    for (std::uint64_t n = arguments.bits() % 12; n > 0; --n)
      text += alphabet[arguments.bits() % (sizeof alphabet - 1)];
    const math::QuantityResult r = math::parse_quantity(text);
    EXPECT_EQ(r.ok, r.error.empty());
    EXPECT_TRUE(!r.ok || std::isfinite(r.si)) << text;
  }
}

// Mechanics reference 1.2: round-trip conversion error ≤ 2 ulp; text comes back to the same double nearly always.
TEST(Units, RoundTripWithinTwoUlp) {
  Arguments arguments(7);
  for (const std::string_view unit : math::unit_names()) {
    for (int i = 0; i < 200; ++i) {
      const double si = arguments.spread(-20, 20);
      const std::string text = math::format_quantity(si, unit);
      const math::QuantityResult r = math::parse_quantity(text);
      ASSERT_TRUE(r.ok) << r.error;
      const bool affine = unit == "degC" || unit == "°C" || unit == "℃" || unit == "degF" || unit == "°F";
      const double size = affine ? std::fabs(si) + 500 : std::fabs(si);
      EXPECT_LE(std::fabs(r.si - si), 2 * (std::nextafter(size, HUGE_VAL) - size)) << text;
      const math::QuantityResult there = math::convert(si, "m", "ft");
      const math::QuantityResult back = math::convert(there.si, "ft", "m");
      EXPECT_LE(std::fabs(back.si - si), 2 * (std::nextafter(std::fabs(si), HUGE_VAL) - std::fabs(si)));
    }
  }
}

TEST(Units, WhatWasTypedIsWhatIsPrinted) {
  for (const char* text : {"30 mph", "12 ft", "7.62 mm", "168 gr", "25 degC", "5 deg", "30 rpm", "14.7 psi", "0.1 kn",
                           "1200 kg/m^3", "-40 degF", "1e-07 m", "98.6 degF", "50 %"}) {
    const std::string_view t = text;
    const math::QuantityResult r = math::parse_quantity(text);
    EXPECT_EQ(math::format_quantity(r.si, t.substr(t.find(' ') + 1)), text);
  }
  EXPECT_EQ(math::format_quantity(1.0 / 3, "m", 3), "0.333 m");
  EXPECT_EQ(math::format_quantity(1234.5, "m", 2), "1200 m");
  EXPECT_EQ(math::format_quantity(2.5, ""), "2.5");
  EXPECT_EQ(math::format_quantity(2.5, "nonsense"), "");
}

// Mechanics reference, section 0.
TEST(Units, ConventionsOfTheReference) {
  EXPECT_NEAR(math::convert(1, "slug", "kg").si, 14.5939, 5e-5);
  EXPECT_NEAR(math::convert(1, "lbf", "N").si, 4.44822, 5e-6);
  EXPECT_EQ(math::convert(1, "ft", "m").si, 0.3048);
  EXPECT_NEAR(math::convert(1, "hp", "W").si, 745.70, 5e-3);
  EXPECT_NEAR(math::convert(1, "kn", "m/s").si, 0.514444, 5e-7);
  EXPECT_EQ(math::convert(1, "mph", "m/s").si, 0.44704);
  EXPECT_NEAR(math::convert(1, "gr", "mg").si, 64.79891, 5e-14);
  EXPECT_NEAR(math::convert(100, "degC", "degF").si, 212, 1e-13);
  EXPECT_FALSE(math::convert(1, "kg", "m").ok);
}

// Against the C library's correctly rounded strtod.
TEST(Decimal, ParsesToTheNearestDouble) {
  const auto check = [](const std::string& text) {
    const math::DecimalResult r = math::parse_decimal(text);
    EXPECT_EQ(r.length, text.size()) << text;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(r.value), std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)))
        << text;
  };
  for (const char* text : {"0",
                           "-0",
                           "1",
                           "0.1",
                           "1e22",
                           "1e23",
                           "9007199254740993",
                           "9007199254740992.5",
                           "5e-324",
                           "2.4703282292062327208e-324",
                           "2.4703282292062328e-324",
                           "1.7976931348623157e308",
                           "1.7976931348623158e308",
                           "1.7976931348623159e308",
                           "2.2250738585072011e-308",
                           "2.2250738585072014e-308",
                           "123456789012345678901234567890",
                           "1e400",
                           "1e-400",
                           ".5",
                           "5."}) {
    check(text);
  }
  check("0." + std::string(400, '0') + "1" + std::string(500, '3') + "e100");
  check("9007199254740993" + std::string(900, '0') + "1e-901");
  check("1" + std::string(320, '0'));
  Arguments arguments(99);
  for (int i = 0; i < 20000; ++i) {
    const double x = std::bit_cast<double>(arguments.bits());
    if (!std::isfinite(x)) continue;
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.*e", static_cast<int>(arguments.bits() % 25), x);
    check(buffer);
    const std::string shortest = math::format_decimal(x);
    EXPECT_EQ(math::parse_decimal(shortest).value, x) << shortest;
  }
}

TEST(Decimal, TakesTheLongestNumberAndNoMore) {
  EXPECT_EQ(math::parse_decimal("12ft").length, 2u);
  EXPECT_EQ(math::parse_decimal("1e").length, 1u);
  EXPECT_EQ(math::parse_decimal("1e+").length, 1u);
  EXPECT_EQ(math::parse_decimal("1.2.3").length, 3u);
  EXPECT_EQ(math::parse_decimal("3 m").length, 1u);
  for (const char* text : {"", "-", "+.", ".", "inf", "nan", " 1", "e5"})
    EXPECT_EQ(math::parse_decimal(text).length, 0u) << text;
}

template <class A, class B>
concept Addable = requires(A a, B b) { a + b; };
template <class A, class B>
concept Comparable = requires(A a, B b) { a < b; };
template <class A, class B>
concept Assignable = requires(A a, B b) { a = b; };

// Mechanics reference 1.2: adding unlike dimensions fails to compile.
TEST(Quantity, UnlikeDimensionsDoNotAdd) {
  static_assert(Addable<math::Length, math::Length>);
  static_assert(!Addable<math::Length, math::Time>);
  static_assert(!Addable<math::Length, double>);
  static_assert(!Comparable<math::Mass, math::Force>);
  static_assert(!Assignable<math::Speed, math::Length>);
  static_assert(!Assignable<math::Speed, double>);
  static_assert(std::is_same_v<decltype(1_m / 1_m), double>);
  EXPECT_EQ(6_m / 2_m, 3.0);
}

TEST(Quantity, ArithmeticCarriesTheDimension) {
  static_assert(std::is_same_v<decltype(1.0_m / 2.0_s), math::Speed>);
  static_assert(std::is_same_v<decltype(2.0_kg * (3.0_m / (1.0_s * 1.0_s))), math::Force>);
  static_assert(std::is_same_v<decltype(1.0 / 2.0_s), math::Frequency>);
  static_assert(sizeof(math::Speed) == sizeof(double));
  EXPECT_EQ((30.0_mph).si(), 13.4112);
  EXPECT_EQ((168_gr).si(), 168 * 0.45359237 / 7000);
  EXPECT_EQ((7.62_mm).si(), 0.00762);
  EXPECT_EQ((1'000_m).in(1_km), 1);
  EXPECT_EQ(math::sqrt(9_m2).si(), 3);
  const double ratio = 6_m / 2_m;
  EXPECT_EQ(ratio, 3);
  EXPECT_EQ(180_deg, math::pi);
  EXPECT_TRUE(1_mi > 1_km);
  EXPECT_TRUE(math::Speed::dimension() == dim::speed);
  math::Length d = 2_m;
  d += 50_cm;
  d *= 2;
  EXPECT_EQ(d.si(), 5);
}

}  // namespace
}  // namespace carom::test::units_tests
