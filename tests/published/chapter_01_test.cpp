// Chapter 1 of the subject, what is mathematics: units (1.2), derivatives and integrals (1.5), relativistic time (1.9).
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "carom/math/calculus.h"
#include "carom/math/elementary.h"
#include "carom/math/quantity.h"
#include "carom/math/relativity.h"
#include "carom/math/units.h"

namespace carom::test::chapter_01 {
namespace {

using namespace carom::math;

// 1.2: round-trip conversion error ≤ 2 ulp between SI and US units.
TEST(Chapter01Units, RoundTripWithinTwoUlp) {
  const char* pairs[][2] = {{"m", "ft"},      {"kg", "slug"},    {"N", "lbf"},
                            {"W", "hp"},      {"m/s", "mph"},    {"m/s", "kn"},
                            {"kg", "gr"},     {"Pa", "psi"},     {"kg/m^3", "slug/ft^3"},
                            {"rad", "deg"},   {"N*m", "lbf*ft"}, {"kg*m^2", "slug*ft^2"},
                            {"rad/s", "rpm"}, {"K", "degR"}};
  for (const auto& [si, us] : pairs) {
    for (double x = 1e-6; x < 1e7; x *= 1.37) {
      const QuantityResult there = convert(x, si, us);
      ASSERT_TRUE(there.ok) << there.error;
      const QuantityResult back = convert(there.si, us, si);
      EXPECT_LE(std::fabs(back.si - x), 2 * (std::nextafter(x, HUGE_VAL) - x)) << si << " " << us;
    }
  }
}

// 1.2: the conversion constants that the subject's conventions name (BIPM, NIST SP 811), to their printed digits.
TEST(Chapter01Units, PublishedFactors) {
  EXPECT_NEAR(convert(1, "slug", "kg").si, 14.5939, 5e-5);
  EXPECT_NEAR(convert(1, "lbf", "N").si, 4.44822, 5e-6);
  EXPECT_NEAR(convert(1, "hp", "W").si, 745.70, 5e-3);
  EXPECT_NEAR(convert(1, "kn", "m/s").si, 0.514444, 5e-7);
  EXPECT_NEAR(convert(0.0023769, "slug/ft^3", "kg/m^3").si, 1.225, 5e-4);
}

template <class A, class B>
concept Adds = requires(A a, B b) { a + b; };

// 1.2: adding unlike dimensions fails to compile.
TEST(Chapter01Units, UnlikeDimensionsDoNotAdd) {
  static_assert(Adds<Length, Length> && !Adds<Length, Time> && !Adds<Mass, Force>);
  EXPECT_FALSE(parse_quantity("30 mph", dimensions::length).ok);
}

// 1.5: the error of the central difference goes as h²: halving h quarters it (ratio 4 ± 0.01).
TEST(Chapter01Calculus, CentralDifferenceErrorGoesAsHSquared) {
  const auto f = [](double x) { return math::sin(x); };
  const double exact = math::cos(0.7);
  for (double h = 0.1; h > 1e-3; h /= 2) {
    const double coarse = central_difference(f, 0.7, h) - exact, fine = central_difference(f, 0.7, h / 2) - exact;
    EXPECT_NEAR(coarse / fine, 4, 0.01);
    const double forward = (forward_difference(f, 0.7, h) - exact) / (forward_difference(f, 0.7, h / 2) - exact);
    EXPECT_NEAR(forward, 2, 0.15);
  }
  EXPECT_NEAR(second_difference(f, 0.7, 1e-3), -math::sin(0.7), 1e-7);
}

// 1.5: Simpson's rule is exact for cubics, by function and by samples with an even or odd number of intervals.
TEST(Chapter01Calculus, SimpsonIsExactForCubics) {
  const auto cubic = [](double x) { return 4 * x * x * x - 3 * x * x + 2 * x - 1; };
  const auto integral = [](double x) { return x * x * x * x - x * x * x + x * x - x; };
  const double exact = integral(3) - integral(-1);
  EXPECT_NEAR(simpson(cubic, -1, 3, 2), exact, 1e-13);
  EXPECT_NEAR(simpson(cubic, -1, 3, 7), exact, 1e-13);
  for (int intervals = 2; intervals < 12; ++intervals) {
    std::vector<double> samples;
    for (int i = 0; i <= intervals; ++i) samples.push_back(cubic(-1 + 4.0 * i / intervals));
    EXPECT_NEAR(simpson(samples, 4.0 / intervals), exact, 1e-13) << intervals;
  }
}

// The golden section closes in on the lowest point of a parabola and of what has a corner.
TEST(Chapter01Calculus, TheLeastPlaceOfWhatFallsAndRises) {
  EXPECT_NEAR(least_place([](double x) { return (x - 0.3) * (x - 0.3); }, -2, 5, 40), 0.3, 1e-7);
  EXPECT_NEAR(least_place([](double x) { return x < 1 ? 1 - x : 5 * (x - 1); }, 0, 10, 40), 1, 1e-7);
  EXPECT_NEAR(least_place([](double x) { return x; }, 2, 3, 30), 2, 1e-6);  // at the border
}

// 1.5: v = ds/dt and back: samples of a parabola differentiate exactly, and the trapezoid of a line is exact.
TEST(Chapter01Calculus, SpeedFromDistanceAndBack) {
  std::vector<double> s, v(21), t;
  for (int i = 0; i <= 20; ++i) {
    t.push_back(0.1 * i);
    s.push_back(0.5 * 9.80665 * t.back() * t.back());
  }
  ASSERT_TRUE(differentiate(s, 0.1, v));
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_NEAR(v[i], 9.80665 * t[i], 1e-12);
  EXPECT_NEAR(trapezoid(v, 0.1), s.back(), 1e-12);
  EXPECT_NEAR(trapezoid(t, v), s.back(), 1e-12);
  // The trapezoid's error goes as h².
  const auto f = [](double x) { return math::exp(x); };
  const double exact = math::expm1(1.0);
  EXPECT_NEAR((trapezoid(f, 0, 1, 10) - exact) / (trapezoid(f, 0, 1, 20) - exact), 4, 0.01);
  EXPECT_FALSE(differentiate(std::vector<double>{1, 2}, 0.1, v));
  EXPECT_TRUE(std::isnan(trapezoid(std::vector<double>{1, 2}, v)));
}

// 1.9: γ(0.6 c) = 1.25 and γ(0.8 c) = 1.6667 (5/3), to rounding.
TEST(Chapter01Relativity, LorentzFactor) {
  EXPECT_NEAR(lorentz_factor(0.6 * speed_of_light), 1.25, 1e-15);
  EXPECT_NEAR(lorentz_factor(0.8 * speed_of_light), 5.0 / 3, 1e-15);
  EXPECT_NEAR(lorentz_factor_minus_one(0.6 * speed_of_light), 0.25, 1e-15);
  // At 30 m/s: β²/2 to first order.
  EXPECT_NEAR(lorentz_factor_minus_one(30), 0.5 * (30 / speed_of_light) * (30 / speed_of_light), 1e-28);
  EXPECT_EQ(lorentz_factor(0), 1);
  EXPECT_TRUE(std::isinf(lorentz_factor(speed_of_light)));
  EXPECT_TRUE(std::isnan(lorentz_factor(1.1 * speed_of_light)));
}

// 1.9: the travelling twin at 0.8 c for 10 years of the other's time ages 6; lengths shrink by γ.
TEST(Chapter01Relativity, TwinsAndLengths) {
  EXPECT_NEAR(proper_time(10, 0.8 * speed_of_light), 6, 1e-14);
  EXPECT_NEAR(time_dilation(6, 0.8 * speed_of_light), 10, 1e-14);
  EXPECT_NEAR(length_contraction(100, 0.6 * speed_of_light), 80, 1e-13);
}

// Velocities add to (u + v)/(1 + uv/c²); c is reached by none, and c plus anything is c.
TEST(Chapter01Relativity, VelocityAddition) {
  const double c = speed_of_light;
  EXPECT_NEAR(add_velocities(0.5 * c, 0.5 * c), 0.8 * c, 1e-7);
  EXPECT_NEAR(add_velocities(0.7 * c, c), c, 1e-7);
  const Vec3d v{0.6 * c, 0, 0};
  EXPECT_NEAR(add_velocities(v, Vec3d{0.5 * c, 0, 0}).x, add_velocities(0.6 * c, 0.5 * c), 1e-6);
  EXPECT_NEAR(length(add_velocities(v, Vec3d{0, c, 0})), c, 1e-6);        // light stays light
  EXPECT_NEAR(add_velocities(v, Vec3d{0, 0.5 * c, 0}).y, 0.4 * c, 1e-6);  // u/γ
}

// 1.9: GPS, circular orbit of 26 561.763 km against a clock at rest at 6371 km: +38.506 µs/day (±0.01), 11.54 km/day.
TEST(Chapter01Relativity, GpsClocks) {
  constexpr double mu = 3.986004418e14, r = 26561763.0, ground = 6371000.0;
  const double per_day = orbit_clock_rate(mu, r, ground) * 86400;
  EXPECT_NEAR(per_day * 1e6, 38.506, 0.01);
  EXPECT_NEAR(per_day * speed_of_light / 1000, 11.54, 0.005);
  const double v = sqrt(mu / r);
  EXPECT_NEAR(clock_rate(mu, r, v) - gravitational_clock_rate(mu, ground), orbit_clock_rate(mu, r, ground), 1e-20);
  EXPECT_NEAR(velocity_clock_rate(v), -lorentz_factor_minus_one(v), 1e-19);
}

}  // namespace
}  // namespace carom::test::chapter_01
