// Chapter 18.1, flights of bullets and shot: reference integrations and published tables (shared reference
// "ballistics", sections 2.2, 2.4, 2.6). Tolerances: closed forms 1e-9, reference integrations 1e-4, tables as stated.
#include <gtest/gtest.h>

#include "carom/ballistics/flight.h"
#include "carom/math/elementary.h"

namespace published_chapter_18_flight_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

constexpr double degree = math::pi / 180;

// A 168 grain match bullet and M855: the reference integration of the same tables (air of 1.225 kg/m³, 340.294 m/s,
// drag read linearly), line of sight level, muzzle below it by the height of the sight.
TEST(Chapter18Flight, SmallArmsAgainstTheReferenceIntegration) {
  constexpr double yard = 0.9144, foot = 0.3048, inch = 0.0254, mph = 0.44704;
  struct Row {
    double yards, speed, drop, time, wind;
  };
  const struct {
    double coefficient, speed, sight, zero;
    std::vector<Row> rows;
  } loads[] = {{.218,
                2650,
                1.5,
                .00114214,
                {{200, 2247.55, -4.333, .24589, 3.427},
                 {300, 2060.68, -15.565, .38530, 8.038},
                 {500, 1712.22, -64.287, .70470, 24.405},
                 {800, 1244.82, -234.960, 1.32114, 73.126},
                 {1000, 1036.74, -455.581, 1.85777, 127.723}}},
               {.151,
                3100,
                2.6,
                .00126231,
                {{200, 2478.25, -1.918, .21647, 4.034},
                 {300, 2195.23, -9.526, .34510, 9.641},
                 {400, 1931.94, -24.390, .49079, 18.249},
                 {500, 1685.21, -48.632, .65704, 30.478},
                 {600, 1453.12, -85.217, .84873, 47.184},
                 {800, 1065.82, -214.545, 1.33559, 98.807}}}};
  for (const auto& load : loads) {
    const Projectile bullet = projectile_from_coefficient(DragFunction::g7, load.coefficient, Interpolation::linear);
    Conditions conditions{.air = environment::AirColumn::uniform(1.225, 340.294)};
    const FlightPoint start{{0, -load.sight * inch, 0}, load.speed * foot * direction(load.zero)};
    const auto calm = fly(bullet, conditions, start, {.time = 10, .distance = 1100 * yard});
    conditions.wind = environment::WindColumn({0, 0, 10 * mph});
    const auto windy = fly(bullet, conditions, start, {.time = 10, .distance = 1100 * yard});
    ASSERT_TRUE(calm && windy);
    for (const Row& row : load.rows) {
      const auto point = calm->first([&](const Trajectory::Point& p) { return p.position.x - row.yards * yard; });
      const auto blown = windy->first([&](const Trajectory::Point& p) { return p.position.x - row.yards * yard; });
      ASSERT_TRUE(point && blown);
      EXPECT_NEAR(math::length(point->velocity) / foot, row.speed, 1e-4 * row.speed);
      EXPECT_NEAR(point->position.y / inch, row.drop, 1e-4 * -row.drop + .002);
      EXPECT_NEAR(point->time, row.time, 1e-4 * row.time);
      EXPECT_NEAR(blown->position.z / inch, row.wind, 1e-4 * row.wind + .002);
    }
  }
}

// 65 grains, G1 .365, 2600 ft/s at 45° north, fired north: the true Coriolis force (section 2.4).
TEST(Chapter18Flight, CoriolisIsTheTrueOne) {
  constexpr double yard = 0.9144, foot = 0.3048, inch = 0.0254;
  const Projectile bullet = projectile_from_coefficient(DragFunction::g1, .365);
  Conditions conditions{.air = environment::AirColumn::uniform(1.2029, 340.294)};
  const auto range_card = [&](Vec3d rotation, double elevation) {
    conditions.rotation = rotation;
    return fly(bullet, conditions, {{0, -2.5 * inch, 0}, 2600 * foot * direction(elevation)},
               {.time = 20, .distance = 2010 * yard, .tolerance = 1e-11});
  };
  // Zero at 100 yards, without rotation.
  double elevation = .001;
  for (int i = 0; i < 20; ++i)
    elevation -= range_card({}, elevation)->at_distance(100 * yard)->position.y / (100 * yard);
  const Vec3d rotation = earth_rotation_rate(45 * degree, 0);
  const auto still = range_card({}, elevation), turning = range_card(rotation, elevation);
  const auto at = [&](const core::Result<Trajectory>& t, double yards) {
    return t->first([&](const Trajectory::Point& p) { return p.position.x - yards * yard; })->position;
  };
  EXPECT_NEAR(at(turning, 1000).z / inch, 3.134, .004);
  EXPECT_NEAR(at(turning, 2000).z / inch, 17.843, .02);
  EXPECT_NEAR(at(turning, 2000).y / at(still, 2000).y, 4574.557 / 4574.560, 1e-6);
  EXPECT_NEAR(at(still, 1000).y / inch, -527.835, .15);
  EXPECT_NEAR(at(still, 2000).y / inch, -4574.560, .9) << "4569.5 in the tables of field solvers";
}

