// Chapter 18.2 and 18.3, sights: closed forms and published range tables (shared reference "ballistics", 2.2, 2.8).
#include <gtest/gtest.h>

#include "carom/ballistics/sights.h"

namespace published_chapter_18_sights_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

constexpr double yard = 0.9144, foot = 0.3048, inch = 0.0254;

// v 800 m/s, sight 5 cm, zero 100 m, g 9.81 in vacuum: 1.26641 mrad (4.3536′), the other zero at 65.24 m.
TEST(Chapter18Sights, VacuumZeroIsTheClosedForm) {
  const Gun gun{.muzzle_speed = 800, .sight_height = .05};
  const Conditions vacuum{.air = environment::AirColumn::uniform(0), .gravity = 9.81};
  const auto elevation = zero_elevation(gun, vacuum, 100);
  ASSERT_TRUE(elevation) << elevation.error().message;
  EXPECT_NEAR(math::tan(elevation.value()) * 1e3, 1.26641, 2e-5);
  EXPECT_NEAR(elevation.value() / minute_of_angle, 4.3536, 1e-4);
  const auto flight = SightedFlight::fire(gun, vacuum, {.elevation = elevation.value()}, 200);
  ASSERT_TRUE(flight);
  const auto zeros = flight->zeros();
  ASSERT_EQ(zeros.size(), 2u);
  EXPECT_NEAR(zeros[0], 65.24, .01);
  EXPECT_NEAR(zeros[1], 100, 1e-6);
  EXPECT_NEAR(minute_of_angle * 100, .0290888, 1e-7);
}

TEST(Chapter18Sights, ZeroesOfTheReferenceLoads) {
  const struct {
    double coefficient, speed, sight, zero;
  } loads[] = {{.218, 2650, 1.5, .00114214}, {.151, 3100, 2.6, .00126231}};
  for (const auto& load : loads) {
    const Gun gun{.projectile = projectile_from_coefficient(DragFunction::g7, load.coefficient, Interpolation::linear),
                  .muzzle_speed = load.speed * foot,
                  .sight_height = load.sight * inch};
    const auto elevation = zero_elevation(gun, {.air = environment::AirColumn::uniform(1.225, 340.294)}, 100 * yard);
    ASSERT_TRUE(elevation);
    EXPECT_NEAR(elevation.value(), load.zero, 2e-8);
  }
}

// Published tables, 59 °F, 29.92 inHg, 78 % humidity, zero 100 yd. Gate: speed .3 %, drop .1 MOA, drift .1 in.
TEST(Chapter18Sights, PublishedRangeTables) {
  const Conditions damp{.air = environment::AirColumn(environment::AtmosphereOffset{.relative_humidity = .78})};
  EXPECT_NEAR(damp.air.at(0).density, 1.2189, 1e-4);
  const auto shoot = [&](const Gun& gun) {
    const auto elevation = zero_elevation(gun, damp, 100 * yard);
    EXPECT_TRUE(elevation);
    return SightedFlight::fire(gun, damp, {.elevation = elevation.value()}, 1100 * yard).value();
  };
  const SightedFlight light = shoot({.projectile = projectile_from_coefficient(DragFunction::g1, .365),
                                     .muzzle_speed = 2600 * foot,
                                     .sight_height = 2.5 * inch});
  const struct {
    double yards, speed, drop, time;
  } rows[] = {{300, 1920.1, -15.2, .403},
              {500, 1537.5, -68.8, .753},
              {800, 1126.2, -270.8, 1.444},
              {1000, 984.7, -534.8, 2.018}};
  for (const auto& row : rows) {
    const auto p = light.at(row.yards * yard);
    ASSERT_TRUE(p);
    EXPECT_NEAR(p->speed / foot, row.speed, .003 * row.speed);
    EXPECT_NEAR(p->height / inch, row.drop, .1 * 1.0472 * row.yards / 100 + .05) << row.yards;
    EXPECT_NEAR(p->time, row.time, .003 * row.time);
    EXPECT_NEAR(p->hold_up, math::atan(-p->height / p->distance), 1e-12);
  }
  const SightedFlight heavy = shoot({.projectile = projectile_from_coefficient(DragFunction::g1, .5),
                                     .muzzle_speed = 3006.6 * foot,
                                     .sight_height = 1.5 * inch,
                                     .shape = BulletShape{220, .308, 1.5},
                                     .twist = 12});
  EXPECT_NEAR(heavy.at(500 * yard)->speed / foot, 2118.1, 6.4);
  EXPECT_NEAR(heavy.at(500 * yard)->height / inch, -45.0, .55);
  EXPECT_NEAR(heavy.at(500 * yard)->side / inch, 1.2, .1);
  EXPECT_NEAR(heavy.at(1000 * yard)->speed / foot, 1417.8, .003 * 1417.8);
  EXPECT_NEAR(heavy.at(1000 * yard)->time, 1.464, .003 * 1.464);
  EXPECT_NEAR(heavy.at(1000 * yard)->height / inch, -293.6, 1.1);
  EXPECT_NEAR(heavy.at(1000 * yard)->side / inch, 6.2, .1);
}

}  // namespace published_chapter_18_sights_test
