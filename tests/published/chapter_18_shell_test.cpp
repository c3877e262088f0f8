// Chapter 18.1, the M107 against firing table FT 155-AM-2 and the reference's own integrations (shared reference
// "ballistics", 2.5), spin formulas (2.3).
#include <gtest/gtest.h>

#include "carom/ballistics/shell.h"
#include "carom/ballistics/spin.h"
#include "carom/math/elementary.h"
#include "tests/ballistics/pieces.h"

namespace published_chapter_18_shell_test {
using namespace carom;
using namespace carom::ballistics;
using ballistics::test::artillery;
using math::Vec3d;

constexpr double degree = math::pi / 180;

struct Impact {
  double range, time, drift, speed, height;
};
Impact shoot(ShellModel model, double speed, double elevation, double tolerance = 1e-10, const Shell& shell = m107()) {
  const auto flight = fly_shell(shell, artillery(), {{}, speed * direction(elevation)}, model,
                                {.time = 200, .ground = 0, .tolerance = tolerance});
  EXPECT_TRUE(flight) << flight.error().message;
  const Trajectory::Point end = flight->path.end();
  return {end.position.x, end.time, end.position.z, math::length(end.velocity), flight->path.apex().position.y};
}

// Computed columns of the reference: the same equations and deck; gate 1e-4. Elevations in mils of 6400 to the circle.
TEST(Chapter18Shell, ModifiedPointMassAgreesWithTheReferenceIntegration) {
  const struct {
    double speed, mils;
    Impact mpm;
  } table[] = {{337, 97.2, {2010.3, 6.371, 4.05, 302.1, 50.0}},
               {337, 211.6, {4012.1, 13.512, 17.64, 280.6, 225.0}},
               {474, 258.4, {7025.6, 20.767, 51.48, 295.9, 548.8}},
               {474, 539.9, {10955.9, 39.057, 181.33, 288.6, 1935.7}}};
  for (const auto& row : table) {
    const Impact impact = shoot(ShellModel::modified_point_mass, row.speed, row.mils * 2 * math::pi / 6400);
    EXPECT_NEAR(impact.range, row.mpm.range, 1e-4 * row.mpm.range);
    EXPECT_NEAR(impact.time, row.mpm.time, 1e-4 * row.mpm.time);
    EXPECT_NEAR(impact.drift, row.mpm.drift, 1e-3 * row.mpm.drift + .005);
    EXPECT_NEAR(impact.speed, row.mpm.speed, .06);
    EXPECT_NEAR(impact.height, row.mpm.height, .06);
  }
  const Impact low = shoot(ShellModel::modified_point_mass, 684, 15 * degree);
  EXPECT_NEAR(low.range, 11363.43, 1.1);
  EXPECT_NEAR(low.drift, 114.37, .02);
  const Impact high = shoot(ShellModel::modified_point_mass, 684, 45 * degree);
  EXPECT_NEAR(high.range, 17792.65, 1.8);
  EXPECT_NEAR(high.drift, 646.63, .07);
}

TEST(Chapter18Shell, PointMassAgreesWithTheReferenceIntegration) {
  const Shell shell = m107();
  std::vector<DragPoint> drag;
  for (const ShellCoefficients& row : shell.aerodynamics) drag.push_back({row.mach, row.axial});
  const Projectile point =
      projectile_from_size(DragCurve::from_points(drag, Interpolation::linear).value(), shell.mass, shell.diameter);
  const auto range = [&](double speed, double elevation) {
    return fly(point, artillery(), {{}, speed * direction(elevation)}, {.time = 200, .ground = 0})->end();
  };
  EXPECT_NEAR(range(684, 15 * degree).position.x, 11380.42, 1.1);
  EXPECT_NEAR(range(684, 15 * degree).time, 28.4921, .003);
  EXPECT_NEAR(range(684, 45 * degree).position.x, 17875.03, 1.8);
  EXPECT_NEAR(range(684, 45 * degree).time, 67.6226, .007);
  EXPECT_NEAR(range(337, 97.2 * 2 * math::pi / 6400).position.x, 2013.1, .2);
  EXPECT_NEAR(range(337, 211.6 * 2 * math::pi / 6400).position.x, 4017.4, .4);
  EXPECT_NEAR(range(474, 258.4 * 2 * math::pi / 6400).position.x, 7036.0, .7);
  EXPECT_NEAR(range(474, 539.9 * 2 * math::pi / 6400).position.x, 10977.7, 1.1);
}

// The firing table itself: R 1.1 %, T 1.3 %, V 2 %, H 1 %, drift to the right and at most +20 % (+1 m at short range).
TEST(Chapter18Shell, FiringTable) {
  const struct {
    double speed, mils;
    Impact table;
  } rows[] = {{337, 97.2, {2000, 6.4, 3.2, 300, 50}},      {337, 152.0, {3000, 9.8, 7.8, 290, 119}},
              {337, 211.6, {4000, 13.5, 15.2, 281, 224}},  {474, 258.4, {7000, 20.8, 45.5, 298, 548}},
              {474, 378.6, {9000, 28.9, 88.2, 293, 1059}}, {474, 539.9, {11000, 39.1, 169.4, 294, 1924}}};
  for (const auto& row : rows) {
    const Impact i = shoot(ShellModel::modified_point_mass, row.speed, row.mils * 2 * math::pi / 6400);
    EXPECT_NEAR(i.range, row.table.range, .011 * row.table.range);
    EXPECT_NEAR(i.time, row.table.time, .013 * row.table.time);
    EXPECT_NEAR(i.speed, row.table.speed, .02 * row.table.speed);
    EXPECT_NEAR(i.height, row.table.height, .01 * row.table.height + .5);
    EXPECT_GT(i.drift, 0) << "to the right";
    EXPECT_LE(i.drift, 1.2 * row.table.drift + 1);
  }
}

// In six degrees of freedom as well. A published program of six degrees, on the same deck, misses the range by .48 %
// and the time by .53 % in the mean of squares, and drifts 10 % too far in the mean. Ours: .42 %, .24 %, 15.9 % in the
// mean of the six ratios, 9.9 % in all six shots' metres; the modified point mass drifts as far to .4 % (its first
// shot, 4.05 m for 3.2, is that of the reference).
TEST(Chapter18Shell, SixDegreesOnTheFiringTable) {
  const struct {
    double speed, mils, range, time, drift;
  } rows[] = {{337, 97.2, 2000, 6.4, 3.2},    {337, 152.0, 3000, 9.8, 7.8},   {337, 211.6, 4000, 13.5, 15.2},
              {474, 258.4, 7000, 20.8, 45.5}, {474, 378.6, 9000, 28.9, 88.2}, {474, 539.9, 11000, 39.1, 169.4}};
  double range = 0, time = 0, drift = 0, drifted = 0, tabulated = 0;
  for (const auto& row : rows) {
    const Impact i = shoot(ShellModel::six_degrees, row.speed, row.mils * 2 * math::pi / 6400, 1e-8);
    range += math::square(i.range / row.range - 1) / std::size(rows);
    time += math::square(i.time / row.time - 1) / std::size(rows);
    drift += (i.drift / row.drift - 1) / std::size(rows);
    drifted += i.drift;
    tabulated += row.drift;
    EXPECT_GT(i.drift, 0) << "to the right";
    EXPECT_LE(i.drift, 1.2 * row.drift + 1);
  }
  EXPECT_LT(math::sqrt(range), .0048);
  EXPECT_LT(math::sqrt(time), .0053);
  EXPECT_NEAR(drifted / tabulated - 1, .10, .005);
  EXPECT_NEAR(drift, .159, .005) << "short shots weigh as much as long ones";
}

// The nose first swings about its yaw of repose; the shell flies to the same place. A published pair of programs agrees
// within .2 to 2.6 m over 2 to 16 km; it is not said of which shots and with which moments. Ours: −.1 to 3.5 m on the
// firing table's six, and 8.2 m at most from 2 to 17.8 km, 1.4 m of it to the side. Most of that is the deck's Magnus
// moment, which tilts the yaw of repose a little up or down and which the modified point mass does not know: without it
// 3.2 m at most, of which the first swing is 1 to 2.
TEST(Chapter18Shell, SixDegreesAgreeWithTheModifiedPointMass) {
  constexpr double mil = 2 * math::pi / 6400;
  const struct {
    double speed, elevation, range, apart;
  } shots[] = {{337, 97.2 * mil, 2010.3, 3.6},  {337, 152.0 * mil, 3015, 3.6},    {337, 211.6 * mil, 4012.1, 3.6},
               {474, 258.4 * mil, 7025.6, 3.6}, {474, 378.6 * mil, 9010, 3.6},    {474, 539.9 * mil, 10955.9, 3.6},
               {474, 45 * degree, 12202, 8.5},  {684, 5 * degree, 5838, 8.5},     {684, 15 * degree, 11363.43, 8.5},
               {684, 30 * degree, 15941, 8.5},  {684, 45 * degree, 17792.65, 8.5}};
  Shell without = m107();
  for (ShellCoefficients& row : without.aerodynamics) row.magnus_moment = 0;
  for (const auto& shot : shots) {
    const Impact mpm = shoot(ShellModel::modified_point_mass, shot.speed, shot.elevation);
    const Impact six = shoot(ShellModel::six_degrees, shot.speed, shot.elevation, 1e-9);
    EXPECT_NEAR(mpm.range, shot.range, 1e-3 * shot.range) << "so far does it go";
    EXPECT_LT(math::hypot(six.range - mpm.range, six.drift - mpm.drift), shot.apart) << shot.range;
    EXPECT_NEAR(six.drift, mpm.drift, 1.5) << shot.range;
    EXPECT_NEAR(six.time, mpm.time, .03) << shot.range;
    const Impact straight = shoot(ShellModel::six_degrees, shot.speed, shot.elevation, 1e-9, without);
    EXPECT_LT(math::hypot(straight.range - mpm.range, straight.drift - mpm.drift), 3.3) << shot.range;
  }
}

// Section 2.3: worked examples of the published formulas.
TEST(Chapter18Shell, MillerLitzAndTheJump) {
  const BulletShape heavy{220, .308, 1.5};
  const double stability = miller_stability(heavy, 12, 3006.6);
  EXPECT_NEAR(stability, 1.2658, 5e-5);
  EXPECT_NEAR(spin_drift(stability, 1.464), 6.192, 1e-3);
  EXPECT_NEAR(miller_stability({168, .308, 1.215}, 11, 2650), 2.032, 5e-4);
  EXPECT_NEAR(miller_stability({62, .224, .906}, 7, 3100), 2.497, 5e-4);
  EXPECT_NEAR(miller_stability(heavy, 8, 3006.6) / miller_stability(heavy, 12, 3006.6), 2.25, 1e-12);
  EXPECT_NEAR(aerodynamic_jump(1.49, {220, .308, 1.5}), .0149 - .0024 * 4.870130 + .032, 1e-7);
}

}  // namespace published_chapter_18_shell_test
