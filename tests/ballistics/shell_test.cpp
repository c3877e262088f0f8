// Laws of spinning shells and bad input. The firing table is in tests/published/chapter_18_shell_test.cpp.
#include "carom/ballistics/shell.h"

#include <gtest/gtest.h>

#include "tests/ballistics/pieces.h"

namespace ballistics_shell_test {
using namespace carom;
using namespace carom::ballistics;
using ballistics::test::artillery;
using math::Vec3d;

constexpr double degree = math::pi / 180;

TEST(Shell, StableSpinningTumblesWithoutSpin) {
  const Shell shell = m107();
  const double spin = muzzle_spin(shell, 337);
  EXPECT_NEAR(spin, 2 * math::pi * 337 / (20 * .155), 1e-9);
  EXPECT_GT(gyroscopic_stability(shell, spin, 1.225, 337, .99), 1.5);
  Shell smooth = shell;
  smooth.twist = 1e6;
  const auto tumbling = fly_shell(smooth, artillery(), {{}, 337 * direction(.3)}, ShellModel::six_degrees,
                                  {.time = 5, .tolerance = 1e-8}, {0, .05, .05});
  const auto flying = fly_shell(shell, artillery(), {{}, 337 * direction(.3)}, ShellModel::six_degrees,
                                {.time = 5, .tolerance = 1e-8}, {0, .05, .05});
  ASSERT_TRUE(tumbling && flying);
  double worst_tumbling = 0, worst_flying = 0;
  for (const ShellState& s : tumbling->states) worst_tumbling = math::max(worst_tumbling, s.yaw);
  for (const ShellState& s : flying->states) worst_flying = math::max(worst_flying, s.yaw);
  EXPECT_GT(worst_tumbling, 90 * degree);
  EXPECT_LT(worst_flying, 1 * degree);
}

// A left-hand twist mirrors the drift.
TEST(Shell, SpinReversalMirrorsTheDrift) {
  Shell left = m107();
  left.twist = -20;
  for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
    const auto fire = [&](const Shell& shell) {
      return fly_shell(shell, artillery(), {{}, 474 * direction(.4)}, model, {.time = 200, .ground = 0})->path.end();
    };
    const auto l = fire(left), r = fire(m107());
    EXPECT_NEAR(l.position.z, -r.position.z, 1e-6 * r.position.z);
    EXPECT_NEAR(l.position.x, r.position.x, 1e-6 * r.position.x);
  }
}

TEST(Shell, BadInputIsNamed) {
  Shell shell = m107();
  shell.aerodynamics[3].mach = .7;
  const auto flight = fly_shell(shell, {}, {{}, {300, 0, 0}}, ShellModel::six_degrees);
  ASSERT_FALSE(flight);
  EXPECT_EQ(flight.error().message, "shell: aerodynamics row 4: mach is 0.7, expected Mach numbers from 0, rising");
  EXPECT_FALSE(fly_shell(m107(), {}, {}, ShellModel::modified_point_mass));
}

}  // namespace ballistics_shell_test
