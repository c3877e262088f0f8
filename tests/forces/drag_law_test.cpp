// Drag by the flow, lift by spin, added mass, friction pairs.
#include "carom/forces/drag_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carom/forces/added_mass.h"
#include "carom/forces/drag.h"
#include "carom/forces/friction_table.h"

namespace drag_law_test {
using namespace carom;
using forces::CoefficientTable;
using forces::DragLaw;
using math::Vec2d;
using math::Vec3d;

// F. A. Morrison's curve through the crisis; from M .4 on the 9/16 in sphere of the drag function GS.
TEST(DragLaw, Sphere) {
  for (const double re : {0.1, 1.0, 100.0, 1e3, 1e5, 3e5, 9e5})
    EXPECT_EQ(forces::sphere_drag(re, 0.1), forces::sphere_drag_morrison(re));
  EXPECT_EQ(forces::sphere_drag(1e8, 0), forces::sphere_drag_morrison(1e6));
  EXPECT_NEAR(forces::sphere_drag(1e5, 1), 0.8140, 1e-12);
  EXPECT_NEAR(forces::sphere_drag(1e6, 1), 0.8140, 1e-12) << "no drag crisis at the speed of sound";
  EXPECT_NEAR(forces::sphere_drag(1e5, 2), 1.0010, 1e-12);
  EXPECT_NEAR(forces::sphere_drag(1e5, 9), 0.9280, 1e-12);
  for (double m = 0.3; m < 1.2; m += 0.01)
    EXPECT_LT(std::abs(forces::sphere_drag(4e5, m + 0.01) - forces::sphere_drag(4e5, m)), 0.04) << "no jumps";
}

// The standard curve of the cylinder (Schlichting, fig. 1.4, after Wieselsberger): 10 % of
// 10, 2.8, 1.45, 1.0, 1.1, 1.2; Schewe 1983 beyond the crisis.
TEST(DragLaw, Cylinder) {
  const struct {
    double re, c, tolerance;
  } rows[] = {{1, 10, 0.1},    {10, 2.8, 0.1},  {100, 1.45, 0.1}, {1e3, 1.0, 0.1},
              {1e4, 1.1, 0.1}, {1e5, 1.2, 0.1}, {5e5, 0.23, 0.3}, {7e6, 0.52, 0.1}};
  for (const auto& row : rows) EXPECT_NEAR(forces::cylinder_drag(row.re) / row.c, 1, row.tolerance) << row.re;
  EXPECT_NEAR(forces::cylinder_drag(2e5 - 1), forces::cylinder_drag(2e5 + 1), 1e-3) << "joined";
  EXPECT_TRUE(std::isfinite(forces::cylinder_drag(0)));
}

// Oseen: C_d Re of a disc broadside in creeping flow is 64/π; 1.17 in fast flow (Hoerner). Blasius' plate.
TEST(DragLaw, DiscAndPlate) {
  EXPECT_NEAR(forces::disc_drag(1e-4) * 1e-4, 64 / math::pi, 0.01);
  EXPECT_EQ(forces::disc_drag(1e5), 1.17);
  for (double re = 1; re < 1e4; re *= 1.05)
    EXPECT_NEAR(forces::disc_drag(re * 1.05) / forces::disc_drag(re), 1, 0.06) << re;
  EXPECT_NEAR(forces::plate_friction(1e5), 1.328 / std::sqrt(1e5), 1e-15);
  EXPECT_NEAR(forces::plate_friction(1e7) / 2, 0.0030 - 1700 / 1e7, 3e-5) << "Prandtl–Schlichting .00300 at 1e7";
  EXPECT_GT(forces::plate_friction(6e6), forces::plate_friction(6e8));
}

TEST(DragLaw, Tables) {
  DragLaw law;
  law.kind = DragLaw::Kind::by_mach;
  law.table = CoefficientTable({{0, 0.2}, {0.8, 0.3}, {1.2, 0.7}});
  EXPECT_NEAR(forces::drag_coefficient(law, 1, 0.4), 0.25, 1e-15);
  EXPECT_NEAR(forces::drag_coefficient(law, 1, 1.0), 0.5, 1e-15);
  EXPECT_EQ(forces::drag_coefficient(law, 1, 3), 0.7);
  EXPECT_EQ(forces::drag_coefficient(law, 1, -1), 0.2);
  law.kind = DragLaw::Kind::by_reynolds;
  law.table = CoefficientTable({{1, 10}, {100, 2}}, true);
  EXPECT_NEAR(forces::drag_coefficient(law, 10, 0), 6, 1e-14) << "half way of the logarithm";
  EXPECT_TRUE(forces::validate(law.table).ok());
  law.table = CoefficientTable({{0, 10}, {100, 2}}, true);
  EXPECT_NE(forces::validate(law.table).error().message.find("logarithm"), std::string::npos);
  law.table = CoefficientTable({{0, 10}, {-1, 2}}, true);
  EXPECT_FALSE(forces::validate(law.table).ok());
  std::vector<forces::CoefficientPoint> many;
  for (int i = 0; i < 1025; ++i) many.push_back({0.01 * i, 1.0 / (1 + i)});
  EXPECT_EQ(forces::validate(CoefficientTable(many)).error().message, "table: found 1025 points, expected 1 … 1024");
  many.pop_back();
  const CoefficientTable fine(many);
  EXPECT_TRUE(forces::validate(fine).ok());
  for (int i = 0; i < 1023; ++i) {
    EXPECT_EQ(fine.at(0.01 * i), 1.0 / (1 + i));
    EXPECT_NEAR(fine.at(0.01 * (i + 0.5)), 0.5 / (1 + i) + 0.5 / (2 + i), 1e-12);
  }
  law.table = CoefficientTable({{0, std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_FALSE(forces::validate(law.table).ok());
  DragLaw flat;
  flat.kind = DragLaw::Kind::constant;
  flat.coefficient = 0.3;
  EXPECT_EQ(forces::drag_coefficient(flat, 1e9, 9), 0.3);
}

// Units do not matter to a law of pure numbers: the force of a scaled flow with the same Re and M is scaled.
TEST(DragLaw, ScalesWithTheFlow) {
  const double re = 4e4;
  const auto force = [&](double scale) {
    const double d = 0.1 * scale, v = 5 / scale, rho = re * 1.8e-5 / (v * d);
    return 0.5 * rho * v * v * d * d * forces::cylinder_drag(forces::reynolds_number(rho, v, d, 1.8e-5));
  };
  EXPECT_NEAR(force(1), force(3), 1e-9 * force(1));
}

TEST(MagnusForce, LiesAcrossSpinAndWay) {
  const Vec3d spin{0, 0, 100}, v{30, 0, 0};
  const Vec3d f = forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, spin, v);
  EXPECT_EQ(f.x, 0);
  EXPECT_GT(f.y, 0) << "backspin lifts";
  EXPECT_LT(math::distance(forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, -spin, v), -f), 1e-15);
  EXPECT_EQ(forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, {50, 0, 0}, v), Vec3d{}) << "a rifle bullet";
  EXPECT_EQ(forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, {}, v), Vec3d{});
  EXPECT_EQ(forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, spin, {}), Vec3d{});
  EXPECT_NEAR(forces::magnus_force(forces::rough_ball_lift, 1.2, 0.03, 100, Vec2d{30, 0}).y, f.y, 1e-15);
  EXPECT_NEAR(forces::lift_coefficient(forces::tennis_lift, 0.3), 1 / (2.022 + 0.981 / 0.3), 1e-15);
  EXPECT_NEAR(forces::lift_coefficient(forces::baseball_lift, 0.2), 1.12 * 0.2 / (0.583 + 2.333 * 0.2), 1e-15);
}

