// Chapter 5 in closed form. Numbers: shared reference "mechanics", 5.2–5.4; tolerance: last printed digit.
#include "carom/forces/impact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace chapter_05_test {
using namespace carom;
using forces::ImpactBody2;
using forces::ImpactBody3;
using math::Mat3d;
using math::Vec2d;
using math::Vec3d;

// 5.2: m = 2, 1; v = 3, −1; e = .5: J = 4, v' = 1, 3.
TEST(Chapter05, DirectImpact) {
  const forces::DirectImpact hit = forces::direct_impact(2, 1, 3, -1, 0.5);
  EXPECT_NEAR(hit.impulse, 4, 1e-15);
  EXPECT_NEAR(hit.velocity_1, 1, 1e-15);
  EXPECT_NEAR(hit.velocity_2, 3, 1e-15);
  const forces::DirectImpact swap = forces::direct_impact(5, 5, 7, -2, 1);
  EXPECT_NEAR(swap.velocity_1, -2, 1e-12);
  EXPECT_NEAR(swap.velocity_2, 7, 1e-12);
}

// 5.3: two 5×10 boxes m = 10 (I = 104.1667), r₁ = (0, 5), r₂ = (2, −5), n = (0, 1), v₁ = (0, 4), e = .5:
// |J| = 25.16779, v₁' = 1.483221, v₂' = 2.516779; angular momentum conserved to 1e-12.
TEST(Chapter05, BoxesWithLeverArms) {
  const double m = 10, inertia = m * 125 / 12;
  EXPECT_NEAR(inertia, 104.1667, 5e-5);
  ImpactBody2 a{1 / m, 1 / inertia, {0, 5}, {0, 4}, 0}, b{1 / m, 1 / inertia, {2, -5}, {0, 0}, 0};
  // The point of impact is the origin, so the centres stand at −r.
  const auto angular = [&] {
    return m * math::cross(-a.arm, a.velocity) + inertia * a.angular_velocity + m * math::cross(-b.arm, b.velocity) +
           inertia * b.angular_velocity;
  };
  const double before = angular();
  const auto hit = forces::impact(a, b, Vec2d{0, -1}, 0.5, 0);
  EXPECT_NEAR(hit.normal_impulse, 25.16779, 5e-6);
  EXPECT_NEAR(a.velocity.y, 1.483221, 5e-7);
  EXPECT_NEAR(b.velocity.y, 2.516779, 5e-7);
  EXPECT_NEAR(angular(), before, 1e-12 * std::abs(before) + 1e-12);
  EXPECT_NEAR(math::dot(forces::impact_velocity(a, b), Vec2d{0, -1}), 0.5 * 4, 1e-12) << "leaves with e times";
}

// 5.4: solid sphere r = 21.35 mm, v = (10, −5), μ = .3, e = .8 on a floor: slides; v_x' = 7.3 m/s, spin 316.16 rad/s.
TEST(Chapter05, SphereSlidesOnAFloor) {
  const double r = 0.02135, m = 0.17, inertia = 0.4 * m * r * r;
  ImpactBody3 ball{1 / m, (1 / inertia) * Mat3d::identity(), {0, -r, 0}, {10, -5, 0}, {}}, floor;
  const double stick = 10 / forces::inverse_effective_mass(ball, floor, Vec3d{1, 0, 0});
  EXPECT_NEAR(stick / m, 2.857, 5e-4);
  const auto hit = forces::impact(ball, floor, Vec3d{0, 1, 0}, 0.8, 0.3);
  EXPECT_TRUE(hit.slides);
  EXPECT_NEAR(math::length(hit.tangent_impulse) / m, 2.7, 1e-12);
  EXPECT_NEAR(ball.velocity.x, 7.3, 1e-12);
  EXPECT_NEAR(ball.velocity.y, 4, 1e-12);
  EXPECT_NEAR(-ball.angular_velocity.z, 316.16, 5e-3);
  // With more friction it sticks: the contact point leaves without sliding.
  ImpactBody3 rough{1 / m, (1 / inertia) * Mat3d::identity(), {0, -r, 0}, {10, -5, 0}, {}};
  EXPECT_FALSE(forces::impact(rough, floor, Vec3d{0, 1, 0}, 0.8, 0.4).slides);
  EXPECT_NEAR(forces::impact_velocity(rough, floor).x, 0, 1e-12);
}

// 5.1: the impulse is the change of momentum, of both bodies together none; energy never rises.
TEST(Chapter05, MomentumIsKeptAndEnergyDoesNotRise) {
  for (int i = 0; i < 200; ++i) {
    const double t = 0.31 * i;
    ImpactBody3 a{0.5,
                  Mat3d::diagonal({0.4, 0.7, 0.9}),
                  {std::sin(t), 0.4, std::cos(t)},
                  {std::cos(2 * t), -1, 0.3},
                  {std::sin(3 * t), 0.2, 0.1}};
    ImpactBody3 b{
        0.25, Mat3d::diagonal({0.2, 0.1, 0.25}), {0.3, std::cos(t), -0.6}, {0.1, 2, std::sin(t)}, {0, -0.3, 1}};
    const Vec3d n = math::normalize(Vec3d{std::cos(t), std::sin(t), 0.5});
    const auto momentum = [&] { return a.velocity / a.inverse_mass + b.velocity / b.inverse_mass; };
    const auto energy = [&] {
      return math::dot(a.velocity, a.velocity) / a.inverse_mass + math::dot(b.velocity, b.velocity) / b.inverse_mass +
             math::dot(a.angular_velocity, math::inverse(a.inverse_inertia) * a.angular_velocity) +
             math::dot(b.angular_velocity, math::inverse(b.inverse_inertia) * b.angular_velocity);
    };
    const Vec3d p = momentum();
    const double e = energy();
    forces::impact(a, b, n, 0.01 * (i % 101), 0);
    EXPECT_LT(math::distance(momentum(), p), 1e-12);
    EXPECT_LE(energy(), e * (1 + 1e-13));
  }
}

// 5.2: h_n = e^{2n} h₀; total time √(2h/g)(1 + e)/(1 − e). 8.6: .36 and .1296 of the drop height at e = .6.
TEST(Chapter05, BouncingBall) {
  EXPECT_NEAR(forces::bounce_height(1, 0.6, 1), 0.36, 1e-15);
  EXPECT_NEAR(forces::bounce_height(1, 0.6, 2), 0.1296, 1e-15);
  const double fall = std::sqrt(2 * 2 / 9.81);
  double total = fall, e = 1;
  for (int i = 0; i < 400; ++i) {
    e *= 0.7;
    total += 2 * e * fall;
  }
  EXPECT_NEAR(forces::bounce_time(2, 9.81, 0.7), total, 1e-12);
}

// 5.4: tour drivers give a ball/club speed of about 1.48–1.49 (published shot data); 200 g head, 45.93 g ball, e = .83.
TEST(Chapter05, DriverAndBall) { EXPECT_NEAR(forces::struck_ball_speed(0.2, 0.04593, 1, 0.83), 1.49, 0.01); }

}  // namespace chapter_05_test
