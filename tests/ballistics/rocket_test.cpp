// Rockets: wind, parachute, rail, Barrowman's own example, files. Closed forms are in tests/published.
#include "carom/ballistics/rocket.h"

#include <gtest/gtest.h>

#include "carom/math/random.h"
#include "tests/ballistics/pieces.h"

namespace ballistics_rocket_test {
using namespace carom;
using namespace carom::ballistics;
using ballistics::test::ideal_motor;
using math::Vec3d;

// Fins turn a rocket into the wind, a parachute brings it down at its terminal speed.
TEST(Rocket, WeathercocksAndComesDownByParachute) {
  Rocket rocket{
      .stages = {{.motor = ideal_motor(60, 1.5, .06, .06), .dry_mass = .4, .dry_centre = .45, .motor_centre = .85}},
      .diameter = .05,
      .length = 1,
      .fins = {.count = 4, .position = .88},
      .parachute = {.drag_area = .5, .deploy_delay = 1}};
  const Stability stability = barrowman(rocket);
  EXPECT_GT(stability.centre_of_pressure, .55) << "behind the centre of mass";
  Conditions wind{.air = environment::AirColumn::uniform(1.225), .wind = environment::WindColumn(Vec3d{6, 0, 0})};
  const auto flight = fly_rocket(rocket, wind, {.rail_length = 1.5}, RocketModel::six_degrees);
  ASSERT_TRUE(flight) << flight.error().message;
  EXPECT_LT(flight->first(RocketEvent::apex)->position.x, -2) << "into the wind";
  EXPECT_LT(flight->largest_angle, .5);
  EXPECT_GT(flight->largest_angle, .1) << "the crosswind meets it at the end of the rail";
  const auto end = flight->path.end();
  const double fall = math::sqrt(2 * .46 * 9.80665 / (1.225 * .5));
  EXPECT_NEAR(end.velocity.y, -fall, .01);
  EXPECT_NEAR(end.velocity.x, 6, .01) << "with the wind";
  ASSERT_TRUE(flight->first(RocketEvent::parachute) && flight->first(RocketEvent::landing));
  // Without wind both models fly the same way.
  wind.wind = environment::WindColumn();
  const auto six = fly_rocket(rocket, wind, {.rail_length = 1.5}, RocketModel::six_degrees);
  const auto point = fly_rocket(rocket, wind, {.rail_length = 1.5}, RocketModel::point_mass);
  EXPECT_NEAR(six->first(RocketEvent::apex)->position.y, point->first(RocketEvent::apex)->position.y, .1);
  // Fins in front: unstable.
  rocket.fins.position = .1;
  wind.wind = environment::WindColumn(Vec3d{1, 0, 0});
  const auto tumbling = fly_rocket(rocket, wind, {.rail_length = 1.5}, RocketModel::six_degrees);
  ASSERT_TRUE(tumbling) << tumbling.error().message;
  EXPECT_GT(tumbling->largest_angle, 1.5);
}

// A pad on which the thrust is too weak at first: it stands until the thrust carries it.
TEST(Rocket, StandsUntilTheThrustCarriesIt) {
  const Motor motor{
      .propellant_mass = .1, .mass = .2, .curve = ThrustCurve::from_points({{0, 0}, {2, 20}, {4, 0}}).value()};
  const Rocket rocket{.stages = {{.motor = motor, .dry_mass = .8}}};
  const auto flight = fly_rocket(rocket, {}, {}, RocketModel::point_mass, {.time = 60, .ground = 0});
  ASSERT_TRUE(flight);
  EXPECT_NEAR(flight->path.at(.9).position.y, 0, 2e-3) << "thrust equals weight after .98 s";
  EXPECT_GT(flight->first(RocketEvent::apex)->position.y, 5);
}

// Barrowman's formulas against a hand calculation: ogive 12.5 cm, body 3.3 cm, three fins 5/3.5 cm, span 4.5,
// sweep 1.5.
TEST(Rocket, Barrowman) {
  const Rocket rocket{
      .diameter = .033,
      .length = .4,
      .nose_length = .125,
      .fins = {.count = 3, .root_chord = .05, .tip_chord = .035, .span = .045, .sweep = .015, .position = .35}};
  const double line = math::sqrt(.045 * .045 + math::square(.015 + .0175 - .025));
  const double fins =
      (1 + .0165 / .0615) * 12 * math::square(.045 / .033) / (1 + math::sqrt(1 + math::square(2 * line / .085)));
  const double centre = .35 + .015 / 3 * (.05 + .07) / .085 + (.085 - .05 * .035 / .085) / 6;
  const Stability stability = barrowman(rocket);
  EXPECT_NEAR(stability.normal_slope, 2 + fins, 1e-12);
  EXPECT_NEAR(stability.centre_of_pressure, (2 * .466 * .125 + fins * centre) / (2 + fins), 1e-12);
}

constexpr const char* file = R"(; a made-up motor
X12 18 70 0-3-5 0.0125 0.022 Carom
0.05 8.0
0.2 14
1.0 11.5  ; steady
1.1 0
;
Y6 13 45 P .006 .012 Carom
0.1 6
0.5 0
)";

