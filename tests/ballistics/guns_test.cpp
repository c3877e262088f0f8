// Recoil, sway, dispersion, penetration (shared reference "ballistics", 2.8).
#include <gtest/gtest.h>

#include <array>

#include "carom/ballistics/dispersion.h"
#include "carom/ballistics/penetration.h"
#include "carom/ballistics/recoil.h"
#include "carom/ballistics/sway.h"
#include "carom/math/random.h"

namespace ballistics_guns_test {
using namespace carom;
using namespace carom::ballistics;

constexpr double grain = 0.45359237 / 7000, foot = 0.3048, pound = 0.45359237, foot_pound = 1.3558179483;

TEST(Recoil, PublishedExamples) {
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

// The oscillator's impulse response: momentum at the start, back to rest, and linear in the shots.
TEST(Recoil, MountIsADampedOscillator) {
  const GunMount mount;
  const double impulse = 12, shot[] = {0.0}, two[] = {0.0, 0.1};
  const double dt = 1e-6;
  const RecoilMotion start = recoil_at(mount, impulse, shot, dt);
  EXPECT_NEAR(start.back / dt, impulse / mount.mass, 1e-4);
  EXPECT_NEAR(start.rise / dt, impulse * mount.bore_above_shoulder / mount.inertia, 1e-5);
  EXPECT_LT(math::abs(recoil_at(mount, impulse, shot, 5).rise), 1e-9);
  EXPECT_NEAR(recoil_at(mount, impulse, two, .25).rise,
              recoil_at(mount, impulse, shot, .25).rise + recoil_at(mount, impulse, shot, .15).rise, 1e-15);
  // The equation of motion by differences, also without and beyond critical damping.
  for (const double damping : {0.0, .3, 1.0, 1.7}) {
    GunMount m = mount;
    m.rise_damping = damping;
    const double w = 2 * math::pi * m.rise_frequency, h = 1e-4, t = .2;
    const double x0 = recoil_at(m, impulse, shot, t - h).rise, x1 = recoil_at(m, impulse, shot, t).rise,
                 x2 = recoil_at(m, impulse, shot, t + h).rise;
    EXPECT_NEAR((x2 - 2 * x1 + x0) / (h * h) + 2 * damping * w * (x2 - x0) / (2 * h) + w * w * x1, 0, 1e-4 * w * w);
  }
}

TEST(Recoil, PatternClimbsAndRepeats) {
  GunMount mount;
  mount.bore_beside_shoulder = .005;
  const auto pattern = recoil_pattern(mount, 6, {.shots = 20});
  ASSERT_TRUE(pattern);
  ASSERT_EQ(pattern->size(), 20u);
  EXPECT_EQ((*pattern)[0], math::Vec2d{});
  EXPECT_GT((*pattern)[5].y, (*pattern)[1].y);
  EXPECT_LT((*pattern)[5].x, 0) << "a bore to the right of the shoulder swings to the left";
  EXPECT_EQ(*recoil_pattern(mount, 6, {.shots = 20}), *pattern);
  EXPECT_NE(*recoil_pattern(mount, 6, {.shots = 20, .seed = 2}), *pattern);
  const auto bad = recoil_pattern({.mass = 0}, 6, {});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message, "recoil: mass is 0, expected a finite number > 0");
}

// Root mean squares and peaks of the spectrum are as set (not realism: amplitudes are designer's numbers).
TEST(Sway, SpectrumAndRms) {
  const Sway sway = sway_of(Stance::offhand);
  const SwayMotion motion(sway, 5);
  const double dt = 1.0 / 200;
  const int n = 1 << 17;  // 655 s
  double sum = 0;
  const auto power = [&](double frequency) {  // of a line, by projection
    double c = 0, s = 0;
    for (int i = 0; i < n; ++i) {
      const math::SinCos<double> a = math::sincos(2 * math::pi * frequency * i * dt);
      const double y = motion.at(i * dt).y;
      c += y * a.cos;
      s += y * a.sin;
    }
    return 2 * (c * c + s * s) / (double(n) * n);
  };
  for (int i = 0; i < n; ++i) sum += math::square(motion.at(i * dt).y);
  const double expected =
      math::square(sway.breath) + math::square(sway.heartbeat) + math::square(sway.tremor) + math::square(sway.drift);
  EXPECT_NEAR(sum / n, expected, .03 * expected);
  EXPECT_NEAR(math::sqrt(power(sway.breath_frequency)), sway.breath, .1 * sway.breath);
  EXPECT_GT(power(sway.heartbeat_frequency), 100 * power(1.3 * sway.heartbeat_frequency));
  // Holding the breath takes its line away.
  double held = 0;
  for (int i = 0; i < n; i += 7) held += math::square(motion.at(i * dt, 1).y) * 7;
  EXPECT_NEAR(held / n, expected - math::square(sway.breath) + 1.25 * math::square(sway.tremor), .06 * expected);
  EXPECT_GT(sway_of(Stance::offhand).drift, 3 * sway_of(Stance::prone).drift);
  EXPECT_LT(sway_of(Stance::prone, 1).tremor, sway_of(Stance::prone, 0).tremor);
  EXPECT_EQ(SwayMotion(sway, 5).at(3.3), motion.at(3.3));
}

// σ per axis: mean radius 1.2533 σ, CEP 1.1774 σ; circle of radius r: 1 − e^{−r²/2σ²}, exactly.
TEST(Dispersion, GaussianLaws) {
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

// Vacuum: a speed error δ drops the shot by g x²/v³ δ; aim σ x; wind does nothing.
TEST(Dispersion, SpreadByTheFlight) {
  const Gun gun{.muzzle_speed = 500, .sight_height = 0};
  const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const double elevation = zero_elevation(gun, vacuum, 300).value();
  const auto spread =
      spread_at(gun, vacuum, {.elevation = elevation}, 300, {.muzzle_speed = 5, .wind = 3, .aim = 1e-3});
  ASSERT_TRUE(spread) << spread.error().message;
  const double drop = 9.80665 * 300 * 300 / (500.0 * 500 * 500) * 5;
  EXPECT_NEAR(spread->sigma.x, .3, 1e-6);
  EXPECT_NEAR(spread->sigma.y, math::hypot(.3, drop), 1e-3 * .3);
  EXPECT_NEAR(spread->mean.y, 0, 1e-6);
  EXPECT_FALSE(spread_at(gun, vacuum, {.elevation = -1}, 1e7, {}));
}

TEST(Penetration, Formulas) {
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

TEST(Penetration, StrongMediaWithHardlyAnyInertiaGiveNoSpeed) {
  for (const double inertia : {1e-300, 1e-14, 1e-10, 1e-6, 1e-3})
    for (const double thickness : {1e-15, 1e-12, 1e-9, 1e-3}) {
      const double out = poncelet_residual({.speed = 800}, {.strength = 1e7, .inertia = inertia}, thickness);
      EXPECT_LE(out, 800) << inertia << ' ' << thickness;
      EXPECT_GE(out, 0);
    }
}

TEST(Penetration, LayersNeverGiveEnergy) {
  math::Random random(4);
  for (int i = 0; i < 500; ++i) {
    std::vector<Layer> layers(1 + random.below(5));
    for (Layer& layer : layers) {
      layer.thickness = random.uniform(1e-3, .2);
      layer.medium = {random.uniform(1e5, 1e9), random.uniform(0.0, 4000.0)};
      if (random.chance(.3)) layer.limit_speed = random.uniform(10.0, 900.0);
      layer.ricochet_angle = random.uniform(0.0, .3);
    }
    const Penetrator bullet{.speed = random.uniform(50.0, 1200.0)};
    const auto passages = penetrate(bullet, layers, random.uniform(.05, 1.57));
    ASSERT_TRUE(passages);
    double energy = .5 * bullet.mass * bullet.speed * bullet.speed, speed = bullet.speed;
    for (const LayerPassage& p : *passages) {
      EXPECT_EQ(p.speed_in, speed);
      EXPECT_LE(p.speed_out, p.speed_in);
      EXPECT_GE(p.energy, 0);
      energy -= p.energy;
      speed = p.speed_out;
    }
    EXPECT_NEAR(energy, .5 * bullet.mass * speed * speed, 1e-9);
  }
  // Monotone: a faster bullet leaves faster.
  double before = 0;
  const Layer wall[] = {{.thickness = .05, .medium = {2e7, 2000}}, {.thickness = .004, .limit_speed = 150}};
  for (double v = 100; v < 1500; v += 10) {
    const auto passages = penetrate({.speed = v}, wall);
    const double out = passages->size() == 2 ? passages->back().speed_out : 0;
    EXPECT_GE(out, before);
    before = out;
  }
  EXPECT_GT(before, 0);
  const Layer bad[] = {{}, {.thickness = -1}};
  EXPECT_EQ(penetrate({}, bad).error().message, "layer 2: thickness is -1, expected a finite number > 0");
}

}  // namespace ballistics_guns_test
