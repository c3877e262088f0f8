// Convergence order, reversibility and energy of every integrator, on systems with closed solutions.
#include "carom/ode/methods.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "carom/math/elementary.h"
#include "carom/ode/dormand_prince.h"

namespace methods_test {
using namespace carom;
using math::Vec2d;
using math::Vec3d;
using ode::Method;
using ode::Motion;
using ode::Outcome;

constexpr Method all_methods[] = {
    Method::euler, Method::semi_implicit_euler, Method::midpoint,          Method::heun,
    Method::rk4,   Method::velocity_verlet,     Method::implicit_midpoint, Method::dormand_prince};

// A pendulum-like oscillator ẍ = −sin x has no simple closed form; ẍ = −x does and is not exact for any method here.
Motion<double> oscillator(double, const Motion<double>& y) { return {y.velocity, -y.position}; }

double oscillator_error(Method method, int steps) {
  Motion<double> y{1, 0.5};
  EXPECT_EQ(ode::integrate(method, oscillator, 0, 2, steps, y), Outcome::done);
  const double x = std::cos(2.0) + 0.5 * std::sin(2.0), v = -std::sin(2.0) + 0.5 * std::cos(2.0);
  return std::hypot(y.position - x, y.velocity - v);
}

TEST(Integrators, ConvergeWithTheirOrder) {
  for (const Method method : all_methods) {
    const double coarse = oscillator_error(method, 64), fine = oscillator_error(method, 128);
    EXPECT_NEAR(std::log2(coarse / fine), ode::order(method), 0.1) << ode::to_string(method);
  }
}

TEST(Integrators, ConvergeWithTheirOrderOnAnEquationThatDependsOnTime) {
  // ẏ = y cos t, y = exp(sin t).
  for (const Method method : all_methods) {
    if (ode::needs_velocities(method)) continue;
    const auto error = [&](int steps) {
      double y = 1;
      EXPECT_EQ(
          ode::integrate(method, [](double t, double x) { return x * std::cos(t); }, 0, 2, steps, y), Outcome::done);
      return std::abs(y - std::exp(std::sin(2.0)));
    };
    const int n = ode::order(method) < 4 ? 256 : 48;  // coarse enough to stand clear of rounding
    EXPECT_NEAR(std::log2(error(n) / error(2 * n)), ode::order(method), 0.2) << ode::to_string(method);
  }
}

TEST(Integrators, VerletIsOfSecondOrderWithForcesOfVelocity) {
  const auto damped = [](double, const Motion<double>& y) { return Motion<double>{y.velocity, -0.8 * y.velocity}; };
  const auto error = [&](int steps) {
    Motion<double> y{0, 1};
    EXPECT_EQ(ode::integrate(Method::velocity_verlet, damped, 0, 2, steps, y), Outcome::done);
    return std::abs(y.velocity - std::exp(-1.6));
  };
  EXPECT_NEAR(std::log2(error(64) / error(128)), 2, 0.1);
}

TEST(Integrators, SymmetricMethodsRunBackToWhereTheyStarted) {
  const auto pendulum = [](double, const Motion<double>& y) {
    return Motion<double>{y.velocity, -math::sin(y.position)};
  };
  for (const Method method : {Method::velocity_verlet, Method::implicit_midpoint}) {
    Motion<double> y{2.0, 0.3};
    ASSERT_EQ(ode::integrate(method, pendulum, 0, 50, 1000, y), Outcome::done);
    ASSERT_EQ(ode::integrate(method, pendulum, 50, 0, 1000, y), Outcome::done);
    EXPECT_NEAR(y.position, 2.0, 2e-11) << ode::to_string(method);
    EXPECT_NEAR(y.velocity, 0.3, 2e-11) << ode::to_string(method);
  }
  Motion<double> y{2.0, 0.3};  // and explicit Euler does not
  ASSERT_EQ(ode::integrate(Method::euler, pendulum, 0, 50, 1000, y), Outcome::done);
  ASSERT_EQ(ode::integrate(Method::euler, pendulum, 50, 0, 1000, y), Outcome::done);
  EXPECT_GT(std::abs(y.position - 2.0), 1e-3);
}

TEST(Integrators, SymplecticMethodsKeepTheEnergyOfAPendulumBounded) {
  const auto pendulum = [](double, const Motion<double>& y) {
    return Motion<double>{y.velocity, -math::sin(y.position)};
  };
  const auto energy = [](const Motion<double>& y) { return 0.5 * y.velocity * y.velocity - std::cos(y.position); };
  for (const Method method : {Method::semi_implicit_euler, Method::velocity_verlet, Method::implicit_midpoint}) {
    Motion<double> y{1.0, 0.0};
    const double start = energy(y);
    double first = 0, last = 0;
    for (int i = 0; i < 100000; ++i) {
      ASSERT_EQ(ode::step(method, pendulum, 0, y, 0.05), Outcome::done);
      const double error = std::abs(energy(y) - start);
      (i < 50000 ? first : last) = std::max(i < 50000 ? first : last, error);
    }
    EXPECT_LT(first, 0.03) << ode::to_string(method);
    EXPECT_NEAR(last, first, 0.02 * first) << ode::to_string(method) << ": no drift from the first to the second half";
  }
}

TEST(Integrators, ImplicitMidpointKeepsQuadraticInvariantsExactly) {
  Motion<double> y{1, 0};
  for (int i = 0; i < 10000; ++i) ASSERT_EQ(ode::step(Method::implicit_midpoint, oscillator, 0, y, 0.3), Outcome::done);
  EXPECT_NEAR(y.position * y.position + y.velocity * y.velocity, 1, 1e-10);
}

TEST(Integrators, ImplicitMidpointSolvesAStiffEquationByNewton) {
  // h·λ = −1e5: the fixed point diverges. ẏ = −λ(y − cos t): after a step of the midpoint rule from the slow solution
  // the error stays near its O(h²).
  const auto stiff = [](double t, double y) { return -1e6 * (y - math::cos(t)); };
  double y = 1;
  ASSERT_EQ(ode::integrate(Method::implicit_midpoint, stiff, 0, 10, 100, y), Outcome::done);
  EXPECT_NEAR(y, std::cos(10.0), 0.01);
  // Without Newton's memory it says so and leaves the state alone.
  std::vector<double> state{1.0}, workspace(ode::workspace_size(1, false));
  const auto span_stiff = [&](double t, std::span<const double> x, std::span<double> out) { out[0] = stiff(t, x[0]); };
  EXPECT_EQ(ode::step(Method::implicit_midpoint, span_stiff, 0, state, 0.1, workspace), Outcome::no_convergence);
  EXPECT_EQ(state[0], 1.0);
  workspace.resize(ode::workspace_size(1));
  EXPECT_EQ(ode::step(Method::implicit_midpoint, span_stiff, 0, state, 0.1, workspace), Outcome::done);
}

TEST(Integrators, SpansGiveTheBitsOfValues) {
  const auto values = [](double, const Motion<Vec2d>& y) {
    const double r = math::length(y.position);
    return Motion<Vec2d>{y.velocity, -1.0 / (r * r * r) * y.position};
  };
  const auto spans = [](double, std::span<const double> y, std::span<double> out) {
    const Vec2d p{y[0], y[1]};
    const double r = math::length(p);
    const Vec2d a = -1.0 / (r * r * r) * p;
    out[0] = y[2], out[1] = y[3], out[2] = a.x, out[3] = a.y;
  };
  for (const Method method : all_methods) {
    Motion<Vec2d> y{{1, 0}, {0, 0.8}};
    std::vector<double> s{1, 0, 0, 0.8}, workspace(ode::workspace_size(4));
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(ode::step(method, values, 0, y, 0.01), Outcome::done);
      ASSERT_EQ(ode::step(method, spans, 0, s, 0.01, workspace), Outcome::done);
    }
    EXPECT_EQ(s[0], y.position.x) << ode::to_string(method);
    EXPECT_EQ(s[1], y.position.y) << ode::to_string(method);
    EXPECT_EQ(s[2], y.velocity.x) << ode::to_string(method);
    EXPECT_EQ(s[3], y.velocity.y) << ode::to_string(method);
  }
}