TEST(Motor, RaspFile) {
  const auto motors = read_rasp(file, "x.eng");
  ASSERT_TRUE(motors) << motors.error().message;
  ASSERT_EQ(motors->size(), 2u);
  const Motor& motor = motors->front();
  EXPECT_EQ(motor.name, "X12");
  EXPECT_EQ(motor.delays, (std::vector<double>{0, 3, 5}));
  EXPECT_TRUE((*motors)[1].plugged);
  EXPECT_NEAR(motor.diameter, .018, 1e-15);
  const double impulse = .5 * 8 * .05 + 11 * .15 + 12.75 * .8 + .5 * 11.5 * .1;
  EXPECT_NEAR(motor.curve.total_impulse(), impulse, 1e-12);
  EXPECT_EQ(impulse_class(impulse), "D");
  EXPECT_NEAR(motor.mass_at(0), .022, 1e-15);
  EXPECT_NEAR(motor.mass_at(9), .0095, 1e-15);
  EXPECT_NEAR(motor.curve.thrust(.6), 12.75, 1e-12);
  // The impulse is the integral of the thrust.
  double sum = 0;
  for (int i = 0; i < 11000; ++i) sum += motor.curve.thrust((i + .5) * 1e-4) * 1e-4;
  EXPECT_NEAR(sum, impulse, 1e-4);
}

// As they are found: a byte order mark, lines ended as in DOS, tabs, a maker of two words, a first point at 0, a curve
// that touches zero while the motor burns, more zeros at its end.
TEST(Motor, FilesAsTheyAreFound) {
  const auto motors = read_rasp(
      "\xEF\xBB\xBF; tested 2003\r\n;\r\nK999\t54  410 6-10-P 0.9\t1.5 Some Motor Works\r\n\t0.0 0.0\r\n 0.01 900.\r\n"
      "1.0 800\r\n1.5 0\r\n1.6 40\r\n1.7 0.0\r\n2 0\r\n;\r\n; the next\r\nL1 75 500 0 2 4 X\r\n.1 1e3\r\n3 0\r\n\r\n",
      "k.eng");
  ASSERT_TRUE(motors) << motors.error().message;
  ASSERT_EQ(motors->size(), 2u);
  const Motor& k = motors->front();
  EXPECT_EQ(k.manufacturer, "Some Motor Works");
  EXPECT_TRUE(k.plugged);
  EXPECT_EQ(k.delays, (std::vector<double>{6, 10}));
  EXPECT_NEAR(k.curve.total_impulse(), .5 * 900 * .01 + 850 * .99 + 400 * .5 + 20 * .1 + 20 * .1, 1e-9);
  EXPECT_EQ(k.curve.thrust(1.8), 0);
  EXPECT_NEAR((*motors)[1].curve.total_impulse(), 50 + 1450, 1e-9);
  EXPECT_FALSE(read_rasp("A 18 70 3 .01 .02 C\n0 0\n", "m.eng")) << "no thrust at all";
}

TEST(Motor, ErrorsNameTheLine) {
  EXPECT_EQ(read_rasp("a b c\n", "m.eng").error().message,
            "m.eng:1: found 3 words, expected the header of a motor: name, diameter, length, delays, propellant mass, "
            "mass, manufacturer");
  EXPECT_EQ(read_rasp("A 18 70 3 .01 .02 C\n0.1 5\n0.1 6\n", "m.eng").error().message,
            "m.eng:3: found the time 0.1, expected times that rise from 0");
  EXPECT_EQ(read_rasp("A 18 70 3 .01 .02 C\n0.1 5\n", "m.eng").error().message,
            "m.eng:2: found the end of the file, expected the motor's last line, with thrust 0");
  EXPECT_FALSE(read_rasp("A 18 70 3 .03 .02 C\n0.1 5\n.2 0\n", "m.eng"));
  EXPECT_FALSE(read_rasp("", "m.eng"));
  // Whatever the bytes: an answer or an error, never a crash.
  math::Random random(12);
  const std::string_view alphabet = "0123456789.-+eEP; \t\n,abc";
  for (int i = 0; i < 3000; ++i) {
    std::string text = file;
    for (int k = 0; k < 6; ++k)
      text[random.below(std::uint32_t(text.size()))] = alphabet[random.below(std::uint32_t(alphabet.size()))];
    const auto motors = read_rasp(text, "f");
    if (motors)
      for (const Motor& m : *motors) EXPECT_TRUE(math::is_finite(m.curve.total_impulse()));
  }
}

}  // namespace ballistics_rocket_test
