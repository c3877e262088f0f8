// Laws of recoil, sway, dispersion and penetration. Published numbers are in tests/published.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

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

// Rise and swing have a frequency and a damping each: x(t) = (J b/I ω_d) e^{−ζωt} sin ω_d t, whose top is at
// tan ω_d t = √(1 − ζ²)/ζ.
TEST(Recoil, RiseAndSwingEachHaveTheirOwn) {
  const GunMount mount{.bore_above_shoulder = .04,
                       .bore_beside_shoulder = .01,
                       .rise_frequency = 2,
                       .rise_damping = .3,
                       .swing_frequency = 5,
                       .swing_damping = .7};
  const double impulse = 9, shot[] = {0.0};
  const auto top = [&](double lever, double frequency, double zeta) {
    const double w = 2 * math::pi * frequency, s = math::sqrt(1 - zeta * zeta);
    const double t = math::atan2(s, zeta) / (w * s);
    return std::pair{t, impulse * lever / (mount.inertia * w) * math::exp(-zeta * w * t)};
  };
  const auto [rise_time, rise] = top(.04, 2, .3);
  const auto [swing_time, swing] = top(.01, 5, .7);
  EXPECT_NEAR(recoil_at(mount, impulse, shot, rise_time).rise, rise, 1e-12);
  EXPECT_NEAR(recoil_at(mount, impulse, shot, swing_time).swing, swing, 1e-12);
  EXPECT_LT(recoil_at(mount, impulse, shot, rise_time + .01).rise, rise);
  EXPECT_LT(recoil_at(mount, impulse, shot, rise_time - .01).rise, rise);
  EXPECT_LT(recoil_at(mount, impulse, shot, swing_time + .01).swing, swing);
  const RecoilMotion at = recoil_at(mount, impulse, shot, .1);
  EXPECT_EQ(at.lift, 0);
  EXPECT_EQ(at.slide, 0);
  EXPECT_EQ(at.roll, 0);
}

// A centre of mass a hair off the shoulder moves as none does: the exponential of the coupled system against the closed
// form of three oscillators, damped little, critically and more, over bursts, and long after.
TEST(Recoil, CoupledBySoLittleIsUncoupled) {
  for (const double damping : {0.0, .4, 1.0, 2.5}) {
    GunMount mount{.bore_beside_shoulder = .01, .push_damping = damping, .rise_damping = damping};
    GunMount hair = mount;
    hair.centre_of_mass = {1e-12, 1e-12, 1e-12};
    const double shots[] = {0, .09, .2, .7};
    for (const double t : {.001, .05, .31, 1.7, 9.0}) {
      const RecoilMotion a = recoil_at(mount, 10, shots, t), b = recoil_at(hair, 10, shots, t);
      EXPECT_NEAR(a.back, b.back, 1e-10) << damping << ' ' << t;
      EXPECT_NEAR(a.rise, b.rise, 1e-10) << damping << ' ' << t;
      EXPECT_NEAR(a.swing, b.swing, 1e-10) << damping << ' ' << t;
    }
  }
}

// A centre of mass above the shoulder couples the way back with the rise. Without damping the two modes are known:
// det(K − ω² M) = 0 with M = (m, −m y; −m y, I), and q(t) = Σ φ (φᵀp) sin(ωt)/(ω φᵀMφ).
TEST(Recoil, PushAndRiseCoupledHaveTwoModes) {
  const double y = .12, m = 5, inertia = .4, b = .05, impulse = 8;
  const GunMount mount{.mass = m,
                       .inertia = inertia,
                       .bore_above_shoulder = b,
                       .push_frequency = 3,
                       .push_damping = 0,
                       .rise_frequency = 2,
                       .rise_damping = 0,
                       .centre_of_mass = {0, y, 0},
                       .roll_inertia = .1};
  ASSERT_TRUE(check(mount));
  const double k1 = m * math::square(6 * math::pi), k2 = inertia * math::square(4 * math::pi), c = -m * y;
  // (k1 − w m)(k2 − w I) − w² c² = 0 in w = ω².
  const double qa = m * inertia - c * c, qb = -(k1 * inertia + k2 * m), qc = k1 * k2;
  const double shot[] = {0.0};
  for (const double t : {.01, .1, .33, 1.0, 4.0}) {
    double x = 0, turn = 0;
    for (const double sign : {-1.0, 1.0}) {
      const double w = (-qb + sign * math::sqrt(qb * qb - 4 * qa * qc)) / (2 * qa), omega = math::sqrt(w);
      const double v = (k1 - w * m) / (w * c);  // φ = (1, v)
      const double scale = (-impulse + v * impulse * b) / (m + 2 * c * v + inertia * v * v);
      x += scale * math::sin(omega * t) / omega;
      turn += v * scale * math::sin(omega * t) / omega;
    }
    const RecoilMotion at = recoil_at(mount, impulse, shot, t);
    EXPECT_NEAR(at.back, -x, 1e-10) << t;
    EXPECT_NEAR(at.rise, turn, 1e-9) << t;
    EXPECT_NEAR(at.swing, 0, 1e-15) << "nothing couples it";
    EXPECT_NEAR(at.slide, 0, 1e-15);
  }
  // A bore through the centre of mass lifts nothing at first: the shoulder under it does, later.
  GunMount through = mount;
  through.bore_above_shoulder = y;
  const double dt = 1e-7;
  EXPECT_NEAR(recoil_at(through, impulse, shot, dt).rise / dt, 0, 1e-4);
  EXPECT_NEAR(recoil_at(through, impulse, shot, dt).back / dt, impulse / m, 1e-4);
  EXPECT_GT(recoil_at(through, impulse, shot, .05).rise, 1e-3);
}

