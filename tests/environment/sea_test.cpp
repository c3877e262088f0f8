// Spectra of seas, and the water under the waves.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carom/environment/sea.h"
#include "carom/environment/sea_patch.h"

namespace sea_test {
using namespace carom;
using environment::Sea;
using environment::SeaDef;
using environment::SeaPoint;
using environment::WaveComponent;
using environment::WaveSpectrum;
using math::Vec3d;

constexpr double g = 9.80665, two_pi = 2 * math::pi;

// Reference "vehicles" 2C: mean periods over the peak period, T₀₁ = 2π m₀/m₁, T₀₂ = 2π √(m₀/m₂), T_e = 2π m₋₁/m₀.
TEST(WaveSpectrum, MomentsOfPiersonMoskowitzAndJonswap) {
  const struct {
    double gamma, t01, t02, te;
  } rows[] = {{1, 0.7718, 0.7104, 0.8572}, {3.3, 0.8343, 0.7774, 0.9033}};
  for (const auto& row : rows) {
    const WaveSpectrum s{3, 9, row.gamma};
    const double m0 = environment::spectral_moment(s, 0);
    EXPECT_NEAR(m0, 9.0 / 16, 1e-9) << "m₀ = H_s²/16";
    EXPECT_NEAR(two_pi * m0 / environment::spectral_moment(s, 1) / 9, row.t01, 1.5e-4) << row.gamma;
    EXPECT_NEAR(two_pi * std::sqrt(m0 / environment::spectral_moment(s, 2)) / 9, row.t02, 4e-4) << row.gamma;
    EXPECT_NEAR(two_pi * environment::spectral_moment(s, -1) / m0 / 9, row.te, 1.5e-4) << row.gamma;
  }
  // The factor by which the JONSWAP shape has to be scaled down: .6558 at γ = 3.3, .4494 at 7 (same reference).
  const auto share = [](double gamma) {
    return environment::spectral_density({1, 8, gamma}, 0.3 * two_pi / 8) /
           environment::spectral_density({1, 8, 1}, 0.3 * two_pi / 8);
  };
  EXPECT_TRUE(std::isfinite(share(3.3)));
  const double low = 0.6 * two_pi / 8;  // far under the peak γ^b is 1, so that the ratio of densities is the factor
  EXPECT_NEAR(environment::spectral_density({1, 8, 3.3}, low) / environment::spectral_density({1, 8, 1}, low), 0.6558,
              3e-4);
  EXPECT_NEAR(environment::spectral_density({1, 8, 7}, low) / environment::spectral_density({1, 8, 1}, low), 0.4494,
              3e-4);
}

// The moments again, by brute force over the density.
TEST(WaveSpectrum, DensityAddsUpToItsMoments) {
  for (const double gamma : {1.0, 2.0, 3.3, 7.0}) {
    const WaveSpectrum s{2, 7, gamma};
    double m0 = 0, m1 = 0;
    const double step = 0.002;
    for (double omega = 0.2; omega < 12; omega += step) {
      const double density = environment::spectral_density(s, omega) * step;
      m0 += density, m1 += omega * density;
    }
    EXPECT_NEAR(m0, 0.25, 2e-4) << gamma;
    EXPECT_NEAR(m1 / environment::spectral_moment(s, 1), 1, 5e-3) << gamma;
  }
}

// Pierson–Moskowitz by the wind at 19.5 m: 10 m/s H_s 2.133 T_p 7.302; 20 m/s 8.532, 14.604 (reference "vehicles" 2C).
TEST(WaveSpectrum, FullyGrownSeas) {
  EXPECT_NEAR(environment::fully_grown_sea(10, 9.81).significant_height, 2.133, 5e-4);
  EXPECT_NEAR(environment::fully_grown_sea(10, 9.81).peak_period, 7.302, 5e-4);
  EXPECT_NEAR(environment::fully_grown_sea(20, 9.81).significant_height, 8.532, 5e-4);
  EXPECT_NEAR(environment::fully_grown_sea(20, 9.81).peak_period, 14.604, 5e-4);
  // Young seas are lower and shorter than what the same wind makes of them in the end.
  const WaveSpectrum young = environment::fetch_limited_sea(15, 50e3);
  EXPECT_LT(young.significant_height, environment::fully_grown_sea(15).significant_height);
  EXPECT_LT(young.peak_period, environment::fully_grown_sea(15).peak_period);
  // JONSWAP's own fit of the energy over the fetch, m₀ g²/U⁴ = 1.6e-7 (g F/U²), that is H_s = 1.6e-3 U √(F/g), does not
  // go with its fits of α and ω_p: with γ = 3.3 those give 22 % more here.
  EXPECT_NEAR(young.significant_height / (1.6e-3 * 15 * std::sqrt(50e3 / g)), 1.22, 0.02);
  for (int code = 1; code < 9; ++code)
    EXPECT_LT(environment::sea_state(code).significant_height, environment::sea_state(code + 1).significant_height);
  EXPECT_NEAR(environment::sea_state(4).significant_height, 1.875, 1e-12);
}

TEST(WaveSpectrum, SpreadIsADensity) {
  for (const double s : {0.0, 1.0, 5.0, 10.0, 40.0}) {
    double sum = 0, second = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double theta = -math::pi + two_pi * (i + 0.5) / n, d = environment::spread_density(s, theta) * two_pi / n;
      sum += d, second += std::cos(theta) * d;
    }
    EXPECT_NEAR(sum, 1, 1e-7) << s;
    EXPECT_NEAR(second, s / (s + 1), 1e-6) << "first circular moment of cos²ˢ(θ/2), Longuet-Higgins 1963";
  }
}

