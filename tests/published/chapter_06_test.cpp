// Chapter 6, projectiles: closed forms and reference integrations (shared references "mechanics" ch. 6 and "ballistics"
// 2.7), asked of forces and ballistics.
#include <gtest/gtest.h>

#include "carom/ballistics/rocket.h"
#include "carom/forces/drag.h"
#include "carom/forces/projectile.h"

namespace published_chapter_06_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

constexpr double g = 9.80665, degree = math::pi / 180;

TEST(Chapter06, TerminalSpeedsOfBalls) {
  const struct {
    double mass, diameter, coefficient, speed;
  } balls[] = {{.145, .0732, .4, 37.14}, {.0577, .0667, .51, 22.77}, {.43, .22, .43, 20.52}, {.43, .22, .2, 30.09}};
  for (const auto& ball : balls)
    EXPECT_NEAR(
        forces::terminal_speed(ball.mass, g, 1.225, ball.coefficient, math::pi / 4 * ball.diameter * ball.diameter),
        ball.speed, .006);
}

// Drops of water of .5 and 2 mm by Schiller and Naumann: 2.0297 and 6.9459 m/s (measured 2.06 and 6.49; big drops
// flatten). Air of 1.2 kg/m³ and 1.81e-5 Pa s, buoyancy counted.
TEST(Chapter06, RainDrops) {
  for (const auto& [diameter, speed] : {std::pair{.5e-3, 2.0297}, {2e-3, 6.9459}}) {
    double v = 1;
    for (int i = 0; i < 200; ++i) {
      const double drag = forces::sphere_drag_schiller_naumann(1.2 * v * diameter / 1.81e-5);
      const double volume = math::pi / 6 * diameter * diameter * diameter;
      v = forces::terminal_speed((1000 - 1.2) * volume, g, 1.2, drag, math::pi / 4 * diameter * diameter);
    }
    EXPECT_NEAR(v, speed, 1e-4);
  }
}

// a = −v/τ − g in units v_t = gτ: T = A + W₀(−A e^{−A}), 45°.
TEST(Chapter06, LinearDragHasLambertsTimes) {
  const struct {
    double ratio, time, range, height;
  } rows[] = {{.5, .639423027353, .167019772486, .0508201149797},
              {1, 1.18534592748, .490986359267, .172306784447},
              {2, 2.1262318352, 1.24551777231, .532839975354},
              {4, 3.73723441966, 2.7610543076, 1.48597307829}};
  for (const auto& row : rows) {
    const forces::LinearDragFlight flight{.mass = 2, .coefficient = 2, .gravity = {0, -1, 0}};
    const forces::FlightPoint start{{}, row.ratio * direction(45 * degree)};
    const auto time = forces::landing_time(flight, start, 0);
    ASSERT_TRUE(time);
    EXPECT_NEAR(*time, row.time, 1e-10);
    EXPECT_NEAR(forces::linear_drag_flight(flight, start, *time).position.x, row.range, 1e-10);
    EXPECT_NEAR(forces::linear_drag_flight(flight, start, forces::apex_time(flight, start)).position.y, row.height,
                1e-10);
  }
}

TEST(Chapter06, QuadraticDragUpAndDown) {
  const struct {
    double speed, terminal, height, up, down, impact;
  } rows[] = {{100, 50, 205.146241636, 5.64488748856, 7.36049249835, 44.72135955},
              {30, 60, 40.9577574774, 2.83673390404, 2.94419699934, 26.83281573}};
  const Conditions air{.air = environment::AirColumn::uniform(1.225)};
  for (const auto& row : rows) {
    const auto flight = fly(projectile_from_terminal_speed(row.terminal), air, {{}, {0, row.speed, 0}},
                            {.time = 60, .ground = 0, .tolerance = 1e-12});
    ASSERT_TRUE(flight) << flight.error().message;
    EXPECT_NEAR(flight->apex().position.y, row.height, 1e-6);
    EXPECT_NEAR(flight->apex().time, row.up, 1e-6);
    EXPECT_NEAR(flight->end().time, row.up + row.down, 1e-7);
    EXPECT_NEAR(flight->end().velocity.y, -row.impact, 1e-6);
  }
}

