// Chapter 18.4 and 18.5: dispersion, recoil, penetration (shared reference "ballistics", 2.8).
#include <gtest/gtest.h>

#include <array>

#include "carom/ballistics/dispersion.h"
#include "carom/ballistics/penetration.h"
#include "carom/ballistics/recoil.h"
#include "carom/ballistics/sway.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace published_chapter_18_recoil_test {
using namespace carom;
using namespace carom::ballistics;

constexpr double grain = 0.45359237 / 7000, foot = 0.3048, pound = 0.45359237, foot_pound = 1.3558179483;

TEST(Chapter18Recoil, PublishedExamples) {
  // 180 gr at 3000 ft/s, 70 gr of powder, 8.5 lb, gas 5200 ft/s: 15.19 ft/s, 30.49 ft·lbf.
  const FreeRecoil a = free_recoil({180 * grain, 3000 * foot, 70 * grain, 5200 * foot}, 8.5 * pound);
  EXPECT_NEAR(a.speed / foot, 15.19, .01);
  EXPECT_NEAR(a.energy / foot_pound, 30.49, .01);
  // .308 168 gr at 2650, 43.5 gr, 8 lb, 1.75 v: 11.552 ft/s, 16.59 ft·lbf.
  const FreeRecoil b = free_recoil({168 * grain, 2650 * foot, 43.5 * grain, 1.75 * 2650 * foot}, 8 * pound);
  EXPECT_NEAR(b.speed / foot, 11.552, .001);
  EXPECT_NEAR(b.energy / foot_pound, 16.59, .01);
  for (const auto& [gas, energy] : {std::array{4000.0, 15.4}, std::array{4700.0, 17.1}})
    EXPECT_NEAR(free_recoil({150 * grain, 2800 * foot, 46 * grain, gas * foot}, 7.5 * pound).energy / foot_pound,
                energy, .05);
  EXPECT_NEAR(pendulum_speed(.01, 400, 2), 1.99005, 5e-6);
}

// σ per axis: mean radius 1.2533 σ, CEP 1.1774 σ; circle of radius r: 1 − e^{−r²/2σ²}, exactly.
TEST(Chapter18Dispersion, GaussianLaws) {
  for (const double r : {.2, 1.0, 3.0, 12.0})
    EXPECT_NEAR(hit_probability({{}, {1, 1}}, r), -math::expm1(-.5 * r * r), 1e-7) << r;
  EXPECT_NEAR(hit_probability({{}, {2, 2}}, circular_error_probable(2)), .5, 1e-7);
  EXPECT_NEAR(hit_probability({{}, {1, 1}}, math::Vec2d{1, 1}), math::square(.682689492137), 1e-10);
  EXPECT_NEAR(hit_probability({{3, 0}, {1, 0}}, math::Vec2d{1, 1}), .022718491, 1e-6);
  math::Random random(8);
  const Spread spread{{.5, -1}, {1.5, .7}};
  int in_circle = 0, in_box = 0;
  double radius = 0;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const math::Vec2d p{random.normal(spread.mean.x, spread.sigma.x), random.normal(spread.mean.y, spread.sigma.y)};
    in_circle += math::length(p) < 1.5;
    in_box += math::abs(p.x) < 1 && math::abs(p.y) < 2;
    radius += math::length(math::Vec2d{random.normal(), random.normal()});
  }
  EXPECT_NEAR(double(in_circle) / n, hit_probability(spread, 1.5), .004);
  EXPECT_NEAR(double(in_box) / n, hit_probability(spread, math::Vec2d{1, 2}), .004);
  EXPECT_NEAR(radius / n, mean_radius(1), .02 * mean_radius(1));
}

TEST(Chapter18Penetration, Formulas) {
  EXPECT_NEAR(poncelet_depth({.0095, 4.56e-5, 800}, {5e6, 1000}), .506230, 5e-7);
  // The depth is where the residual speed vanishes, and the work is the energy.
  const Penetrator bullet;
  const Medium medium;
  const double depth = poncelet_depth(bullet, medium);
  EXPECT_GT(poncelet_residual(bullet, medium, .999 * depth), 0);
  EXPECT_EQ(poncelet_residual(bullet, medium, 1.001 * depth), 0);
  EXPECT_NEAR(poncelet_residual(bullet, {5e6, 0}, .1), math::sqrt(640000 - 2 * 4.56e-5 * .1 * 5e6 / .0095), 1e-9);
  EXPECT_NEAR(recht_ipson_residual(900, 600, .01, .002), math::sqrt(810000.0 - 360000) / 1.2, 1e-9);
  EXPECT_NEAR(lambert_jonas_residual(900, 600, 1, 2), recht_ipson_residual(900, 600, 1, 0), 1e-9);
  EXPECT_NEAR(water_ricochet_angle(7.85) * 180 / math::pi, 6.4, .05);
  EXPECT_NEAR(water_ricochet_angle(11.34) * 180 / math::pi, 5.4, .06);
}

// Amplitudes and frequencies of marksmen, of the order that is told (no measured table is known): an average shooter
// offhand 1 to 3 mrad, with a rest .1 to .3; breath .2 to .3 Hz, heart 1 to 1.5, tremor 8 to 12. Experts are steadier.
TEST(Chapter18Sway, OrdersOfMagnitude) {
  const auto all = [](const Sway& s) {
    return 1e3 * math::sqrt(s.breath * s.breath + s.heartbeat * s.heartbeat + s.tremor * s.tremor + s.drift * s.drift);
  };
  EXPECT_GT(all(sway_of(Stance::offhand)), 1);
  EXPECT_LT(all(sway_of(Stance::offhand)), 3);
  EXPECT_GT(all(sway_of(Stance::supported)), .1);
  EXPECT_LT(all(sway_of(Stance::supported)), .3);
  double before = 1e300;
  for (const Stance stance : {Stance::offhand, Stance::kneeling, Stance::sitting, Stance::prone, Stance::supported}) {
    const Sway s = sway_of(stance);
    EXPECT_LT(all(s), before);
    before = all(s);
    EXPECT_LT(all(sway_of(stance, 1)), all(s));
    EXPECT_GT(all(sway_of(stance, 0)), all(s));
    EXPECT_GT(all(sway_of(stance, .5, 1)), all(s));
    EXPECT_GE(s.breath_frequency, .2);
    EXPECT_LE(s.breath_frequency, .3);
    EXPECT_GE(s.heartbeat_frequency, 1);
    EXPECT_LE(s.heartbeat_frequency, 1.5);
    EXPECT_EQ(s.tremor_low, 8);
    EXPECT_EQ(s.tremor_high, 12);
  }
}

}  // namespace published_chapter_18_recoil_test