// ω² = g k tanh(k h): deep water T 5/8/10/12 s has λ 39.03/99.92/156.13/224.83 m (reference, g 9.81); shallow √(g h).
TEST(Waves, Dispersion) {
  const struct {
    double period, length;
  } deep[] = {{5, 39.03}, {8, 99.92}, {10, 156.13}, {12, 224.83}};
  for (const auto& row : deep)
    EXPECT_NEAR(two_pi / environment::wave_number(two_pi / row.period, environment::deep_water, 9.81), row.length,
                0.006)
        << row.period;
  for (const double h : {0.5, 3.0, 20.0, 200.0})
    for (double omega = 0.05; omega < 8; omega *= 1.3) {
      const double k = environment::wave_number(omega, h);
      EXPECT_NEAR(g * k * std::tanh(k * h) / (omega * omega), 1, 1e-13) << h << " " << omega;
      EXPECT_NEAR(environment::wave_frequency_at_depth(k, h) / omega, 1, 1e-12);
    }
  EXPECT_NEAR(0.01 / environment::wave_number(0.01, 2), std::sqrt(g * 2), 1e-4) << "long waves run at √(g h)";
  EXPECT_EQ(environment::wave_number(0), 0);
}

// A drawn sea: H_s = 4 √m₀ exactly over its components, within a few per cent as a record of one place; peak and mean
// period; the mean direction and its spread.
TEST(Sea, ComponentsCarryTheSpectrum) {
  const SeaDef def{.spectrum = {3, 9, 3.3}, .direction = 0.7, .spread = 12, .components = 128, .seed = 4};
  const Sea sea = Sea::make({}, def).value();
  EXPECT_NEAR(sea.significant_height(), 3, 1e-9);
  double m0 = 0, m1 = 0, x = 0, z = 0, below_peak = 0;
  for (const WaveComponent& w : sea.components()) {
    const double e = 0.5 * w.amplitude * w.amplitude;
    m0 += e, m1 += e * w.frequency;
    x += e * w.direction_x, z += e * w.direction_z;
    if (w.frequency < two_pi / 9) below_peak += e;
  }
  EXPECT_NEAR(two_pi * m0 / m1 / (0.8343 * 9), 1, 0.02) << "T₀₁; what is beyond 4 ω_p is left out";
  EXPECT_NEAR(std::atan2(z, x), 0.7, 0.06);
  EXPECT_NEAR(std::hypot(x, z) / m0, 12.0 / 13, 0.02) << "spread";
  double part = 0;
  for (double omega = 0.3; omega < two_pi / 9; omega += 1e-3)
    part += environment::spectral_density(def.spectrum, omega);
  EXPECT_NEAR(below_peak / m0, part * 1e-3 / (9.0 / 16), 0.02);

  // As measured by a staff for three hours, twice a second.
  double sum = 0, squares = 0;
  int n = 0, crossings = 0;
  double before = 0;
  for (double t = 0; t < 10800; t += 0.5, ++n) {
    const double eta = sea.height(20, -30, t);
    sum += eta, squares += eta * eta;
    if (before < 0 && eta >= 0) ++crossings;
    before = eta;
  }
  EXPECT_NEAR(sum / n, 0, 0.02);
  EXPECT_NEAR(4 * std::sqrt(squares / n) / 3, 1, 0.03);
  EXPECT_NEAR(10800.0 / crossings / (0.7774 * 9), 1, 0.05) << "zero-up-crossing period T₀₂";
}