// Quadratic drag in units L = v_t²/g, T = v_t/g; 45°, landing at the height of the start.
TEST(Chapter06, QuadraticDragIsTheCanonicalCase) {
  const struct {
    double ratio, range, time, apex_x, height, impact, angle;
  } table[] = {{.5, .210305515, .673628358, .109033012, .056779297, .424945139, -49.41708},
               {1, .589011800, 1.204724756, .325101693, .182763576, .638226942, -57.27302},
               {2, 1.177778444, 1.876083493, .710899610, .450864745, .804353278, -68.09125},
               {4, 1.804926897, 2.544087987, 1.184439862, .843425342, .907132843, -76.69245},
               {8, 2.391283647, 3.150739194, 1.676760347, 1.299218898, .959469649, -82.03117}};
  const double vt = 50, g = 9.80665, length = vt * vt / g;
  const Conditions still{.air = environment::AirColumn::uniform(1.225)};
  for (const auto& row : table) {
    const auto flight = fly(projectile_from_terminal_speed(vt), still, {{}, row.ratio * vt * direction(45 * degree)},
                            {.time = 60, .ground = 0, .tolerance = 1e-12});
    ASSERT_TRUE(flight) << flight.error().message;
    const auto end = flight->end(), apex = flight->apex();
    EXPECT_NEAR(end.position.x / length, row.range, 2e-9);
    EXPECT_NEAR(end.time * g / vt, row.time, 2e-9);
    EXPECT_NEAR(apex.position.x / length, row.apex_x, 2e-9);
    EXPECT_NEAR(apex.position.y / length, row.height, 2e-9);
    EXPECT_NEAR(math::length(end.velocity) / vt, row.impact, 2e-9);
    EXPECT_NEAR(math::atan2(end.velocity.y, end.velocity.x) / degree, row.angle, 1e-5);
  }
}

// v₀/v_t = 2 to 18 digits: T = 1.87608349291696901, R = 1.17777844440920282.
TEST(Chapter06, QuadraticDragToEveryDigit) {
  const double vt = 50, length = vt * vt / g;
  const Conditions still{.air = environment::AirColumn::uniform(1.225)};
  const auto flight = fly(projectile_from_terminal_speed(vt), still, {{}, 2 * vt * direction(45 * degree)},
                          {.time = 60, .ground = 0, .tolerance = 1e-13});
  ASSERT_TRUE(flight) << flight.error().message;
  EXPECT_NEAR(flight->end().time * g / vt, 1.87608349291696901, 2e-14);
  EXPECT_NEAR(flight->end().position.x / length, 1.17777844440920282, 2e-14);
}

TEST(Chapter06, QuadraticDragAtOtherAngles) {
  const struct {
    double angle, ratio, range;
  } rows[] = {{30, 1, .557860626},
              {30, 2, 1.194845297},
              {60, 1, .494403508},
              {60, 2, .957928282},
              {45, 2, 1.17777844440920282}};
  const double vt = 50, unit = vt * vt / g;
  const Conditions air{.air = environment::AirColumn::uniform(1.225)};
  for (const auto& row : rows) {
    const auto flight =
        fly(projectile_from_terminal_speed(vt), air, {{}, row.ratio * vt * direction(row.angle * degree)},
            {.time = 60, .ground = 0, .tolerance = 1e-12});
    EXPECT_NEAR(flight->end().position.x / unit, row.range, 2e-9);
  }
}

// m₀ 1000 kg, 5 kg/s, 2500 m/s, 120 s, g 9.81: 12 500 N, Δv 2290.727 m/s, burnout at 46 109.85 m.
TEST(Chapter06, RocketAgainstConstantGravity) {
  Motor motor;
  motor.curve = ThrustCurve::constant(12500, 120);
  motor.propellant_mass = motor.mass = 600;
  EXPECT_NEAR(motor.exhaust_speed(), 2500, 1e-9);
  const Rocket rocket{.stages = {{.motor = motor, .dry_mass = 400}}, .diameter = 1};
  for (const double gravity : {0.0, 9.81}) {
    const Conditions vacuum{.air = environment::AirColumn::uniform(0), .gravity = gravity};
    const auto flight = fly_rocket(rocket, vacuum, {.rail_length = 1e-6}, RocketModel::point_mass,
                                   {.time = 130, .ground = -1, .tolerance = 1e-11});
    ASSERT_TRUE(flight) << flight.error().message;
    const RocketMoment* out = flight->first(RocketEvent::burnout);
    ASSERT_TRUE(out);
    EXPECT_NEAR(out->velocity.y, 2290.726830 - gravity * 120, 1e-3);
    if (gravity > 0) EXPECT_NEAR(out->position.y, 46109.85, .01);
  }
}

}  // namespace published_chapter_06_test
