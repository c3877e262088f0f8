// Laws of point-mass flight and bad input. Published numbers are in tests/published.
#include "carom/ballistics/flight.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"

namespace ballistics_flight_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

TEST(Flight, VacuumIsReversibleAndScalesWithTheCoefficient) {
  const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const auto there = fly({}, vacuum, {{}, {300, 200, 10}}, {.time = 20});
  ASSERT_TRUE(there);
  const auto end = there->end();
  const auto back = fly({}, vacuum, {end.position, -end.velocity}, {.time = 20});
  ASSERT_TRUE(back);
  EXPECT_LT(math::length(back->end().position), 1e-8);
  // Without gravity x at a given speed is proportional to the coefficient.
  const Conditions weightless{.air = environment::AirColumn::uniform(1.225), .gravity = 0};
  const auto slow = [&](double coefficient) {
    const auto f =
        fly(projectile_from_coefficient(DragFunction::g7, coefficient), weightless, {{}, {800, 0, 0}}, {.time = 9});
    return f->first([](const Trajectory::Point& p) { return p.velocity.x - 400; })->position.x;
  };
  EXPECT_NEAR(slow(.5) / slow(.25), 2, 5e-6);
}

TEST(Flight, BadInputIsNamed) {
  EXPECT_FALSE(fly({}, {}, {{0, __builtin_nan(""), 0}, {}}));
  EXPECT_FALSE(fly({.area_per_mass = -1}, {}, {}));
  EXPECT_FALSE(fly({}, {}, {}, {.time = -1}));
  const DragPoint unsorted[] = {{0, .2}, {1, .3}, {1, .4}};
  const auto curve = DragCurve::from_points(unsorted);
  ASSERT_FALSE(curve);
  EXPECT_EQ(curve.error().message, "node 3 of a drag curve: Mach number is 1, expected more than the 1 before");
  const auto table = read_drag_table("mach cd\n0 .2\n.5, x\n", "my.drg");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().message, "my.drg:3: found \"x\", expected a Mach number and a drag coefficient");
  const auto good = read_drag_table("# radar\nM, C_D\n0.0, 0.20\n1.0;0.5 # peak\n\n2\t0.3", "my.drg");
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_DOUBLE_EQ(good.value()(1), .5);
  EXPECT_DOUBLE_EQ(good.value()(7), .3);
  // The same as a maker's file has it.
  const auto radar =
      read_drag_table("CFM, a bullet of 19.44 g, 0.01944, 0.00858\r\n0.20\t0.0\r\n0.5\t1.0\r\n0.3\t2.0\r\n", "a.drg");
  ASSERT_TRUE(radar) << radar.error().message;
  for (const double mach : {0.0, .7, 1.0, 1.6, 3.0}) EXPECT_EQ(radar.value()(mach), good.value()(mach)) << mach;
}

// A maker's .308 with one coefficient above Mach 1.8, another down to 1.2, a third below: each band flies as a bullet
// of that coefficient alone does, and what is slower than all is as the first.
TEST(DragCurve, SeveralBallisticCoefficients) {
  const BallisticCoefficientBand bands[] = {{0, .405}, {1.2, .424}, {1.8, .462}};
  const DragCurve plain(DragFunction::g1);
  const auto banded = banded_drag(drag_table(DragFunction::g1), bands, .462);
  ASSERT_TRUE(banded) << banded.error().message;
  for (const double mach : {.3, .9, 1.0}) EXPECT_NEAR((*banded)(mach), plain(mach) * .462 / .405, 2e-3 * plain(mach));
  for (const double mach : {1.3, 1.5, 1.7}) EXPECT_NEAR((*banded)(mach), plain(mach) * .462 / .424, 2e-3 * plain(mach));
  for (const double mach : {1.9, 2.4, 4.0}) EXPECT_NEAR((*banded)(mach), plain(mach), 2e-3 * plain(mach));
  // While it is faster than 1.8 (612 m/s) it loses speed as with the highest coefficient, later faster than that.
  const forces::FlightPoint muzzle{{0, 0, 0}, {820, 0, 0}};
  const Projectile best = projectile_from_coefficient(DragFunction::g1, .462);
  Projectile several = best;
  several.drag = *banded;
  const auto speed = [&](const Projectile& p, double distance) {
    const auto flight = fly(p, {}, muzzle, {.time = 5});
    return math::length(flight->at_distance(distance)->velocity);
  };
  EXPECT_NEAR(speed(several, 200), speed(best, 200), .1);
  EXPECT_LT(speed(several, 900), speed(best, 900) - 5);
  const BallisticCoefficientBand falling[] = {{1.2, .4}, {.8, .42}}, naught[] = {{0, 0}};
  EXPECT_EQ(banded_drag(drag_table(DragFunction::g1), falling, 1).error().message,
            "band 2: Mach number is 0.8, expected more than the 1.2 before");
  EXPECT_EQ(banded_drag(drag_table(DragFunction::g1), naught, 1).error().message,
            "band 1: ballistic coefficient is 0, expected a finite number > 0");
  EXPECT_FALSE(banded_drag(drag_table(DragFunction::g1), {}, 1));
}

TEST(DragCurve, StandardTablesHaveTheirNodes) {
  const std::size_t nodes[] = {79, 85, 76, 79, 84, 78, 81, 81, 87};
  for (std::size_t i = 0; i < drag_function_names.size(); ++i) {
    const auto function = drag_function_from_name(drag_function_names[i]);
    ASSERT_TRUE(function);
    EXPECT_EQ(drag_table(*function).size(), nodes[i]) << drag_function_names[i];
    const DragCurve curve(*function);
    for (const DragPoint& p : drag_table(*function)) EXPECT_NEAR(curve(p.mach), p.coefficient, 1e-15);
    for (double mach = 0; mach < 6; mach += .0137) EXPECT_GT(curve(mach), .1);
  }
  EXPECT_NEAR(DragCurve(DragFunction::g7, Interpolation::linear)(1.0125), .5 * (.3803 + .4015), 1e-12);
  // Smooth: between its nodes' values, with one slope on both sides of each.
  const DragCurve smooth(DragFunction::g7);
  const auto nodes_of = smooth.points();
  for (std::size_t i = 1; i + 1 < nodes_of.size(); ++i) {
    const double m = nodes_of[i].mach, e = 1e-6;
    EXPECT_NEAR((smooth(m + e) - smooth(m)) / e, (smooth(m) - smooth(m - e)) / e, 2e-3) << m;
    const double middle = smooth(m + .3 * (nodes_of[i + 1].mach - m));
    EXPECT_GE(middle, math::min(nodes_of[i].coefficient, nodes_of[i + 1].coefficient) - 1e-15);
    EXPECT_LE(middle, math::max(nodes_of[i].coefficient, nodes_of[i + 1].coefficient) + 1e-15);
  }
}

}  // namespace ballistics_flight_test