TEST(Sea, IsTheSameByItsSeed) {
  const SeaDef def{.spectrum = {2, 7, 3.3}, .seed = 11};
  const Sea a = Sea::make({}, def).value(), b = Sea::make({}, def).value();
  EXPECT_EQ(a.height(3, 4, 5), b.height(3, 4, 5));
  SeaDef other = def;
  other.seed = 12;
  EXPECT_NE(a.height(3, 4, 5), Sea::make({}, other).value().height(3, 4, 5));
}

Sea one_wave(double depth, Vec3d current = {}) {
  const WaveComponent wave = environment::regular_wave(1.2, 6, 0.5, depth);
  return Sea::make({.level = 1, .depth = depth, .current = current}, {&wave, 1}).value();
}

// Normal and velocity are derivatives of what they belong to: continuity, no vorticity, the surface's own motion.
TEST(Sea, MotionIsPotentialFlow) {
  for (const double depth : {4.0, 30.0, environment::deep_water}) {
    const Sea sea = one_wave(depth);
    const double d = 1e-4;
    const Vec3d p{3, -1.5, 2};
    const auto at = [&](Vec3d x, double t) { return sea.sample(x, t); };
    const auto partial = [&](int axis, double t) {
      Vec3d step{};
      step[axis] = d;
      return (at(p + step, t).velocity - at(p - step, t).velocity) / (2 * d);
    };
    const double t = 1.3;
    const Vec3d dx = partial(0, t), dy = partial(1, t), dz = partial(2, t);
    // Stretching bends the columns a little: the flow is free of divergence and turning to first order of the slope.
    const double scale = math::length(dy) + math::length(dx);
    EXPECT_LT(std::abs(dx.x + dy.y + dz.z), 0.12 * scale) << depth;
    EXPECT_LT(std::abs(dx.y - dy.x), 0.12 * scale) << depth;
    EXPECT_LT(std::abs(dz.x - dx.z), 1e-6) << depth;
    const Vec3d acceleration = (at(p, t + d).velocity - at(p, t - d).velocity) / (2 * d);
    EXPECT_LT(math::distance(acceleration, at(p, t).acceleration), 0.15 * math::length(acceleration)) << depth;
    // On the surface ∂η/∂t = w: the surface is made of water.
    const double eta_t = (sea.height(p.x, p.z, t + d) - sea.height(p.x, p.z, t - d)) / (2 * d);
    const SeaPoint top = at({p.x, sea.height(p.x, p.z, t), p.z}, t);
    EXPECT_NEAR(top.velocity.y, eta_t, 1e-6);
    EXPECT_NEAR(top.pressure, 0, 1e-6);
    const Vec3d slope{-(sea.height(p.x + d, p.z, t) - sea.height(p.x - d, p.z, t)) / (2 * d), 1,
                      -(sea.height(p.x, p.z + d, t) - sea.height(p.x, p.z - d, t)) / (2 * d)};
    EXPECT_LT(math::distance(top.normal, math::normalize(slope)), 1e-8);
  }
}

