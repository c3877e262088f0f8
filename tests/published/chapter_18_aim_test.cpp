// Chapter 18.2, aiming: reference cases (shared reference "ballistics", 2.7).
#include <gtest/gtest.h>

#include "carom/ballistics/aim.h"

namespace published_chapter_18_aim_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

// Reference axes (east, north, up), azimuth from north; here x is north, z east.
Vec3d from_reference(double east, double north, double up) { return {north, up, east}; }

TEST(Chapter18Aim, ReferenceCases) {
  const Projectile shot = projectile_from_terminal_speed(60);
  const Conditions air{.air = environment::AirColumn::uniform(1.225)};
  const Shooter shooter{.muzzle_speed = 120};
  const AimOptions exact{.tolerance = 1e-7};
  auto aims = aim(shot, air, shooter, Target{from_reference(0, 150, 10)}, exact);
  ASSERT_TRUE(aims && *aims);
  EXPECT_NEAR(laying(aims->low->direction).elevation, .13559332, 2e-6);
  EXPECT_NEAR(aims->low->time, 1.55996912, 2e-5);
  EXPECT_NEAR(math::length(aims->low->velocity), 78.93522, 2e-3);
  EXPECT_NEAR(laying(aims->high->direction).elevation, 1.38291247, 2e-6);
  EXPECT_NEAR(aims->high->time, 15.15337305, 2e-4);
  aims = aim(shot, air, shooter, Target{from_reference(30, 200, 20), from_reference(-8, 5, 0)}, exact);
  ASSERT_TRUE(aims && *aims);
  EXPECT_NEAR(laying(aims->low->direction).azimuth, .04855582, 2e-6);
  EXPECT_NEAR(laying(aims->low->direction).elevation, .20738306, 2e-6);
  EXPECT_NEAR(aims->low->time, 2.46042357, 2e-5);
  EXPECT_NEAR(math::length(aims->low->velocity), 65.71198, 2e-3);
  EXPECT_GT(aims->high->time, 10) << "the high arc";
  const Conditions vacuum{.air = environment::AirColumn::uniform(0.0)};
  aims = aim({}, vacuum, shooter, Target{from_reference(300, 400, 50), from_reference(-10, 15, 2)}, exact);
  ASSERT_TRUE(aims && *aims);
  EXPECT_NEAR(laying(aims->low->direction).azimuth, .49461697, 1e-7);
  EXPECT_NEAR(laying(aims->low->direction).elevation, .30097693, 1e-7);
  EXPECT_NEAR(aims->low->time, 4.65819030, 1e-6);
}

}  // namespace published_chapter_18_aim_test
