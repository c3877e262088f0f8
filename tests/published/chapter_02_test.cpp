// Chapter 2, kinematics. Numbers: shared reference "mechanics", computed from the published equations; tolerance: last
// printed digit for closed forms, 1e-4 relative for integrated results, unless stated.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "carom/forces/drag.h"
#include "carom/forces/projectile.h"
#include "carom/forces/suvat.h"
#include "carom/forces/wrench.h"
#include "carom/math/elementary.h"
#include "carom/ode/methods.h"

namespace chapter_02_test {
using namespace carom;
using forces::ConstantAcceleration;
using forces::FlightPoint;
using forces::KnownMotion;
using forces::ShotOutcome;
using forces::TargetBox;
using math::Vec2d;
using math::Vec3d;

constexpr double degree = math::pi / 180;

double uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * double(engine() >> 11) * 0x1p-53;
}

// 2.1: the mean velocity over a shrinking interval tends to the velocity, with the interval.
TEST(Chapter02, MeanVelocityTendsToTheInstantaneousOne) {
  const auto s = [](double t) { return forces::quadratic_coast(100, 0.002, t).distance; };
  const double v = forces::quadratic_coast(100, 0.002, 3).speed;
  double previous = 0;
  for (const double dt : {0.1, 0.01, 0.001}) {
    const double error = std::abs((s(3 + dt) - s(3)) / dt - v);
    if (previous > 0) {
      EXPECT_NEAR(previous / error, 10, 0.2);
    }
    previous = error;
  }
}

// 2.2: all ten inverse problems; residual of the five equations < 1e-12, and the motion asked about is among the two.
TEST(Chapter02, ConstantAccelerationFromAnyThreeOfFive) {
  std::mt19937_64 engine(2);
  for (int trial = 0; trial < 5000; ++trial) {
    ConstantAcceleration m;
    m.initial_velocity = uniform(engine, -50, 50);
    m.acceleration = uniform(engine, -20, 20);
    m.time = uniform(engine, 0.1, 30);
    m.final_velocity = m.initial_velocity + m.acceleration * m.time;
    m.displacement = m.initial_velocity * m.time + 0.5 * m.acceleration * m.time * m.time;
    const double values[5] = {m.displacement, m.initial_velocity, m.final_velocity, m.acceleration, m.time};
    for (int i = 0; i < 5; ++i)
      for (int j = i + 1; j < 5; ++j) {
        KnownMotion known;
        std::optional<double>* const fields[5] = {&known.displacement, &known.initial_velocity, &known.final_velocity,
                                                  &known.acceleration, &known.time};
        for (int k = 0; k < 5; ++k)
          if (k != i && k != j) *fields[k] = values[k];
        const auto solved = forces::solve_constant_acceleration(known);
        ASSERT_TRUE(solved.ok()) << solved.error().message;
        double nearest = 1e300;
        for (int k = 0; k < solved->count; ++k) {
          EXPECT_LT(forces::residual(solved->motion[k]), 1e-12);
          const ConstantAcceleration& x = solved->motion[k];
          nearest = std::min(nearest, std::abs(x.time - m.time) + std::abs(x.initial_velocity - m.initial_velocity) +
                                          std::abs(x.final_velocity - m.final_velocity));
        }
        EXPECT_LT(nearest, 1e-5) << i << " " << j;  // near a double root the digits halve
      }
  }
}

TEST(Chapter02, ConstantAccelerationSaysWhatIsWrong) {
  const auto message = [](const KnownMotion& known) {
    const auto solved = forces::solve_constant_acceleration(known);
    return solved.ok() ? std::string("solved") : solved.error().message;
  };
  EXPECT_NE(message({.displacement = 1, .time = 1}).find("exactly three"), std::string::npos);
  EXPECT_NE(message({.displacement = 1, .initial_velocity = NAN, .time = 1}).find("initial_velocity"),
            std::string::npos);
  // Thrown up at 10 m/s it never gets 100 m high.
  EXPECT_NE(message({.displacement = 100, .initial_velocity = 10, .acceleration = -9.81}).find("no motion"),
            std::string::npos);
  EXPECT_NE(message({.initial_velocity = 3, .final_velocity = 3, .acceleration = 0}).find("undetermined"),
            std::string::npos);
  // Up and down again through 4 m: twice, the sooner first.
  const auto twice =
      forces::solve_constant_acceleration({.displacement = 4, .initial_velocity = 10, .acceleration = -9.81});
  ASSERT_TRUE(twice.ok());
  ASSERT_EQ(twice->count, 2);
  EXPECT_LT(twice->motion[0].time, twice->motion[1].time);
  EXPECT_GT(twice->motion[0].time, 0);
}