// Under a still surface it is ρ g d; the wave's part dies away as cosh k(y+h)/cosh kh.
TEST(Sea, Pressure) {
  EXPECT_NEAR(Sea().sample({0, -10, 0}, 0).pressure, 1025 * g * 10, 1e-6);
  EXPECT_EQ(Sea().sample({0, 2, 0}, 0).pressure, 0);
  const Sea sea = one_wave(12);
  const WaveComponent w = sea.components()[0];
  // At the bed under a crest and a trough: linear theory to the order of the slope.
  double most = -1e9, least = 1e9;
  for (double t = 0; t < 6; t += 0.01) {
    const double p = sea.sample({0, 1 - 12 + 1e-9, 0}, t).pressure - 1025 * g * 12;
    most = std::max(most, p), least = std::min(least, p);
  }
  const double linear = 1025 * g * w.amplitude / std::cosh(w.wave_number * 12);
  EXPECT_NEAR(most / linear, 1, 0.02);
  EXPECT_NEAR(least / -linear, 1, 0.02);
  // Within the wave it never falls upward: down the column under crest and trough.
  for (double t = 0; t < 6; t += 0.5) {
    double before = -1;
    for (double y = sea.height(0, 0, t); y > -10; y -= 0.1) {
      const double p = sea.sample({0, y, 0}, t).pressure;
      EXPECT_GE(p, before - 1e-6);
      before = p;
    }
  }
}

// Wheeler: at a crest the water of the still surface is what moves there, no more: linear theory run on above the still
// level by e^{kη} would give more.
TEST(Sea, WheelerStretching) {
  const Sea sea = one_wave(environment::deep_water);
  const WaveComponent w = sea.components()[0];
  double t = 0;
  for (double s = 0, best = -1e9; s < 6; s += 0.001)
    if (sea.height(0, 0, s) > best) best = sea.height(0, 0, s), t = s;
  const double top = sea.height(0, 0, t);
  const Vec3d v = sea.sample({0, top, 0}, t).velocity;
  EXPECT_NEAR(std::hypot(v.x, v.z), w.amplitude * w.frequency, 1e-4);
  EXPECT_NEAR(std::hypot(sea.sample({0, top - 3, 0}, t).velocity.x, sea.sample({0, top - 3, 0}, t).velocity.z),
              w.amplitude * w.frequency * std::exp(-3 * w.wave_number), 1e-4);
}

// A particle of water in the wave drifts by Stokes' law though the wave has no mean flow: a² ω k e^{2ky} at depth.
TEST(Sea, ParticlesDriftAsStokesSays) {
  const WaveComponent wave = environment::regular_wave(0.4, 5);
  const Sea sea = Sea::make({.stretching = environment::Stretching::vertical}, {&wave, 1}).value();
  const double depth = 4;
  Vec3d p{0, -depth, 0};
  const int periods = 20, steps = 400 * periods;
  const double h = 5.0 * periods / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const Vec3d k1 = sea.sample(p, t).velocity, k2 = sea.sample(p + 0.5 * h * k1, t + 0.5 * h).velocity,
                k3 = sea.sample(p + 0.5 * h * k2, t + 0.5 * h).velocity, k4 = sea.sample(p + h * k3, t + h).velocity;
    p += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  const double drift = p.x / (5.0 * periods);
  const double expected = sea.stokes_drift(depth).x;
  EXPECT_NEAR(expected, 0.04 * wave.frequency * wave.wave_number * std::exp(-2 * wave.wave_number * depth), 1e-12);
  EXPECT_NEAR(drift / expected, 1, 0.02);
}

TEST(Sea, CurrentCarriesTheWaves) {
  const Sea still = one_wave(20), flowing = one_wave(20, {1.5, 0, -0.4});
  for (double t = 0; t < 9; t += 0.7) {
    EXPECT_NEAR(flowing.height(3 + 1.5 * t, 2 - 0.4 * t, t), still.height(3, 2, t), 1e-12);
    const Vec3d a = flowing.sample({3 + 1.5 * t, -1, 2 - 0.4 * t}, t).velocity,
                b = still.sample({3, -1, 2}, t).velocity;
    EXPECT_LT(math::distance(a, b + Vec3d{1.5, 0, -0.4}), 1e-12);
  }
}

