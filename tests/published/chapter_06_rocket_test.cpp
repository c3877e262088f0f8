// Chapter 6.4, variable mass: closed forms and reference integrations (shared reference "ballistics", 2.7).
#include <gtest/gtest.h>

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
