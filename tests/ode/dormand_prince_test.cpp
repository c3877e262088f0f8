// The adaptive integrator: accuracy against closed solutions, dense output order, events, limits.
#include "carom/ode/dormand_prince.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dormand_prince_test {
using namespace carom;
using math::Vec2d;
using ode::DormandPrince;
using ode::Motion;
using ode::Outcome;

Motion<Vec2d> kepler(double, const Motion<Vec2d>& y) {
  const double r = math::length(y.position);
  return {y.velocity, -1.0 / (r * r * r) * y.position};
}
Motion<double> oscillator(double, const Motion<double>& y) { return {y.velocity, -y.position}; }

// One turn of an ellipse with e = 0.6 ends where it began; semi-major axis 1, so the period is 2π.
TEST(DormandPrince, ClosesAKeplerEllipseToItsTolerance) {
  double previous = 1;
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    DormandPrince<Motion<Vec2d>> solver(0, {{0.4, 0}, {0, 2}},
                                        {.relative_tolerance = tolerance, .absolute_tolerance = tolerance});
    ASSERT_EQ(solver.advance(kepler, 2 * math::pi), Outcome::done);
    EXPECT_EQ(solver.t(), 2 * math::pi);
    const double error = math::length(solver.y().position - Vec2d{0.4, 0});
    EXPECT_LT(error, 500 * tolerance);
    EXPECT_LT(error, previous);
    previous = error;
  }
}

TEST(DormandPrince, CostGrowsWithTheFifthRootOfTheTolerance) {
  int steps[2];
  for (int i = 0; i < 2; ++i) {
    const double tolerance = i == 0 ? 1e-6 : 1e-11;
    DormandPrince<Motion<double>> solver(0, {1, 0}, {.relative_tolerance = tolerance, .absolute_tolerance = tolerance});
    ASSERT_EQ(solver.advance(oscillator, 100), Outcome::done);
    steps[i] = solver.accepted();
    EXPECT_LT(solver.rejected(), steps[i] / 10);
  }
  EXPECT_NEAR(double(steps[1]) / steps[0], 10, 2);
}

TEST(DormandPrince, RunsBackward) {
  DormandPrince<Motion<double>> solver(3, {std::sin(3.0), std::cos(3.0)}, {});
  ASSERT_EQ(solver.advance(oscillator, 0), Outcome::done);
  EXPECT_NEAR(solver.y().position, 0, 1e-6);
  ASSERT_EQ(solver.advance(oscillator, 3), Outcome::done);  // and turns round
  EXPECT_NEAR(solver.y().position, std::sin(3.0), 1e-6);
}

// Hairer, Nørsett & Wanner II.6: the continuous extension has order 4, so halving the step divides its error by 32
// locally (one step) against the exact solution.
TEST(DormandPrince, DenseOutputHasOrderFour) {
  const auto worst = [](double h) {
    DormandPrince<Motion<double>> solver(0, {0, 1},
                                         {.relative_tolerance = 1, .absolute_tolerance = 1, .initial_step = h});
    EXPECT_EQ(solver.step(oscillator, 10 * h), Outcome::done);
    EXPECT_NEAR(solver.t(), h, 1e-15);
    double error = 0;
    for (int i = 1; i < 20; ++i) {
      const double t = h * i / 20;
      error = std::max(error, std::abs(solver.dense(t).position - std::sin(t)));
    }
    return error;
  };
  EXPECT_NEAR(std::log2(worst(0.4) / worst(0.2)), 5, 0.4);
}

TEST(DormandPrince, DenseOutputMeetsBothEndsOfTheStep) {
  DormandPrince<Motion<double>> solver(0, {0, 1}, {});
  ASSERT_EQ(solver.advance(oscillator, 1,
                           [](const DormandPrince<Motion<double>>& s) {
                             EXPECT_NEAR(s.dense(s.t()).position, s.y().position, 1e-15);
                             EXPECT_NEAR(s.dense(s.previous_t()).position, std::sin(s.previous_t()), 1e-8);
                           }),
            Outcome::done);
}