// All six ways at once: without damping the energy of the shot stays, ½ pᵀM⁻¹p = ½ q̇ᵀMq̇ + ½ qᵀKq, and with it the
// equations of motion hold by differences of the positions, M q̈ + D q̇ + K q = 0.
TEST(Recoil, SixWaysKeepTheEnergyAndTheEquations) {
  GunMount g{.mass = 5,
             .inertia = .5,
             .bore_above_shoulder = .06,
             .bore_beside_shoulder = .02,
             .swing_frequency = 2.5,
             .centre_of_mass = {.2, .03, -.02},
             .roll_inertia = .03,
             .lift_frequency = 4,
             .slide_frequency = 5,
             .roll_frequency = 6};
  ASSERT_TRUE(check(g));
  using Six = std::array<double, 6>;
  const double shot[] = {0.0}, impulse = 7, h = 1e-4;
  const auto at = [&](double t) {
    const RecoilMotion q = recoil_at(g, impulse, shot, t);
    return Six{-q.back, q.lift, q.slide, q.roll, -q.swing, q.rise};
  };
  const math::Vec3d c = g.centre_of_mass;
  // The momentum of rates and its moment about the shoulder, from the motion of the centre: p = m (u̇ + θ̇ × c),
  // L = c × p + I_C θ̇, where I_C are the inertias less those of the mass in its centre.
  const auto momentum = [&](const Six& rate) {
    const math::Vec3d u{rate[0], rate[1], rate[2]}, turn{rate[3], rate[4], rate[5]};
    const math::Vec3d p = g.mass * (u + math::cross(turn, c)), own = math::cross(c, p);
    return Six{p.x,
               p.y,
               p.z,
               own.x + (g.roll_inertia - g.mass * (c.y * c.y + c.z * c.z)) * turn.x,
               own.y + (g.inertia - g.mass * (c.x * c.x + c.z * c.z)) * turn.y,
               own.z + (g.inertia - g.mass * (c.x * c.x + c.y * c.y)) * turn.z};
  };
  const double f[] = {g.push_frequency, g.lift_frequency,  g.slide_frequency,
                      g.roll_frequency, g.swing_frequency, g.rise_frequency};
  const double own[] = {g.mass, g.mass, g.mass, g.roll_inertia, g.inertia, g.inertia};
  for (const bool damped : {false, true}) {
    const double zeta[] = {.8, .5, .4, .6, .7, .3};
    double* const dampings[] = {&g.push_damping, &g.lift_damping,  &g.slide_damping,
                                &g.roll_damping, &g.swing_damping, &g.rise_damping};
    for (int i = 0; i < 6; ++i) *dampings[i] = damped ? zeta[i] : 0;
    double first = 0;
    for (const double t : {.02, .11, .4, 1.3}) {
      const Six before = at(t - h), now = at(t), after = at(t + h);
      Six rate, second;
      for (int i = 0; i < 6; ++i) {
        rate[i] = (after[i] - before[i]) / (2 * h);
        second[i] = (after[i] - 2 * now[i] + before[i]) / (h * h);
      }
      const Six force = momentum(second), moves = momentum(rate);
      double energy = 0;
      for (int i = 0; i < 6; ++i) {
        const double w = 2 * math::pi * f[i], k = own[i] * w * w, d = 2 * (damped ? zeta[i] : 0) * w * own[i];
        EXPECT_NEAR(force[i] + d * rate[i] + k * now[i], 0, 2e-4 * impulse) << i << " at " << t;
        energy += .5 * rate[i] * moves[i] + .5 * k * now[i] * now[i];
      }
      if (!damped) {
        if (first == 0) first = energy;
        EXPECT_NEAR(energy / first, 1, 1e-5) << t;
      } else {
        EXPECT_LT(energy, first == 0 ? 1e9 : first);
        first = energy;
      }
    }
  }
}

TEST(Recoil, MountsThatNoBodyHasAreRefused) {
  EXPECT_TRUE(check(GunMount{}));
  const auto heavy = check(GunMount{.centre_of_mass = {.5, 0, 0}});  // 4 kg at half a metre have 1 kg·m²
  ASSERT_FALSE(heavy);
  EXPECT_EQ(heavy.error().message.find("inertia is 0.8, expected more than 1 "), 0u) << heavy.error().message;
  EXPECT_NE(check(GunMount{.centre_of_mass = {0, .1, 0}}).error().message.find("roll_inertia"), std::string::npos);
  EXPECT_FALSE(check(GunMount{.slide_damping = -1}));
  EXPECT_FALSE(check(GunMount{.centre_of_mass = {std::nan(""), 0, 0}}));
}

TEST(Recoil, PatternClimbsAndRepeats) {
  GunMount mount;
  mount.bore_beside_shoulder = .005;
  const auto pattern = recoil_pattern(mount, 6, {.shots = 20});
  ASSERT_TRUE(pattern);
  ASSERT_EQ(pattern->size(), 20u);
  EXPECT_EQ((*pattern)[0], math::Vec2d{});
  EXPECT_GT((*pattern)[5].y, (*pattern)[1].y);
  EXPECT_GT((*pattern)[5].x, 0) << "a bore to the right of the shoulder swings the muzzle to the right, as one above "
                                   "lifts it";
  EXPECT_EQ(*recoil_pattern(mount, 6, {.shots = 20}), *pattern);
  EXPECT_NE(*recoil_pattern(mount, 6, {.shots = 20, .seed = 2}), *pattern);
  const auto bad = recoil_pattern({.mass = 0}, 6, {});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().message, "recoil: mass is 0, expected a finite number > 0, at most 1e+09");
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