// A body dropped from 100 m at the equator drifts ⅓ Ω g (2h/g)^{3/2} = 21.95 mm to the east; first order in Ω.
TEST(Chapter18Flight, DroppedBodyDriftsEast) {
  const Conditions vacuum{.air = environment::AirColumn::uniform(0), .rotation = earth_rotation_rate(0, math::pi / 2)};
  const auto fall = fly({}, vacuum, {{0, 100, 0}, {}}, {.time = 30, .ground = 0});
  ASSERT_TRUE(fall);
  EXPECT_NEAR(fall->end().position.x, .02195, 5e-6) << "x is east";
  // A vertical throw lands 4/3 Ω cos φ v³/g² to the west.
  const auto up = fly({}, vacuum, {{}, {0, 50, 0}}, {.time = 30, .ground = 0});
  ASSERT_TRUE(up);
  EXPECT_NEAR(up->end().position.x, -4.0 / 3 * 7.292115e-5 * 125000 / (9.80665 * 9.80665), 1e-5);
}

// The lag rule, in py-ballisticcalc's tests as well (section 2.7): a crosswind w moves a point mass by w (T − T in
// vacuum), exactly: 1e-7 m.
TEST(Chapter18Flight, CrosswindDriftIsTheLagRule) {
  const Projectile bullet = projectile_from_coefficient(DragFunction::g1, .45);
  const double w = 6;
  const Conditions conditions{
      .air = environment::AirColumn::uniform(1.225), .wind = environment::WindColumn(Vec3d{0, 0, w}), .gravity = 0};
  // Where the wind blows across, the air meets the bullet from ahead and aside; in the wind's frame the flight is
  // straight: z = w (t − x/v_x0).
  const auto flight = fly(bullet, conditions, {{}, {850, 0, 0}}, {.time = 3});
  ASSERT_TRUE(flight);
  for (const double t : {.3, 1.0, 2.5}) {
    const auto p = flight->at(t);
    EXPECT_NEAR(p.position.z, w * (t - p.position.x / 850), 1e-7);
  }
}

// The Napoleon's shot by the GS table in the standard atmosphere (section 2.6): 4.52 in, 12.3 lb, 1440 ft/s.
TEST(Chapter18Flight, PeriodArtilleryByTheSphereTable) {
  const Projectile shot = projectile_from_size(DragCurve(DragFunction::gs), 12.3 * .45359237, 4.52 * .0254);
  const struct {
    double elevation, yards;
  } table[] = {{1, 525.4}, {5, 1479.4}, {10, 2090.9}, {30, 3001.4}};
  for (const auto& row : table) {
    const auto flight =
        fly(shot, {}, {{}, 1440 * .3048 * direction(row.elevation * degree)}, {.time = 100, .ground = 0});
    ASSERT_TRUE(flight);
    EXPECT_NEAR(flight->end().position.x / .9144, row.yards, 1e-3 * row.yards);
  }
  // From a muzzle 1.15 m above the ground at 5°: 1487 yd.
  const auto flight = fly(shot, {}, {{0, 1.15, 0}, 1440 * .3048 * direction(5 * degree)}, {.time = 100, .ground = 0});
  ASSERT_TRUE(flight);
  EXPECT_NEAR(flight->end().position.x / .9144, 1487, 1e-3 * 1487);
}

}  // namespace published_chapter_18_flight_test