// A ball thrown up lands at 2v/g; a parabola is integrated exactly, so only the location error counts.
TEST(DormandPrince, FindsTheLandingTime) {
  const auto flight = [](double, const Motion<double>& y) { return Motion<double>{y.velocity, -9.81}; };
  DormandPrince<Motion<double>> solver(0, {0, 30}, {});
  bool found = false;
  ASSERT_EQ(solver.advance_to_event(flight, 100, [](double, const Motion<double>& y) { return y.position; }, found,
                                    {.crossing = ode::Crossing::falling}),
            Outcome::done);
  ASSERT_TRUE(found);
  EXPECT_NEAR(solver.t(), 60 / 9.81, 1e-11);
  EXPECT_NEAR(solver.y().velocity, -30, 1e-9);
  EXPECT_LE(solver.y().position, 0);
}

TEST(DormandPrince, FindsEveryZeroOfASine) {
  DormandPrince<Motion<double>> solver(0, {0, 1}, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12});
  const auto position = [](double, const Motion<double>& y) { return y.position; };
  for (int i = 1; i <= 20; ++i) {
    bool found = false;
    ASSERT_EQ(solver.advance_to_event(oscillator, 1000, position, found), Outcome::done);
    ASSERT_TRUE(found);
    EXPECT_NEAR(solver.t(), i * math::pi, 2e-9);
  }
  bool found = true;
  const auto never = [](double, const Motion<double>& y) { return y.position - 2; };
  ASSERT_EQ(solver.advance_to_event(oscillator, 100, never, found), Outcome::done);
  EXPECT_FALSE(found);
  EXPECT_EQ(solver.t(), 100);
}

TEST(DormandPrince, DenseOutputStaysGoodAfterAnEvent) {
  DormandPrince<Motion<double>> solver(0, {0, 1}, {});
  bool found = false;
  ASSERT_EQ(solver.advance_to_event(
                oscillator, 10, [](double, const Motion<double>& y) { return y.position - 0.5; }, found),
            Outcome::done);
  ASSERT_TRUE(found);
  EXPECT_NEAR(solver.t(), math::pi / 6, 1e-8);
  for (int i = 0; i <= 4; ++i) {
    const double t = solver.previous_t() + (solver.t() - solver.previous_t()) * i / 4;
    EXPECT_NEAR(solver.dense(t).position, std::sin(t), 1e-8);
  }
}

TEST(DormandPrince, TakesSpans) {
  std::vector<double> y{0, 1};
  const auto f = [](double, std::span<const double> x, std::span<double> out) { out[0] = x[1], out[1] = -x[0]; };
  DormandPrince<std::span<double>> spans(0, std::span<double>(y), {});
  DormandPrince<Motion<double>> values(0, {0, 1}, {});
  ASSERT_EQ(spans.advance(f, 5), Outcome::done);
  ASSERT_EQ(values.advance(oscillator, 5), Outcome::done);
  EXPECT_EQ(spans.y()[0], values.y().position);
  EXPECT_EQ(spans.y()[1], values.y().velocity);
  EXPECT_EQ(y[0], 0) << "the caller's state is copied";
}

TEST(DormandPrince, SaysWhyItStopped) {
  DormandPrince<double> infinite(0, 1.0, {});  // ẏ = y² is infinite at t = 1
  const Outcome outcome = infinite.advance([](double, double y) { return y * y; }, 2);
  EXPECT_TRUE(outcome == Outcome::step_too_small || outcome == Outcome::not_finite) << ode::to_string(outcome);
  EXPECT_NEAR(infinite.t(), 1, 1e-6);

  DormandPrince<double> short_budget(0, 1.0, {.maximum_steps = 5});
  EXPECT_EQ(short_budget.advance([](double t, double) { return math::cos(100 * t); }, 100), Outcome::too_many_steps);

  DormandPrince<double> nan(0, 1.0, {});
  EXPECT_EQ(nan.advance([](double, double) { return std::nan(""); }, 1), Outcome::not_finite);
  DormandPrince<double> no_tolerance(0, 1.0, {.relative_tolerance = 0, .absolute_tolerance = 0});
  EXPECT_EQ(no_tolerance.advance([](double, double y) { return y; }, 1), Outcome::bad_argument);
  DormandPrince<double> to_infinity(0, 1.0, {});
  EXPECT_EQ(to_infinity.advance([](double, double y) { return y; }, HUGE_VAL), Outcome::bad_argument);
}

}  // namespace dormand_prince_test