// 2.3: a = −k v², k = .002 1/m, v₁ = 100 m/s, t = 10 s.
TEST(Chapter02, CoastingAgainstQuadraticDrag) {
  const forces::Run run = forces::quadratic_coast(100, 0.002, 10);
  EXPECT_NEAR(run.speed, 33.3333, 5e-5);
  EXPECT_NEAR(run.distance, 549.306, 5e-4);
  ode::Motion<double> y{0, 100};
  const auto f = [](double, const ode::Motion<double>& m) {
    return ode::Motion<double>{m.velocity, -0.002 * m.velocity * m.velocity};
  };
  ASSERT_EQ(ode::integrate(ode::Method::rk4, f, 0, 10, 200, y), ode::Outcome::done);
  EXPECT_NEAR(y.velocity, run.speed, 1e-8 * run.speed);
  EXPECT_NEAR(y.position, run.distance, 1e-8 * run.distance);
}

// 2.4: 800 m/s over 500 m, g = 9.81.
TEST(Chapter02, FlatShotDrop) { EXPECT_NEAR(forces::flat_shot_drop(500, 800, 9.81), 1.916, 5e-4); }

// 2.5: L = Y_b = 0, 50 m/s, 45° from the vertical, g = 9.81.
TEST(Chapter02, CannonRange) {
  for (const double azimuth : {0.0, 0.7, -2.1}) {
    const FlightPoint start = forces::muzzle({}, 0, 45 * degree, azimuth, 50);
    const double time = 2 * start.velocity.y / 9.81;
    const FlightPoint end = forces::parabola(start, {0, -9.81, 0}, time);
    EXPECT_NEAR(std::hypot(end.position.x, end.position.z), 254.842, 5e-4);
    EXPECT_NEAR(std::atan2(end.position.z, end.position.x), azimuth, 1e-12);
    EXPECT_NEAR(end.position.y, 0, 1e-12);
  }
  const FlightPoint out = forces::muzzle({0, 2, 0}, 3, 30 * degree, 0, 10);
  EXPECT_NEAR(out.position.y, 2 + 3 * std::cos(30 * degree), 1e-14);
  EXPECT_NEAR(out.position.x, 1.5, 1e-14);
}

// 2.6: x = 600, y = 75, v = 100, g = 9.81: low arc 26.1023°, and the high arc too.
TEST(Chapter02, AimsLowAndHigh) {
  const auto solution = forces::aim(100, 600, 75, 9.81);
  ASSERT_TRUE(solution.has_value());
  EXPECT_NEAR(solution->low / degree, 26.1023, 5e-5);
  for (const double angle : {solution->low, solution->high}) {
    const double t = 600 / (100 * std::cos(angle));
    EXPECT_NEAR(100 * std::sin(angle) * t - 0.5 * 9.81 * t * t, 75, 1e-10);
  }
  EXPECT_GT(solution->high, solution->low);
  EXPECT_FALSE(forces::aim(60, 600, 75, 9.81).has_value()) << "out of reach";
  const double least = forces::least_speed(600, 75, 9.81);
  EXPECT_FALSE(forces::aim(least * (1 - 1e-9), 600, 75, 9.81).has_value());
  EXPECT_TRUE(forces::aim(least * (1 + 1e-9), 600, 75, 9.81).has_value());

  const Vec3d target{300, -40, -500};
  const auto space = forces::aim(120, target, 9.81);
  ASSERT_TRUE(space.has_value());
  EXPECT_LT(math::distance(forces::parabola({{}, space->low}, {0, -9.81, 0}, space->low_time).position, target), 1e-9);
  EXPECT_LT(math::distance(forces::parabola({{}, space->high}, {0, -9.81, 0}, space->high_time).position, target),
            1e-9);
  const auto above = forces::aim(50, Vec3d{0, 60, 0}, 9.81);
  ASSERT_TRUE(above.has_value());
  EXPECT_LT(
      math::distance(forces::parabola({{}, above->low}, {0, -9.81, 0}, above->low_time).position, Vec3d{0, 60, 0}),
      1e-9);
}

