// Golf balls in flight (chapters 6.3 and 19; shared reference "ballistics", section 2.10) and other balls (2.12).
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/flight.h"
#include "carom/sports/presets.h"

namespace chapter_19_flight_test {
using namespace carom;
using namespace carom::sports;

constexpr double degree = math::pi / 180, rpm = math::pi / 30, mph = 0.44704, yard = 0.9144;

Landing shot(const Ball& ball, double speed, double elevation, double spin, const Conditions& conditions = {}) {
  const auto flight = fly(ball, conditions, launch_state({.speed = speed, .elevation = elevation, .spin = spin}));
  EXPECT_TRUE(flight) << flight.error().message;
  return flight ? landing(*flight) : Landing{};
}

// Averages of the PGA tour as published by TrackMan: the set whose drivers have a club speed of 112 to 113 mph (blog),
// and that of the season of 2023 (115 mph; also Golf Monthly, December 2023). Bar: carry within 3 %, apex within 3 yd,
// landing angle within 3 deg, in both. Read in a named source: driver and 7-iron of the first set, without the landing
// angles, and the driver of the second. The other rows and all landing angles are from memory: they hold the model to
// what clubs do, and are not more than that. The second set's driver leaves with less climb (30.9 mph upward against
// 31.6) and less spin than the first's and is told to rise 3 yd higher: averages of many players and days, which no one
// ball can meet both at once but within such a bar.
TEST(Chapter19, GolfFlightIsThatOfLaunchMonitors) {
  const struct {
    const char* club;
    double ball, launch, spin, carry, apex, angle;
  } table[] = {{"driver", 167, 10.9, 2686, 275, 32, 38}, {"3-wood", 158, 9.2, 3655, 243, 30, 43},
               {"5-wood", 152, 9.4, 4350, 230, 31, 47},  {"hybrid", 146, 10.2, 4437, 225, 29, 47},
               {"3-iron", 142, 10.4, 4630, 212, 27, 46}, {"4-iron", 137, 11.0, 4836, 203, 28, 48},
               {"5-iron", 132, 12.1, 5361, 194, 31, 49}, {"6-iron", 127, 14.1, 6231, 183, 30, 50},
               {"7-iron", 120, 16.3, 7097, 172, 32, 50}, {"8-iron", 115, 18.1, 7998, 160, 31, 50},
               {"9-iron", 109, 20.4, 8647, 148, 30, 51}, {"wedge", 102, 24.2, 9304, 136, 29, 52},
               {"driver", 171, 10.4, 2545, 282, 35, 39}, {"3-wood", 162, 9.3, 3663, 249, 32, 44},
               {"5-wood", 156, 9.7, 4322, 236, 33, 48},  {"hybrid", 149, 10.2, 4587, 231, 31, 49},
               {"3-iron", 145, 10.3, 4404, 218, 29, 48}, {"4-iron", 140, 10.8, 4782, 209, 31, 49},
               {"5-iron", 135, 11.9, 5280, 199, 33, 50}, {"6-iron", 130, 14.0, 6204, 188, 32, 50},
               {"7-iron", 123, 16.1, 7124, 176, 34, 51}, {"8-iron", 118, 17.8, 8078, 164, 33, 51},
               {"9-iron", 112, 20.0, 8793, 152, 32, 52}, {"wedge", 104, 23.7, 9316, 142, 32, 52}};
  const Ball golf = *ball_preset("golf");
  double carry = 0, apex = 0, angle = 0;
  for (const auto& row : table) {
    const Landing found = shot(golf, row.ball * mph, row.launch * degree, row.spin * rpm);
    EXPECT_NEAR(found.carry / yard, row.carry, .03 * row.carry) << row.club << ' ' << row.ball;
    EXPECT_NEAR(found.apex / yard, row.apex, 3) << row.club << ' ' << row.ball;
    EXPECT_NEAR(found.angle / degree, row.angle, 3) << row.club << ' ' << row.ball;
    carry = math::max(carry, math::abs(found.carry / yard / row.carry - 1));
    apex = math::max(apex, math::abs(found.apex / yard - row.apex));
    angle = math::max(angle, math::abs(found.angle / degree - row.angle));
  }
  EXPECT_LT(carry, .027) << "what docs/sports.md says";
  EXPECT_LT(apex, 2.95);
  EXPECT_LT(angle, 2.3);
  // Lift carries farther than vacuum would (chapter 6.3).
  Ball none = golf;
  none.drag = {.fast = 0};
  none.lift = {};
  EXPECT_GT(shot(golf, 167 * mph, 10.9 * degree, 2686 * rpm).carry, shot(none, 167 * mph, 10.9 * degree, 0).carry);
}

// Bearman & Harvey's coefficients as a grid (read bilinearly, spin constant), against the reference integration:
// (70 m/s, 12 deg, 3000 rpm), (60, 15, 4000), (50, 20, 6000). Tolerance 1e-4.
TEST(Chapter19, BearmanAndHarveyGrid) {
  Ball ball{.mass = .04593, .radius = .04267 / 2};
  ball.grid.speeds = {13.7, 21.6, 29.9, 38.4, 46.9, 55.2, 63.1, 71.9, 80.2, 88.1};
  for (const double w : {2000, 3000, 4000, 5000, 6000}) ball.grid.spins.push_back(w * rpm);
  ball.grid.drag = {.3624, .2885, .2765, .2529, .2472, .2481, .2467, .2470, .2470, .2470, .4203, .3658, .3169,
                    .2822, .2655, .2578, .2560, .2550, .2538, .2538, .4288, .4003, .3490, .3084, .2852, .2710,
                    .2659, .2630, .2605, .2605, .4848, .4314, .3728, .3316, .3062, .2876, .2765, .2710, .2673,
                    .2673, .5180, .4406, .3882, .3517, .3285, .3076, .2877, .2790, .2740, .2740};
  ball.grid.lift = {.1040, .1846, .2460, .1984, .1762, .1538, .1418, .1360, .1280, .1276, .3624, .3362, .3049,
                    .2475, .2073, .1856, .1702, .1584, .1485, .1464, .4005, .3640, .3347, .2862, .2384, .2149,
                    .1977, .1807, .1690, .1582, .4130, .3894, .3496, .3119, .2695, .2418, .2246, .2031, .1895,
                    .1791, .4644, .4227, .3724, .3393, .3005, .2662, .2507, .2254, .2100, .2000};
  const struct {
    double speed, elevation, spin, carry, apex, time;
  } table[] = {{70, 12, 3000, 224.0299, 30.5873, 6.97071},
               {60, 15, 4000, 184.5238, 30.3537, 6.63107},
               {50, 20, 6000, 139.9877, 29.1325, 6.14332}};
  for (const auto& row : table) {
    const Landing found = shot(ball, row.speed, row.elevation * degree, row.spin * rpm);
    EXPECT_NEAR(found.carry, row.carry, 1e-4 * row.carry);
    EXPECT_NEAR(found.apex, row.apex, 1e-4 * row.apex);
    EXPECT_NEAR(found.time, row.time, 1e-4 * row.time);
  }
  EXPECT_NEAR(shot(ball, 70, 12 * degree, 3000 * rpm).angle / degree, 41.5235, 5e-3);
  // What it carries where launch monitors say 275, 172, 282 yd (7097 rpm lies beyond the grid: its last row).
  EXPECT_NEAR(shot(ball, 167 * mph, 10.9 * degree, 2686 * rpm).carry / yard, 261.2, 1);
  EXPECT_NEAR(shot(ball, 120 * mph, 16.3 * degree, 7097 * rpm).carry / yard, 167.0, 1);
  EXPECT_NEAR(shot(ball, 171 * mph, 10.4 * degree, 2545 * rpm).carry / yard, 266.7, 1);
}

// What other models of the golf ball carry, without spin decay, in still air of 1.225 kg/m³ (computed in the
// reference): driver 167 mph, 10.9 deg, 2686 rpm; 7-iron 120, 16.3, 7097; driver of 2023 171, 10.4, 2545. Each model as
// a grid of its own law along the speeds of the flight, at the one spin that it keeps; 1.2 %: the reference tells
// neither its viscosity nor whether Lyu's lift may turn negative.
TEST(Chapter19, CarryOfOtherModels) {
  struct Model {
    const char* name;
    double (*drag)(double re, double s);
    double (*lift)(double re, double s);
    double carry[3];
  };
  const Model models[] = {
      {"libgolf",
       [](double re, double s) { return .5 - .3 * math::clamp((re - 5e4) / 5e4, 0.0, 1.0) + .18 * s; },
       [](double, double s) { return (.268 + .052 * math::clamp((s - .35) / .15, 0.0, 1.0)) * 16 * s / (1 + 16 * s); },
       {272.8, 171.0, 279.7}},
      {"Smits and Smith",
       [](double, double s) { return .24 + .18 * s; },
       [](double, double s) { return .54 * math::pow(s, .4); },
       {271.6, 183.6, 277.3}},
      {"Lyu",
       [](double re, double) {
         return re < 1e5 ? 1.29e-10 * re * re - 2.59e-5 * re + 1.50 : 1.91e-11 * re * re - 5.40e-6 * re + .56;
       },
       [](double, double s) { return math::max(-3.25 * s * s + 1.99 * s, 0.0); },
       {313.7, 196.8, 315.4}},
  };
  const struct {
    double ball, launch, spin;
  } shots[] = {{167, 10.9, 2686}, {120, 16.3, 7097}, {171, 10.4, 2545}};
  for (const Model& model : models)
    for (int i = 0; i < 3; ++i) {
      Ball ball{.mass = .04593, .radius = .04267 / 2};
      const double spin = shots[i].spin * rpm;
      ball.grid.spins = {spin, spin + 1};
      for (double v = 8; v < 82; v += .25) ball.grid.speeds.push_back(v);
      for (int row = 0; row < 2; ++row)
        for (const double v : ball.grid.speeds) {
          const double re = reynolds(ball, {}, v), s = spin * ball.radius / v;
          ball.grid.drag.push_back(model.drag(re, s));
          ball.grid.lift.push_back(model.lift(re, s));
        }
      const Landing found = shot(ball, shots[i].ball * mph, shots[i].launch * degree, spin);
      EXPECT_NEAR(found.carry / yard, model.carry[i], .012 * model.carry[i]) << model.name << ' ' << i;
    }
}

// 6.2 and 6.3: laws of drag and lift (shared reference "mechanics").
TEST(Chapter06, DragAndLiftOfSpheres) {
  EXPECT_NEAR(schiller_naumann_drag(100), 1.092, 1e-3);
  EXPECT_NEAR(smooth_sphere_drag(1e3), .484, 1e-3);
  EXPECT_NEAR(smooth_sphere_drag(3e5), .173, 2e-3);
  EXPECT_NEAR(terminal_speed({.mass = .145, .radius = .0366, .drag = {.fast = .35}}, {}, 9.80665), 39.70, 5e-3);
  EXPECT_NEAR(terminal_speed({.mass = .04593, .radius = .021335, .drag = {.fast = .25}}, {}, 9.80665), 45.35, 5e-3);
  // v_t = 42, g = 9.81: after a fall of 5 s v = v_t tanh(g t/v_t) = 34.5905, y = (v_t²/g) ln cosh(g t/v_t).
  const double vt = 42, g = 9.81;
  Ball stone{.mass = 1, .radius = .05};
  stone.drag.fast = 2 * stone.mass * g / (1.225 * area(stone) * vt * vt);
  const auto fall = fly(stone, {.gravity = g}, {.position = {0, 1000, 0}});
  ASSERT_TRUE(fall);
  EXPECT_NEAR(-fall->at(5).velocity.y, 34.5905, 5e-5);
  EXPECT_NEAR(1000 - fall->at(5).position.y, vt * vt / g * math::log(math::cosh(g * 5 / vt)), 1e-6);
  // Baseball r 36.6 mm, 30 rev/s, 40 m/s: S .1725, ideal 1.42 N; C_L = 1/(2.32 + .4/S) = .2156: .889 N.
  const double spin = 60 * math::pi;
  EXPECT_NEAR(spin * .0366 / 40, .1725, 1e-4);
  EXPECT_NEAR(ideal_sphere_lift(1.225, 40, .0366, spin), 1.42, 5e-3);
  Ball baseball{.mass = .145, .radius = .0366, .drag = {.fast = 0}};
  baseball.lift = {.maximum = 1 / 2.32, .spin_scale = .4 / 2.32};
  EXPECT_NEAR(coefficients(baseball, {}, 40, spin).lift, .2156, 5e-5);
  const auto load = air_load(baseball, {}, {.velocity = {40, 0, 0}, .spin = {0, 0, spin}});
  EXPECT_NEAR(load.force.y, .889, 1e-3);
  EXPECT_NEAR(ideal_cylinder_lift(1.2, 10, .5, 4), 1.2 * 10 * 2 * math::pi * .25 * 4, 1e-12);
}

// Section 2.12. Soccer: the crisis lies at Re 2.2e5 to 3.0e5, against 3.5e5 to 4.0e5 of a smooth sphere, C_D .43 to
// .15-.2, C_L <= .3. Tennis: C_D .507 +- .024 without regard to spin. Arrow: C_D 1.56 at Re 1.2e4, 56.4 m/s loses about
// 8 % (over the 70 m of the target distance; band 6 to 10 %).
TEST(Chapter19, OtherBalls) {
  const auto middle_of_crisis = [](const Ball& ball) {
    const double low = coefficients(ball, {}, .5, 0).drag, high = coefficients(ball, {}, 500, 0).drag;
    double a = .5, b = 500;
    for (int i = 0; i < 60; ++i) {
      const double v = .5 * (a + b);
      (coefficients(ball, {}, v, 0).drag > .5 * (low + high) ? a : b) = v;
    }
    return reynolds(ball, {}, a);
  };
  const Ball soccer = *ball_preset("soccer"), smooth = *ball_preset("sphere"), golf = *ball_preset("golf");
  EXPECT_GT(middle_of_crisis(soccer), 2.2e5);
  EXPECT_LT(middle_of_crisis(soccer), 3.0e5);
  EXPECT_GT(middle_of_crisis(smooth), 3.5e5);
  EXPECT_LT(middle_of_crisis(smooth), 4.0e5);
  EXPECT_LT(middle_of_crisis(golf), 1e5) << "dimples bring it forward";
  EXPECT_NEAR(coefficients(soccer, {}, 5, 0).drag, .43, .01);
  EXPECT_NEAR(coefficients(soccer, {}, 40, 0).drag, .175, .025);
  for (double spin = 0; spin < 200; spin += 10) EXPECT_LE(coefficients(soccer, {}, 25, spin).lift, .3);
  const Ball tennis = *ball_preset("tennis");
  for (const double v : {15.0, 20.0, 30.0})
    for (const double spin : {0.0, 100.0, 400.0}) EXPECT_NEAR(coefficients(tennis, {}, v, spin).drag, .507, .024);
  // Wind tunnels give .6 to .7 (Mehta): no ball in the band of free flight has that, and a serve by such a coefficient
  // would lose a seventh to two sevenths more of its speed over the court (23.77 m, e^{−ρAC_D x/2m}).
  EXPECT_LT(coefficients(tennis, {}, 25, 0).drag + .024, .6);
  const auto left = [](const Ball& ball) {
    const auto flight = fly_until(ball, {.gravity = {}}, launch_state({.speed = 50}),
                                  [](double, const BallState& s) { return 23.77 - s.position.x; });
    return math::length(flight.value().end().velocity) / 50;
  };
  Ball tunnel = tennis;
  const double per_coefficient = math::log(left(tennis)) / .507;
  for (const double drag : {.6, .65, .7}) {
    tunnel.drag = {.fast = drag};
    EXPECT_NEAR(math::log(left(tunnel)) / drag / per_coefficient, 1, 1e-6) << "the same law";
    EXPECT_NEAR((1 - left(tunnel)) / (1 - left(tennis)), 1.21, .08) << drag;
  }
  const Ball arrow = *ball_preset("arrow");
  EXPECT_NEAR(coefficients(arrow, {}, 56.4, 0).drag, 1.56, 1e-12);
  const auto flight = fly_until(arrow, {}, launch_state({.speed = 56.4, .elevation = .05}),
                                [](double, const BallState& s) { return 70 - s.position.x; });
  ASSERT_TRUE(flight);
  const double loss = 1 - math::length(flight->end().velocity) / 56.4;
  EXPECT_GT(loss, .06);
  EXPECT_LT(loss, .10);
  const Ball vaned = *ball_preset("arrow_large_vanes");
  EXPECT_NEAR(coefficients(vaned, {}, 56.4, 0).drag, 2.05, 1e-12);
  const auto slower = fly_until(vaned, {}, launch_state({.speed = 56.4, .elevation = .05}),
                                [](double, const BallState& s) { return 70 - s.position.x; });
  ASSERT_TRUE(slower);
  EXPECT_NEAR((1 - math::length(slower->end().velocity) / 56.4) / loss, 2.05 / 1.56, .05);
}

// A shuttlecock is quadratic drag with v_t = 6.7 m/s: the canonical case of quadratic drag at v/v_t = 8 (2.7):
// range 2.391283647, time 3.150739194, height 1.299218898 in units of v_t²/g and v_t/g, to 1e-6.
TEST(Chapter19, ShuttlecockIsQuadraticDrag) {
  const Ball shuttle = *ball_preset("shuttlecock");
  const double vt = terminal_speed(shuttle, {}), g = 9.80665;
  EXPECT_NEAR(vt, 6.7, .01);
  const Landing found = shot(shuttle, 8 * vt, 45 * degree, 0);
  EXPECT_NEAR(found.carry / (vt * vt / g), 2.391283647, 1e-6);
  EXPECT_NEAR(found.time / (vt / g), 3.150739194, 1e-6);
  EXPECT_NEAR(found.apex / (vt * vt / g), 1.299218898, 1e-6);
  EXPECT_NEAR(found.angle / degree, 82.03117, 1e-4);
}

}  // namespace chapter_19_flight_test