struct Tank {  // a user's own state
  double level = 0, temperature = 0;
  friend Tank operator+(Tank a, Tank b) { return {a.level + b.level, a.temperature + b.temperature}; }
  friend Tank operator*(double s, Tank a) { return {s * a.level, s * a.temperature}; }
};

TEST(Integrators, TakeAnyStateWithPlusAndTimes) {
  const auto f = [](double, const Tank& y) { return Tank{-y.level, 2 * y.temperature}; };
  Tank y{1, 1};
  for (int i = 0; i < 100; ++i) y = ode::rk4(f, 0, y, 0.01);
  EXPECT_NEAR(y.level, std::exp(-1.0), 1e-9);
  EXPECT_NEAR(y.temperature, std::exp(2.0), 1e-7);
  ASSERT_EQ(ode::step(Method::implicit_midpoint, f, 0, y, 0.01), Outcome::done);
  Vec3d v{1, 2, 3};
  ASSERT_EQ(ode::integrate(Method::rk4, [](double, Vec3d x) { return -1.0 * x; }, 0, 1, 100, v), Outcome::done);
  EXPECT_NEAR(v.z, 3 * std::exp(-1.0), 1e-9);
}

TEST(Integrators, RefuseWhatTheyCannotDo) {
  const auto f = [](double, double y) { return y; };
  double y = 1;
  EXPECT_EQ(ode::step(Method::velocity_verlet, f, 0, y, 0.1), Outcome::not_partitioned);
  EXPECT_EQ(ode::step(Method::semi_implicit_euler, f, 0, y, 0.1), Outcome::not_partitioned);
  EXPECT_EQ(y, 1);
  std::vector<double> odd{1, 2, 3}, workspace(ode::workspace_size(3));
  const auto g = [](double, std::span<const double>, std::span<double> out) { out[0] = out[1] = out[2] = 0; };
  EXPECT_EQ(ode::step(Method::velocity_verlet, g, 0, odd, 0.1, workspace), Outcome::not_partitioned);
  workspace.resize(5);
  EXPECT_EQ(ode::step(Method::rk4, g, 0, odd, 0.1, workspace), Outcome::bad_argument);
  EXPECT_EQ(ode::integrate(Method::rk4, f, 0, 1, 0, y), Outcome::bad_argument);
}

TEST(Integrators, AreChosenByName) {
  for (const Method method : all_methods) EXPECT_EQ(ode::method_from_name(ode::to_string(method)), method);
  EXPECT_EQ(ode::method_from_name("rk5"), std::nullopt);
}

}  // namespace methods_test