// 2.6: the same hit for every dt from 1 ms to 1 s, at a box thinner than one step of any of them but the shortest.
TEST(Chapter02, NoStepTunnelsThroughTheTarget) {
  const auto solution = forces::aim(100, 600, 75, 9.81);
  ASSERT_TRUE(solution.has_value());
  const FlightPoint start{{0, 0, 0}, {100 * std::cos(solution->low), 100 * std::sin(solution->low), 0}};
  const TargetBox box{{600, 70, -5}, {600.2, 80, 5}};
  const Vec3d g{0, -9.81, 0};
  const double expected = solution->low_time;
  for (const double dt : {0.001, 0.0037, 0.01, 1.0 / 60, 0.1, 0.333, 1.0}) {
    FlightPoint now = start;
    double elapsed = 0;
    forces::ShotStep step;
    for (int i = 0; i < 100000; ++i) {
      step = forces::advance_shot(now, g, dt, box, -1, elapsed, 60);
      elapsed += step.time;
      now = step.point;
      if (step.outcome != ShotOutcome::in_flight) break;
    }
    EXPECT_EQ(step.outcome, ShotOutcome::hit) << dt;
    EXPECT_NEAR(elapsed, expected, 1e-9) << dt;
    EXPECT_NEAR(now.position.y, 75, 1e-7) << dt;
  }
  // The general sweep for paths without a formula finds it too.
  const auto path = [&](double t) { return forces::parabola(start, g, t).position; };
  const auto swept = forces::first_hit(path, 101, 20, box);
  ASSERT_TRUE(swept.has_value());
  EXPECT_NEAR(*swept, expected, 1e-6);
  const TargetBox beside{{600, 70, 5}, {600.2, 80, 6}};
  EXPECT_FALSE(forces::first_hit(path, 101, 20, beside).has_value());
}

TEST(Chapter02, AShotMissesFallsOrTimesOut) {
  const TargetBox box{{600, 70, -5}, {601, 80, 5}};
  const FlightPoint start{{0, 1, 0}, {30, 20, 0}};
  const forces::ShotStep ground = forces::advance_shot(start, {0, -9.81, 0}, 100, box, 0, 0, 1000);
  EXPECT_EQ(ground.outcome, ShotOutcome::ground);
  EXPECT_NEAR(ground.point.position.y, 0, 1e-12);
  EXPECT_LT(ground.point.velocity.y, 0);
  const forces::ShotStep late = forces::advance_shot(start, {0, -9.81, 0}, 1, box, 0, 9.5, 10);
  EXPECT_EQ(late.outcome, ShotOutcome::timed_out);
  EXPECT_NEAR(late.time, 0.5, 1e-15);
  EXPECT_EQ(forces::advance_shot(start, {0, -9.81, 0}, 1, box, 0, 0, 10).outcome, ShotOutcome::in_flight);
}

// 2.7: an equal-speed burst lies on a sphere of radius v t about the freely falling centre (1e-12); the mean position
// of a random burst is the parabola within 3σ/√N.
TEST(Chapter02, BurstIsASphereAboutTheFallingCentre) {
  std::mt19937_64 engine(7);
  const Vec3d origin{1, 50, -3}, drift{4, 10, 0}, g{0, -9.81, 0};
  const double speed = 12, t = 2.5;
  const Vec3d center = forces::parabola({origin, drift}, g, t).position;
  Vec3d mean{};
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const double u = uniform(engine, 0, 1), v = uniform(engine, 0, 1);
    const auto particle = forces::burst_particle(origin, drift, speed * forces::direction_on_sphere(u, v), g, 5, t);
    EXPECT_NEAR(math::distance(particle.position, center) / (speed * t), 1, 1e-12);
    EXPECT_EQ(particle.fade, 0.5);
    mean += particle.position / double(count);
  }
  const double sigma = speed * t / std::sqrt(3.0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mean[axis], center[axis], 3 * sigma / std::sqrt(double(count)));
}

// 2.8–2.10: v = ωr, a_t = αr, a_n = ω²r; a rolling wheel touches the ground at rest and its top moves at twice v.
TEST(Chapter02, RollingWheel) {
  const double r = 0.35, v = 14, omega = -v / r;  // rolls to +x: clockwise
  EXPECT_NEAR(math::length(forces::point_velocity(Vec2d{v, 0}, omega, Vec2d{0, -r})), 0, 1e-14);
  EXPECT_NEAR(math::distance(forces::point_velocity(Vec2d{v, 0}, omega, Vec2d{0, r}), Vec2d{2 * v, 0}), 0, 1e-14);
  EXPECT_NEAR(math::length(forces::point_velocity(Vec3d{v, 0, 0}, Vec3d{0, 0, omega}, Vec3d{0, -r, 0})), 0, 1e-14);
  const Vec2d a = forces::point_acceleration(Vec2d{}, 3.0, 5.0, Vec2d{2, 0});
  EXPECT_NEAR(a.x, -50, 1e-13) << "a_n = ω² r, inward";
  EXPECT_NEAR(a.y, 6, 1e-13) << "a_t = α r";
  const Vec3d b = forces::point_acceleration(Vec3d{}, Vec3d{0, 0, 3}, Vec3d{0, 0, 5}, Vec3d{2, 0, 0});
  EXPECT_NEAR(math::distance(b, Vec3d{-50, 6, 0}), 0, 1e-13);
}

}  // namespace chapter_02_test
