// Chapter 4, kinetics. Numbers: shared reference "mechanics", computed from the published equations; tolerance: last
// printed digit for closed forms, 1e-4 relative for integrated results, unless stated.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/forces/drag.h"
#include "carom/forces/friction.h"
#include "carom/forces/projectile.h"
#include "carom/ode/dormand_prince.h"

namespace chapter_04_test {
using namespace carom;
using forces::FlightPoint;
using forces::LinearDragFlight;
using math::Vec3d;
using ode::Motion;
using ode::Outcome;

constexpr double degree = math::pi / 180;

// 4.2: m = 1e4 kg, T = 2e4 N, C = 1e3 N·s/m, from rest, t = 10 s.
TEST(Chapter04, ShipAgainstLinearDrag) {
  const forces::Run run = forces::thrust_against_linear_drag(1e4, 2e4, 1e3, 0, 10);
  EXPECT_NEAR(run.speed, 12.642411, 5e-7);
  EXPECT_NEAR(run.distance, 73.575888, 5e-7);
  EXPECT_NEAR(forces::thrust_against_linear_drag(1e4, 2e4, 1e3, 20, 50).speed, 20, 1e-12) << "already at full speed";
}

// 4.3: x by e^{−C_d t/m}(v_x0 − C_w v_w cos γ_w/C_d) + C_w v_w cos γ_w/C_d, y with mg/C_d, against their written form.
TEST(Chapter04, LinearDragAndWindInSpace) {
  const double m = 8, cd = 2.5, cw = 1.0, vw = 12, gamma = 0.6, g = 9.8;
  const Vec3d v0{40, 30, -5};
  LinearDragFlight flight{.mass = m,
                          .coefficient = cd,
                          .wind = (cw / cd) * Vec3d{vw * std::cos(gamma), 0, vw * std::sin(gamma)},
                          .gravity = {0, -g, 0}};
  for (const double t : {0.1, 1.0, 5.0, 40.0}) {
    const double e = std::exp(-cd * t / m);
    const FlightPoint at = forces::linear_drag_flight(flight, {{}, v0}, t);
    const double wx = cw * vw * std::cos(gamma) / cd, wz = cw * vw * std::sin(gamma) / cd;
    EXPECT_NEAR(at.velocity.x, e * (v0.x - wx) + wx, 1e-12);
    EXPECT_NEAR(at.velocity.z, e * (v0.z - wz) + wz, 1e-12);
    EXPECT_NEAR(at.velocity.y, e * (v0.y + m * g / cd) - m * g / cd, 1e-12);
    EXPECT_NEAR(at.position.x, m / cd * (1 - e) * (v0.x - wx) + wx * t, 1e-10);
    EXPECT_NEAR(at.position.y, m / cd * (1 - e) * (v0.y + m * g / cd) - m * g / cd * t, 1e-10);
  }
  // And against the equation of motion itself.
  const auto f = [&](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity, flight.gravity + forces::linear_drag(cd, y.velocity - flight.wind) / m};
  };
  ode::DormandPrince<Motion<Vec3d>> solver(0, {{}, v0}, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  ASSERT_EQ(solver.advance(f, 5), Outcome::done);
  EXPECT_LT(math::distance(solver.y().position, forces::linear_drag_flight(flight, {{}, v0}, 5).position), 1e-8);
}

// 4.4: m = 100 kg, C_d = 30, V = 50 m/s, 45°, g = 9.8, no wind.
TEST(Chapter04, CannonWithDrag) {
  const LinearDragFlight flight{.mass = 100, .coefficient = 30, .gravity = {0, -9.8, 0}};
  const FlightPoint start = forces::muzzle({}, 0, 45 * degree, 0, 50);
  EXPECT_NEAR(forces::apex_time(flight, start), 2.44492, 5e-6);
  const auto landing = forces::landing_time(flight, start, 0);
  ASSERT_TRUE(landing.has_value());
  EXPECT_NEAR(*landing, 5.676896, 5e-7);
  const FlightPoint end = forces::linear_drag_flight(flight, start, *landing);
  EXPECT_NEAR(end.position.x, 96.38764, 5e-6);
  EXPECT_NEAR(end.position.y, 0, 1e-10);
}

TEST(Chapter04, CannonWithoutDragIsTheParabola) {
  const FlightPoint start = forces::muzzle({0, 3, 0}, 2, 50 * degree, 0.4, 60);
  for (const double c : {0.0, 1e-12, 1e-9}) {
    const LinearDragFlight flight{.mass = 10, .coefficient = c, .gravity = {0, -9.8, 0}};
    const FlightPoint drag = forces::linear_drag_flight(flight, start, 7),
                      vacuum = forces::parabola(start, {0, -9.8, 0}, 7);
    EXPECT_LT(math::distance(drag.position, vacuum.position), 1e-9 + c * 1e4);
    EXPECT_NEAR(forces::apex_time(flight, start), start.velocity.y / 9.8, 1e-9 + c * 10);
  }
  const LinearDragFlight flight{.mass = 10, .coefficient = 0, .gravity = {0, -9.8, 0}};
  const forces::VacuumShot shot = forces::vacuum_shot(60, 40 * degree, start.position.y, 9.8);
  EXPECT_NEAR(*forces::landing_time(flight, start, 0), shot.time, 1e-12);
  EXPECT_FALSE(forces::landing_time(flight, {{0, -5, 0}, {1, 1, 0}}, 0).has_value()) << "never gets so high";
}

// 6.1 (closed form next door): 30 m/s, 40°, h₀ = 10 m, g = 9.81: T = 4.39527 s, R = 101.0092 m.
TEST(Chapter04, VacuumShotFromAHeight) {
  const forces::VacuumShot shot = forces::vacuum_shot(30, 40 * degree, 10, 9.81);
  EXPECT_NEAR(shot.time, 4.39527, 5e-6);
  EXPECT_NEAR(shot.range, 101.0092, 5e-5);
  EXPECT_NEAR(forces::vacuum_shot(50, 45 * degree, 0, 9.81).range, 254.842, 5e-4);
}

// 4.5: rolling race: solid sphere 5/7, solid cylinder 2/3, hoop 1/2 of g sin θ.
TEST(Chapter04, RollingRace) {
  const double along = 9.81 * std::sin(20 * degree);
  EXPECT_NEAR(forces::rolling_acceleration(20 * degree, 2.0 / 5, 9.81) / along, 5.0 / 7, 1e-14);
  EXPECT_NEAR(forces::rolling_acceleration(20 * degree, 1.0 / 2, 9.81) / along, 2.0 / 3, 1e-14);
  EXPECT_NEAR(forces::rolling_acceleration(20 * degree, 1.0, 9.81) / along, 1.0 / 2, 1e-14);
}

}  // namespace chapter_04_test