// H. Lamb, Hydrodynamics, art. 115: inertia coefficients of prolate spheroids, endways, broadside and turning.
TEST(AddedMass, LambsTableOfSpheroids) {
  const struct {
    double ratio, k1, k2, turning;
  } rows[] = {{1.50, 0.305, 0.621, 0.094}, {2.00, 0.209, 0.702, 0.240}, {2.51, 0.156, 0.763, 0.367},
              {2.99, 0.122, 0.803, 0.465}, {3.99, 0.082, 0.860, 0.608}, {4.99, 0.059, 0.895, 0.701},
              {6.01, 0.045, 0.918, 0.764}, {6.97, 0.036, 0.933, 0.805}, {8.01, 0.029, 0.945, 0.840},
              {9.02, 0.024, 0.954, 0.865}, {9.97, 0.021, 0.960, 0.883}};
  for (const auto& row : rows) {
    const forces::AddedShares s = forces::ellipsoid_added_mass({row.ratio, 1, 1});
    EXPECT_NEAR(s.linear.x, row.k1, 1.5e-3) << row.ratio;
    EXPECT_NEAR(s.linear.y, row.k2, 2.5e-3) << row.ratio;  // .7042, not .702, at 2: Lamb's hand slipped
    EXPECT_EQ(s.linear.y, s.linear.z);
    EXPECT_NEAR(s.angular.y, row.turning, 2.5e-3) << row.ratio;
    EXPECT_EQ(s.angular.x, 0);
  }
}

TEST(AddedMass, LimitsOfTheEllipsoid) {
  const forces::AddedShares ball = forces::ellipsoid_added_mass({2, 2, 2});
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(ball.linear[i], 0.5, 1e-9);
    EXPECT_EQ(ball.angular[i], 0);
  }
  // A very long one across is a cylinder, share 1; a very flat one broadside is a disc, 8/3 ρ r³.
  EXPECT_NEAR(forces::ellipsoid_added_mass({400, 1, 1}).linear.y, 1, 1e-4);
  const double thin = 1e-4;
  const double disc = forces::ellipsoid_added_mass({1, thin, 1}).linear.y * 4.0 / 3 * math::pi * thin;
  EXPECT_NEAR(disc / forces::disc_added_mass(1, 1), 1, 3e-4);
  // The axes may come in any order.
  const forces::AddedShares a = forces::ellipsoid_added_mass({3, 2, 1}), b = forces::ellipsoid_added_mass({1, 3, 2});
  EXPECT_NEAR(a.linear.x, b.linear.y, 1e-12);
  EXPECT_NEAR(a.angular.z, b.angular.x, 1e-12);
  EXPECT_NEAR(forces::sphere_added_mass(1000, 0.5), 500 * 4.0 / 3 * math::pi * 0.125, 1e-9);
  EXPECT_NEAR(forces::cylinder_added_mass(1000, 0.5), forces::plate_added_mass(1000, 1), 1e-9)
      << "a cylinder has the added mass of the plate as wide as it";
}

TEST(FrictionTable, FindsPairsInEitherOrder) {
  const auto pair = forces::find_friction("asphalt", "rubber");
  ASSERT_TRUE(pair.has_value());
  EXPECT_EQ(pair->static_coefficient, 0.9);
  EXPECT_EQ(pair->kinetic_coefficient, 0.7);
  EXPECT_EQ(forces::find_friction("steel", "steel")->static_coefficient, 0.78);
  EXPECT_FALSE(forces::find_friction("steel", "cheese").has_value());
  for (const forces::PairFriction& p : forces::friction_table()) {
    EXPECT_GT(p.kinetic_coefficient, 0) << p.first;
    EXPECT_LE(p.static_coefficient, 1.2) << p.first;
  }
}

}  // namespace drag_law_test
