// Chapter 6.2 and 6.3, drag and Magnus lift. Numbers: shared reference "mechanics"; tolerance: last printed digit.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/forces/drag.h"
#include "carom/forces/drag_law.h"
#include "carom/math/elementary.h"
#include "carom/ode/dormand_prince.h"

namespace chapter_06_drag_test {
using namespace carom;
using math::Vec3d;
using ode::DormandPrince;
using ode::Motion;
using ode::Outcome;

// 6.2: C_d of the sphere through the drag crisis, by the one law that bodies use.
TEST(Chapter06, SphereThroughTheDragCrisis) {
  EXPECT_NEAR(forces::sphere_drag(1e3, 0), 0.484, 5e-4);
  EXPECT_NEAR(forces::sphere_drag(3e5, 0), 0.173, 5e-4);
  EXPECT_NEAR(forces::sphere_drag_schiller_naumann(100), 1.092, 5e-4);
  // Subcritical .44–.5; beyond 3e5 measured spheres have .1 to .2, Morrison's curve goes down to .09.
  EXPECT_GT(forces::sphere_drag(5e4, 0), 0.4);
  double least = 1;
  for (double re = 1e5; re < 1e6; re *= 1.02) least = std::min(least, forces::sphere_drag(re, 0));
  EXPECT_GT(least, 0.09);
  EXPECT_LT(least, 0.2);
}

// 6.2: v_t of a skydiver, 80 kg and C_dA .7 m², 42.78 m/s; the fall v = v_t tanh(g t/v_t), y = (v_t²/g) ln cosh(g
// t/v_t) is what an integration with the law gives.
TEST(Chapter06, TerminalSpeed) {
  const double g = 9.80665, vt = forces::terminal_speed(80, g, 1.225, 1, 0.7);
  EXPECT_NEAR(vt, 42.78, 0.011);
  forces::DragLaw law;
  law.kind = forces::DragLaw::Kind::constant;
  law.coefficient = 1;
  const auto f = [&](double, const Motion<Vec3d>& y) {
    const double c = forces::drag_coefficient(law, 1, 0);
    return Motion<Vec3d>{y.velocity, Vec3d{0, -g, 0} + forces::quadratic_drag(1.225, c, 0.7, y.velocity) / 80};
  };
  DormandPrince<Motion<Vec3d>> solver(0, {}, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-9});
  ASSERT_EQ(solver.advance(f, 12), Outcome::done);
  EXPECT_NEAR(-solver.y().velocity.y, forces::quadratic_fall(vt, g, 12).speed, 1e-7);
  EXPECT_NEAR(-solver.y().position.y, forces::quadratic_fall(vt, g, 12).distance, 1e-6);
}

// 6.3: baseball r = 36.6 mm, 30 rev/s, 40 m/s: S = .1725, ideal 1.42 N, C_L = 1/(2.32 + .4/S) = .2156 → .889 N.
TEST(Chapter06, MagnusOfABaseball) {
  const double r = 0.0366, omega = 60 * math::pi, v = 40, rho = 1.225;
  const double s = r * omega / v;
  EXPECT_NEAR(s, 0.1725, 5e-5);
  EXPECT_NEAR(forces::ideal_sphere_lift(rho, v, r, omega), 1.42, 5e-3);
  EXPECT_NEAR(forces::lift_coefficient(forces::rough_ball_lift, s), 0.2156, 5e-5);
  const Vec3d f = forces::magnus_force(forces::rough_ball_lift, rho, r, {0, 0, omega}, {v, 0, 0});
  EXPECT_NEAR(f.y, 0.889, 5e-4);
  EXPECT_NEAR(forces::ideal_sphere_lift(rho, v, r, omega) / f.y, 1.6, 0.01) << "ideal flow has 1.6 times too much";
}

// 6.3: Kutta and Joukowski: ρ V Γ with Γ = 2π r² ω, per metre.
TEST(Chapter06, LiftOfASpinningCylinder) {
  EXPECT_NEAR(forces::kutta_joukowski_lift(1.225, 10, 0.5, 20), 1.225 * 10 * 2 * math::pi * 0.25 * 20, 1e-12);
}

}  // namespace chapter_06_drag_test
