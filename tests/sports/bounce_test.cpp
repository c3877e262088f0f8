// Bounces and rolls: energy, mirrors, spin that checks a ball, slopes.
#include "carom/sports/bounce.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/presets.h"

namespace sports_bounce_test {
using namespace carom;
using namespace carom::sports;

double energy(const Ball& b, const BallState& s) {
  return .5 * b.mass * math::dot(s.velocity, s.velocity) + .5 * inertia(b) * math::dot(s.spin, s.spin);
}

TEST(SportsBounce, EnergyNeverRises) {
  const Ball golf = *ball_preset("golf"), tennis = *ball_preset("tennis");
  for (const SurfacePreset& surface : surface_presets())
    for (const Ball& ball : {golf, tennis})
      for (int angle = 5; angle < 90; angle += 7)
        for (const double spin : {-900.0, -100.0, 0.0, 150.0, 900.0}) {
          const math::SinCos<double> a = math::sincos(angle * math::pi / 180);
          const BallState in{.velocity = {25 * a.cos, -25 * a.sin, 3}, .spin = {40, -20, spin}};
          const Bounce out = bounce(ball, surface.surface, {0, 1, 0}, in);
          EXPECT_LE(energy(ball, out.after), energy(ball, in) * (1 + 1e-12)) << surface.name << " " << angle;
          EXPECT_GE(out.after.velocity.y, -1e-12);
          // Mirrored in the plane of the way.
          BallState image = in;
          image.velocity.z = -in.velocity.z;
          image.spin = {-in.spin.x, -in.spin.y, in.spin.z};
          const Bounce other = bounce(ball, surface.surface, {0, 1, 0}, image);
          EXPECT_NEAR(other.after.velocity.z, -out.after.velocity.z, 1e-12);
          EXPECT_NEAR(other.after.spin.z, out.after.spin.z, 1e-9);
        }
}

// Angular momentum about the point of contact is conserved: R m v_t + I ω.
TEST(SportsBounce, FrictionActsAtTheContact) {
  const Ball ball = *ball_preset("tennis");
  const BallState in{.velocity = {20, -8, 0}, .spin = {0, 0, 250}};
  for (const char* name : {"hard_court", "clay_court", "grass_court"}) {
    const Bounce out = bounce(ball, *surface_preset(name), {0, 1, 0}, in);
    const auto about = [&](const BallState& s) {
      return -ball.radius * ball.mass * s.velocity.x + inertia(ball) * s.spin.z;
    };
    EXPECT_NEAR(about(out.after), about(in), 1e-12) << name;
    EXPECT_LT(out.after.spin.z, 0) << "backspin turns to topspin";
  }
  // Clay takes more pace than grass.
  EXPECT_LT(bounce(ball, *surface_preset("clay_court"), {0, 1, 0}, in).after.velocity.x,
            bounce(ball, *surface_preset("grass_court"), {0, 1, 0}, in).after.velocity.x);
  // What parts already is left alone.
  const BallState leaving{.velocity = {3, 1, 0}};
  EXPECT_EQ(bounce(ball, *surface_preset("clay_court"), {0, 1, 0}, leaving).after.velocity.y, 1);
}

// A bouncing ball: heights fall as e², and it stops after √(2h/g)(1 + e)/(1 − e).
TEST(SportsBounce, DropsAsTheGeometricSeries) {
  Ball ball{.mass = .1, .radius = .02, .drag = {.fast = 0}};
  const Surface floor{.restitution = .6, .rolling = .1};
  const auto shot =
      play(ball, {.air = environment::AirColumn::uniform(0)}, {.position = {0, 1.02, 0}}, floor, {.roll_speed = 1e-3});
  ASSERT_TRUE(shot) << shot.error().message;
  const double fall = math::sqrt(2 / 9.80665);
  EXPECT_NEAR(shot->duration(), fall * (1 + .6) / (1 - .6), 2e-3);
  ASSERT_GT(shot->contacts().size(), 5u);
  EXPECT_NEAR(shot->contacts()[1].time - shot->contacts()[0].time, 2 * .6 * fall, 1e-6);
}

// From skid to roll: 5/7 of the speed of a solid ball, after 2 v/(7 μ g).
TEST(SportsBounce, SkidsIntoRolling) {
  Ball ball{.mass = .17, .radius = .0286};
  const Surface cloth{.friction = .2, .restitution = 0, .rolling = 1e-6};
  const auto shot = play(ball, {.air = environment::AirColumn::uniform(0)},
                         {.position = {0, .0286, 0}, .velocity = {2, 0, 0}}, cloth, {.time = 1});
  ASSERT_TRUE(shot) << shot.error().message;
  const double stop = 2 * 2 / (7 * .2 * 9.80665);
  EXPECT_NEAR(shot->at(stop + .1).velocity.x, 10.0 / 7, .005);
  EXPECT_NEAR(shot->at(stop / 2).velocity.x, 2 - .2 * 9.80665 * stop / 2, 1e-6);
  EXPECT_EQ(shot->phase_at(.5), Shot::Phase::roll);
}

// A slope: the ball rolls down with g sin θ/(1 + β) − rolling; on a gentle one it is held.
TEST(SportsBounce, SlopesPull) {
  const Ball ball = *ball_preset("golf");
  const double steep = .1;
  const math::SinCos<double> t = math::sincos(steep);
  Surface green = *surface_preset("green");
  const auto slope = [&](double x, double) { return Ground{-x * t.sin / t.cos, {t.sin, t.cos, 0}, green}; };
  const BallState start{.position = {0, ball.radius / t.cos, 0},
                        .velocity = {.5 * t.cos, -.5 * t.sin, 0},
                        .spin = {0, 0, -.5 / ball.radius}};
  const auto shot = play(ball, {}, start, slope, {.time = 2});
  ASSERT_TRUE(shot) << shot.error().message;
  const double a = 9.80665 * (t.sin / 1.4 - green.rolling * t.cos);
  EXPECT_GT(a, 0);
  EXPECT_NEAR(math::length(shot->at(1.5).velocity), .5 + 1.5 * a, 1e-3);
  green.rolling = .3;
  const auto held = play(ball, {}, start, slope, {.time = 20});
  ASSERT_TRUE(held);
  EXPECT_LT(held->duration(), 5);
  EXPECT_EQ(held->phase_at(19), Shot::Phase::rest);
}

// Backspin checks a wedge shot; topspin lets it run.
TEST(SportsBounce, BackspinChecks) {
  const Ball golf = *ball_preset("golf");
  const auto run = [&](double spin) {
    const auto shot = play(golf, {}, launch_state({.speed = 40, .elevation = .5, .spin = spin}, {0, golf.radius, 0}),
                           *surface_preset("green"));
    EXPECT_TRUE(shot) << shot.error().message;
    return shot->rest().position.x - shot->contacts()[0].before.position.x;
  };
  EXPECT_LT(run(1000), run(500));
  EXPECT_LT(run(500), run(100));
  EXPECT_GT(run(100), 0);
}

}  // namespace sports_bounce_test