// The same surface for drawing as for floating, whichever way it is asked for.
TEST(Sea, GridAndPointsAgree) {
  const Sea sea = Sea::make({.level = -2}, SeaDef{.spectrum = {4, 10, 3.3}, .components = 64}).value();
  std::vector<double> grid(80 * 40), points(80 * 40);
  std::vector<math::Vec2d> places;
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 80; ++column) places.push_back({-100 + 2.5 * column, 30 + 2.5 * row});
  sea.grid(-100, 30, 2.5, 80, 40, 77.7, grid);
  sea.heights(places, 77.7, points);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_NEAR(grid[i], points[i], 4e-12);
    EXPECT_EQ(points[i], sea.height(places[i].x, places[i].y, 77.7));
    if (i % 97 == 0) {
      EXPECT_NEAR(sea.sample({places[i].x, 0, places[i].y}, 77.7).height, points[i], 1e-12);
    }
  }
  std::vector<double> short_one(10, 5.0);
  sea.grid(0, 0, 1, 80, 40, 0, short_one);
  EXPECT_EQ(short_one[0], 5.0) << "too little room: untouched";
}

// Lanes of floats round an origin, however far off and late: the surface and its slopes, the same bits at any width.
TEST(SeaPatch, IsTheSameSea) {
  const Sea sea =
      Sea::make({.level = 3, .current = {0.4, 0, 0}}, SeaDef{.spectrum = {4, 9, 3.3}, .components = 64}).value();
  for (const math::Vec2d origin : {math::Vec2d{0, 0}, math::Vec2d{2e6, -3e6}}) {
    const double time = origin.x > 0 ? 1e5 : 3;
    const environment::SeaPatch patch(sea, origin, time);
    std::vector<float> x, z;
    for (int i = 0; i < 203; ++i) x.push_back(-80 + 0.79f * float(i)), z.push_back(60 - 0.57f * float(i));
    std::vector<float> height(x.size()), slope_x(x.size()), slope_z(x.size());
    patch.heights(x, z, height, slope_x, slope_z);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double px = origin.x + double(x[i]), pz = origin.y + double(z[i]);
      EXPECT_NEAR(height[i], sea.height(px, pz, time) - 3, 5e-5);
      const Vec3d n = sea.sample({px, 0, pz}, time).normal;
      EXPECT_NEAR(slope_x[i], -n.x / n.y, 3e-5);
      EXPECT_NEAR(slope_z[i], -n.z / n.y, 3e-5);
    }
    for (const int lanes : {4, 8, 16}) {
      std::vector<float> other(x.size());
      environment::SeaPatch(sea, origin, time, lanes).heights(x, z, other);
      EXPECT_EQ(other, height) << lanes;
    }
  }
  EXPECT_EQ(environment::SeaPatch(Sea(), {}, 0).lanes() % 4, 0);
}

// What is wide feels short waves less: the mean over a disc.
TEST(Sea, WideBodiesFeelTheMean) {
  const WaveComponent wave = environment::regular_wave(1, 3);
  const Sea sea = Sea::make({}, {&wave, 1}).value();
  const double radius = 2;
  double sum = 0;
  int n = 0;
  for (double x = -radius; x <= radius; x += 0.02)
    for (double z = -radius; z <= radius; z += 0.02)
      if (x * x + z * z <= radius * radius) sum += sea.height(1 + x, z, 0.4), ++n;
  EXPECT_NEAR(sea.sample({1, 0, 0}, 0.4, environment::disc_footprint(radius)).height / (sum / n), 1, 0.02);
}

TEST(Sea, RefusesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const auto& result) {
    return result.ok() ? std::string("accepted") : result.error().message;
  };
  EXPECT_EQ(message(environment::wave_components({.spectrum = {-1, 6, 1}})),
            "wave_components: significant_height is -1, expected 0 m or more");
  EXPECT_NE(message(environment::wave_components({.spectrum = {1, 0, 1}})).find("peak_period is 0"), std::string::npos);
  EXPECT_NE(message(environment::wave_components({.spectrum = {1, 6, 0.5}})).find("1 … 10"), std::string::npos);
  EXPECT_NE(message(environment::wave_components({.components = 0})).find("components is 0"), std::string::npos);
  EXPECT_NE(message(environment::wave_components({.direction = nan})).find("direction"), std::string::npos);
  EXPECT_NE(message(Sea::make({.depth = 0})).find("depth is 0"), std::string::npos);
  EXPECT_NE(message(Sea::make({.level = nan})).find("level"), std::string::npos);
  const WaveComponent bad[2] = {{1, 1, 1, 1, 0, 0}, {1, 1, 1, 1, 1, 0}};
  EXPECT_NE(message(Sea::make({}, bad)).find("components[1].direction"), std::string::npos);
}

}  // namespace sea_test
