// Chapter 7, real-time simulation. Numbers: shared reference "mechanics", computed from the published equations.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/forces/drag.h"
#include "carom/ode/methods.h"

namespace chapter_07_test {
using namespace carom;
using ode::Method;
using ode::Motion;
using ode::Outcome;

// The ship of 4.2 at t = 10: speed, numerical − exact.
double ship_error(Method method, double dt) {
  double v = 0;
  const auto f = [](double, double speed) { return (2e4 - 1e3 * speed) / 1e4; };
  EXPECT_EQ(ode::integrate(method, f, 0, 10, int(std::lround(10 / dt)), v), Outcome::done);
  return v - forces::thrust_against_linear_drag(1e4, 2e4, 1e3, 0, 10).speed;
}

// Errors for dt = 1 and .25 to the last printed digit.
TEST(Chapter07, ShipErrorsOfThreeMethods) {
  EXPECT_NEAR(ship_error(Method::euler, 1), 0.3840, 5e-5);
  EXPECT_NEAR(ship_error(Method::euler, 0.25), 0.0929, 5e-5);
  EXPECT_NEAR(ship_error(Method::heun, 1), -0.01323, 5e-6);
  EXPECT_NEAR(ship_error(Method::heun, 0.25), -0.00078, 5e-6);
  EXPECT_NEAR(ship_error(Method::rk4, 1), -6.66e-6, 5e-9);
  EXPECT_NEAR(ship_error(Method::rk4, 0.25), -2.45e-8, 5e-11);
}

// Observed order between dt = 1 and .25: 1.0 ± .1, 2, 4.
TEST(Chapter07, OrdersOnTheShip) {
  const auto order = [](Method method) {
    return std::log2(std::abs(ship_error(method, 1) / ship_error(method, 0.25))) / 2;
  };
  EXPECT_NEAR(order(Method::euler), 1, 0.1);
  EXPECT_NEAR(order(Method::heun), 2, 0.1);
  EXPECT_NEAR(order(Method::midpoint), 2, 0.1);
  EXPECT_NEAR(order(Method::rk4), 4, 0.1);
}

// Oscillator ω = 2π, dt = .01, 100 periods: E/E₀.
TEST(Chapter07, OscillatorEnergyAfterAHundredPeriods) {
  const double w = 2 * math::pi;
  const auto f = [w](double, const Motion<double>& y) { return Motion<double>{y.velocity, -w * w * y.position}; };
  const auto energy = [w](const Motion<double>& y) {
    return (y.velocity * y.velocity + w * w * y.position * y.position) / (w * w);
  };
  const auto run = [&](Method method, double& least, double& most) {
    Motion<double> y{1, 0};
    least = most = 1;
    for (int i = 0; i < 10000; ++i) {
      EXPECT_EQ(ode::step(method, f, 0, y, 0.01), Outcome::done);
      least = std::min(least, energy(y));
      most = std::max(most, energy(y));
    }
    return energy(y);
  };
  double least = 0, most = 0;
  EXPECT_NEAR(run(Method::euler, least, most) / 1e17, 1.29, 0.005);
  run(Method::semi_implicit_euler, least, most);
  EXPECT_GT(least, 1 - 0.033) << "bounded within ±3.3 %";
  EXPECT_LT(most, 1 + 0.033);
  EXPECT_GT(most - least, 0.03) << "and the band is used: it swings, it does not drift";
  EXPECT_NEAR(run(Method::rk4, least, most), 0.9999915, 5e-8);
  run(Method::velocity_verlet, least, most);
  EXPECT_GT(least, 1 - 0.0011);
  EXPECT_LT(most, 1 + 0.0011);
  EXPECT_NEAR(run(Method::implicit_midpoint, least, most), 1, 1e-10);
}

}  // namespace chapter_07_test
