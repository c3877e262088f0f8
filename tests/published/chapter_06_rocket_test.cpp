// Chapter 6.4, variable mass: closed forms and reference integrations (shared reference "ballistics", 2.7).
#include <gtest/gtest.h>

#include <string>

#include "carom/ballistics/rocket.h"
#include "tests/ballistics/pieces.h"

namespace published_chapter_06_rocket_test {
using namespace carom;
using namespace carom::ballistics;
using ballistics::test::ideal_motor;
using math::Vec3d;

// m₀ 1000, m_f 400, v_e 2500, ṁ 10, vertical, constant g, no air.
TEST(Chapter06Rocket, TsiolkovskyInVacuum) {
  const Rocket rocket{.stages = {{.motor = ideal_motor(25000, 60, 600, 0), .dry_mass = 400}}, .diameter = 1};
  const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const auto flight = fly_rocket(rocket, vacuum, {.rail_length = 0.01}, RocketModel::point_mass,
                                 {.time = 2000, .ground = 0, .tolerance = 1e-11});
  ASSERT_TRUE(flight) << flight.error().message;
  const RocketMoment *out = flight->first(RocketEvent::burnout), *apex = flight->first(RocketEvent::apex);
  ASSERT_TRUE(out && apex);
  EXPECT_NEAR(out->velocity.y, 1702.327830, 1e-5);
  EXPECT_NEAR(out->position.y, 40718.956813, 1e-3);
  EXPECT_NEAR(apex->position.y, 188471.759, .01);
  EXPECT_NEAR(flight->masses.back(), 400, 1e-9);
  ASSERT_TRUE(flight->first(RocketEvent::landing));
}

// The same with a drag of .02 v² N.
TEST(Chapter06Rocket, WithDrag) {
  const double diameter = 1, area = math::pi / 4;
  const Rocket rocket{.stages = {{.motor = ideal_motor(25000, 60, 600, 0), .dry_mass = 400}},
                      .diameter = diameter,
                      .drag = DragCurve(.04 / area),
                      .coasting_drag = DragCurve(.04 / area)};
  const Conditions dense{.air = environment::AirColumn::uniform(1)};
  const auto flight = fly_rocket(rocket, dense, {.rail_length = 0.01}, RocketModel::point_mass,
                                 {.time = 1000, .ground = 0, .tolerance = 1e-11});
  ASSERT_TRUE(flight);
  EXPECT_NEAR(flight->first(RocketEvent::burnout)->velocity.y, 940.0384525, 1e-4);
  EXPECT_NEAR(flight->first(RocketEvent::burnout)->position.y, 30446.463265, 1e-2);
  EXPECT_NEAR(flight->first(RocketEvent::apex)->position.y, 47503.893447, .02);
  EXPECT_NEAR(flight->first(RocketEvent::apex)->time, 111.054373, 1e-4);
}

// A rocket that flew: Notre Dame Rocket Team, 23 February 2020, 4320 ft (1316.7 m) by its altimeter. Masses, sizes, the
// motor's burn (L1395: 4895 N s in 3.43 s) and C_D .44 as its team gave them to RocketPy (docs, example "NDRT 2020");
// the field lay 206 m high, the day was about 0 °C. What is not told is the weather aloft: 1 m/s of wind here.
// Published simulators are within 1.5 to 7.5 % of flown apogees: 7.5 %.
TEST(Chapter06Rocket, AFlownApogee) {
  Motor motor;
  motor.propellant_mass = 5 * math::pi * (.033 * .033 - .015 * .015) * .12 * 1519.708;  // its five grains
  motor.mass = 1.848 + motor.propellant_mass;
  motor.curve = *ThrustCurve::from_points({{0, 0}, {.05, 1487}, {3.2, 1487}, {3.433, 0}});
  EXPECT_NEAR(motor.curve.total_impulse(), 4895, .002 * 4895);
  EXPECT_NEAR(motor.exhaust_speed(), 2000, 100) << "composite propellant";
  const Rocket rocket{.stages = {{.motor = motor, .dry_mass = 18.998, .dry_centre = 1.3, .motor_centre = 3.04}},
                      .diameter = .203,
                      .length = 3.353,
                      .nose_length = .61,
                      .fins = {4, .152, .0762, .165, .165 * math::tan(math::radians(13.0)), 3.05},
                      .drag = DragCurve(.44),
                      .coasting_drag = DragCurve(.44)};
  const Conditions day{.air = environment::AirColumn({.temperature = -14}, 206),
                       .wind = environment::WindColumn(math::Vec3d{1, 0, 0}),
                       .gravity = 9.81};
  for (const RocketModel model : {RocketModel::point_mass, RocketModel::six_degrees}) {
    const auto flight = fly_rocket(rocket, day, {.rail_length = 3.353}, model, {.time = 60, .ground = 0});
    ASSERT_TRUE(flight) << flight.error().message;
    const RocketMoment* apex = flight->first(RocketEvent::apex);
    ASSERT_TRUE(apex);
    EXPECT_NEAR(apex->position.y, 1316.7, .075 * 1316.7);
    RecordProperty(model == RocketModel::point_mass ? "point_mass" : "six_degrees", std::to_string(apex->position.y));
  }
}

// Two stages without gravity and air: 2800 ln(100/30) + 3200 ln(23/5) = 8254.5040 m/s.
TEST(Chapter06Rocket, TwoStages) {
  const Rocket rocket{.stages = {{.motor = ideal_motor(2800 * 7, 10, 70, 0), .dry_mass = 7},
                                 {.motor = ideal_motor(3200 * 1.8, 10, 18, 0), .dry_mass = 5}},
                      .diameter = .1};
  const Conditions space{.air = environment::AirColumn::uniform(0), .gravity = 0};
  const auto flight = fly_rocket(rocket, space, {.rail_length = 1e-6}, RocketModel::point_mass,
                                 {.time = 30, .ground = -1, .tolerance = 1e-12});
  ASSERT_TRUE(flight);
  EXPECT_NEAR(flight->path.end().velocity.y, 8254.5040, 1e-3);
  EXPECT_EQ(flight->first(RocketEvent::separation)->stage, 1);
  EXPECT_NEAR(flight->first(RocketEvent::separation)->time, 10, 1e-9);
  EXPECT_NEAR(flight->masses.back(), 5, 1e-9);
}

}  // namespace published_chapter_06_rocket_test
