// Wings, plates and cylinders at any angle to the flow.
#include "carom/forces/attitude.h"

#include <gtest/gtest.h>

#include "carom/forces/drag_law.h"
#include "carom/math/elementary.h"

namespace attitude_test {
using namespace carom;
using namespace carom::forces;
using math::Vec3d;

constexpr double degree = math::pi / 180;

// Helmbold's slope: Jones' ½π A of slender wings and 2π of long ones are its limits; A = 6 gives 4.53 1/rad (lifting
// surface theory for a rectangular wing has 4.3; measured ones of A 6 .075 to .078 a degree).
TEST(Wing, SlopeOfLift) {
  const auto slope = [](double aspect) { return lift_and_drag({.aspect_ratio = aspect}, 0.01).lift / 0.01; };
  EXPECT_NEAR(slope(0.01) / (0.5 * math::pi * 0.01), 1, 3e-3);
  EXPECT_NEAR(slope(1000) / (2 * math::pi), 1, 3e-3);
  EXPECT_NEAR(slope(6) * degree, 0.079, 0.004);
  EXPECT_NEAR(slope(1), 1.483, 1e-3);
}

// Induced drag C_L²/(π e A); the best glide of a wing is ½ √(π e A/C_D0).
TEST(Wing, InducedDragAndBestGlide) {
  const WingLaw law{.aspect_ratio = 10, .profile_drag = 0.01};
  double best = 0;
  for (double a = 0; a < law.stall_angle; a += 1e-4) {
    const LiftAndDrag c = lift_and_drag(law, a);
    best = math::max(best, c.lift / c.drag);
  }
  EXPECT_NEAR(best, 0.5 * math::sqrt(math::pi * 0.9 * 10 / 0.01), 0.01);
}

// A plate across the flow: 1.11 + .018 A (Viterna & Janetzke); square plates measure 1.1 to 1.2 (Hoerner 3-16). All the
// way round nothing jumps, drag is never negative, and the wing is the same from both sides.
TEST(Wing, AllTheWayRound) {
  EXPECT_NEAR(lift_and_drag(flat_plate(1), 90 * degree).drag, 1.128, 1e-9);
  EXPECT_NEAR(lift_and_drag(flat_plate(1), 90 * degree).lift, 0, 1e-9);
  for (const double aspect : {0.5, 1.0, 6.0, 20.0}) {
    const WingLaw law{.aspect_ratio = aspect, .stall_angle = 0.2};
    LiftAndDrag before = lift_and_drag(law, -180 * degree);
    for (double a = -180; a <= 180; a += 0.05) {
      const LiftAndDrag c = lift_and_drag(law, a * degree), mirror = lift_and_drag(law, -a * degree);
      EXPECT_NEAR(c.lift, before.lift, 0.02) << aspect << ' ' << a;
      EXPECT_NEAR(c.drag, before.drag, 0.02) << aspect << ' ' << a;
      EXPECT_GT(c.drag, 0);
      EXPECT_NEAR(c.lift, -mirror.lift, 1e-9);
      EXPECT_NEAR(c.drag, mirror.drag, 1e-9);
      before = c;
    }
  }
  // Cambered: no lift at its angle.
  EXPECT_NEAR(lift_and_drag({.zero_lift_angle = -4 * degree}, -4 * degree).lift, 0, 1e-12);
  EXPECT_GT(lift_and_drag({.zero_lift_angle = -4 * degree}, 0).lift, 0.2);
}

// Joëssel's measured centre of pressure of plates, .195 + .305 sin α, within 6 % of the chord.
TEST(Wing, CentreOfPressure) {
  for (double a = 5; a <= 90; a += 5) {
    const double found = pressure_centre(a * degree);
    EXPECT_NEAR(found, 0.195 + 0.305 * math::sin(a * degree), 0.06);
    EXPECT_NEAR(pressure_centre((180 - a) * degree), 1 - found, 1e-12);
  }
}

TEST(Wing, ForceAndMoment) {
  const Vec3d forward{1, 0, 0}, up{0, 1, 0};
  const WingLaw law;
  // Level flight at 4° of attack: lift up, drag back, the moment lifts the nose about the middle.
  const double a = 4 * degree, v = 30;
  const Wrench3 w = lifting_surface(law, 1.2, 2, 0.5, forward, up, v * Vec3d{math::cos(a), -math::sin(a), 0});
  const LiftAndDrag c = lift_and_drag(law, a);
  const double q = 0.5 * 1.2 * 2 * v * v;
  EXPECT_NEAR(w.force.y, q * (c.lift * math::cos(a) + c.drag * math::sin(a)), 1e-9);
  EXPECT_NEAR(w.force.x, q * (c.lift * math::sin(a) - c.drag * math::cos(a)), 1e-9);
  EXPECT_NEAR(w.moment.z, w.force.y * 0.5 * (0.5 - pressure_centre(a)), 1e-9);
  // Flow along the span does nothing; the force falls with the square of the speed; without speed there is none.
  EXPECT_EQ(lifting_surface(law, 1.2, 2, 0.5, forward, up, {0, 0, 50}).force, Vec3d{});
  EXPECT_EQ(lifting_surface(law, 1.2, 2, 0.5, forward, up, {}).force, Vec3d{});
  // Turning nose up at rest of attack lowers the attack behind: it damps.
  const Wrench3 turning = lifting_surface(law, 1.2, 2, 0.5, forward, up, {v, 0, 0}, {0, 0, 2});
  EXPECT_GT(turning.force.y, 0) << "the three-quarter point moves down";
  EXPECT_FALSE(validate({.aspect_ratio = 0}).ok());
  EXPECT_FALSE(validate({.stall_angle = 2}).ok());
  EXPECT_FALSE(validate({.efficiency = 0}).ok());
  EXPECT_TRUE(validate(flat_plate(1)).ok());
}

// Across: the drag of the cylinder at its Reynolds number; along: friction and ends; between: by the parts of the
// velocity, so that the normal force goes with sin² of the angle (Hoerner 3-11).
TEST(CylinderForce, CrossFlowPrinciple) {
  const double rho = 1.225, mu = 1.7894e-5, d = 0.1, l = 3;
  const double v = 12, re = rho * v * d / mu;
  const Vec3d across = cylinder_force(rho, mu, d, l, {0, 1, 0}, {v, 0, 0});
  EXPECT_NEAR(-across.x, 0.5 * rho * v * v * d * l * cylinder_drag(re), 1e-9);
  EXPECT_EQ(across.y, 0);
  const Vec3d along = cylinder_force(rho, mu, d, l, {1, 0, 0}, {v, 0, 0});
  EXPECT_LT(-along.x, 0.1 * -across.x);
  EXPECT_GT(-along.x, 0.5 * rho * v * v * 0.25 * math::pi * d * d * 0.82);
  // Far below the crisis C_D hardly changes with the Reynolds number: sin².
  for (const double angle : {30.0, 45.0, 60.0}) {
    const double s = math::sin(angle * degree), c = math::cos(angle * degree);
    const Vec3d force = cylinder_force(rho, mu, d, l, {c, s, 0}, {v, 0, 0});
    const double normal = math::length(force - math::dot(force, Vec3d{c, s, 0}) * Vec3d{c, s, 0});
    EXPECT_NEAR(normal / -across.x, s * s, 0.02) << angle;
    EXPECT_LT(math::dot(force, Vec3d{v, 0, 0}), 0) << "it only takes";
  }
  EXPECT_EQ(cylinder_force(rho, mu, d, l, {1, 0, 0}, {}), Vec3d{});
}

}  // namespace attitude_test
