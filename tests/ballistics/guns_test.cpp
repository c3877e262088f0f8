// Laws of recoil, sway, dispersion and penetration. Published numbers are in tests/published.
#include <gtest/gtest.h>

#include "carom/ballistics/dispersion.h"
#include "carom/ballistics/penetration.h"
#include "carom/ballistics/recoil.h"
#include "carom/ballistics/sway.h"
#include "carom/math/random.h"

namespace ballistics_guns_test {
using namespace carom;
using namespace carom::ballistics;

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
