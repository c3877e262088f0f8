// Gusts, turbulence, thermals, lees and the whole field.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carom/environment/environment.h"
#include "carom/math/random.h"

namespace wind_field_test {
using namespace carom;
using environment::Gust;
using environment::Thermal;
using environment::Turbulence;
using environment::TurbulenceDef;
using environment::TurbulenceSpectrum;
using environment::WindField;
using math::Vec3d;

// 1 − cos: nothing, half, the peak, half, nothing at 0, H/2, H, 3H/2, 2H.
TEST(Gust, Shape) {
  const Gust gust{.velocity = {0, 8, 0}, .direction = {-1, 0, 0}, .front = -100, .gradient_distance = 40};
  // An aircraft that flies along x meets it at x = 100.
  EXPECT_EQ(environment::gust_at(gust, {99.9, 0, 0}, 0).y, 0);
  EXPECT_NEAR(environment::gust_at(gust, {120, 0, 5}, 3).y, 4, 1e-12);
  EXPECT_NEAR(environment::gust_at(gust, {140, 0, 0}, 0).y, 8, 1e-12);
  EXPECT_NEAR(environment::gust_at(gust, {160, 0, 0}, 0).y, 4, 1e-12);
  EXPECT_EQ(environment::gust_at(gust, {180.1, 0, 0}, 0).y, 0);
  Gust lasting = gust;
  lasting.lasting = true;
  EXPECT_EQ(environment::gust_at(lasting, {500, 0, 0}, 0).y, 8) << "MIL-F-8785C: it stays";
  Gust moving{.velocity = {5, 0, 0}, .direction = {1, 0, 0}, .front = 0, .gradient_distance = 10, .speed = 20};
  EXPECT_EQ(environment::gust_at(moving, {30, 0, 0}, 1).x, 0) << "the front is at 20";
  EXPECT_NEAR(environment::gust_at(moving, {30, 0, 0}, 2).x, 5, 1e-12) << "10 m into it";
}

// 14 CFR 25.341(a)(5): 17.07 m/s at sea level, 13.41 at 15 000 ft, 6.36 at 60 000 ft for H = 350 ft; less for short
// ones.
TEST(Gust, DesignSpeeds) {
  EXPECT_NEAR(environment::design_gust_speed(0, 107), 17.07, 1e-12);
  EXPECT_NEAR(environment::design_gust_speed(4572, 107), 13.41, 1e-12);
  EXPECT_NEAR(environment::design_gust_speed(18288, 107), 6.36, 1e-12);
  EXPECT_NEAR(environment::design_gust_speed(0, 9), 17.07 * std::pow(9.0 / 107, 1.0 / 6), 1e-12);
}

// MIL-F-8785C at 200 ft with 30 kn at 20 ft, by hand: q = .3416, L_u = 200/.3416^1.2 = 725.8 ft, σ_w = 3 kn,
// σ_u = 3/.3416^.4 = 4.611 kn.
TEST(Turbulence, ScalesOfTheStandard) {
  const double knot = 0.514444, feet = 0.3048;
  const environment::TurbulenceScales low = environment::low_altitude_turbulence(200 * feet, 30 * knot);
  EXPECT_NEAR(low.length.x / feet, 725.8, 0.3);
  EXPECT_NEAR(low.length.z / feet, 200, 1e-9);
  EXPECT_NEAR(low.intensity.z / knot, 3, 1e-9);
  EXPECT_NEAR(low.intensity.x / knot, 4.611, 2e-3);
  // At 1000 ft all are alike.
  const environment::TurbulenceScales top = environment::low_altitude_turbulence(1000 * feet, 30 * knot);
  EXPECT_NEAR(top.length.x / feet, 1000, 1e-6);
  EXPECT_NEAR(top.intensity.x / top.intensity.z, 1, 1e-9);
  EXPECT_NEAR(environment::high_altitude_turbulence(2, TurbulenceSpectrum::von_karman).length.x / feet, 2500, 1e-9);
}

// MIL-F-8785C, figure 7: nodes, between them, and the ends; one model at all heights without steps.
TEST(Turbulence, IntensityByProbability) {
  const double feet = 0.3048;
  EXPECT_NEAR(environment::turbulence_intensity(7500 * feet, 1e-5) / feet, 23.6, 1e-9);
  EXPECT_NEAR(environment::turbulence_intensity(7500 * feet, 0.2) / feet, 0, 1e-4);
  EXPECT_NEAR(environment::turbulence_intensity(20000 * feet, 1e-3) / feet, 7.3, 1e-9);
  EXPECT_NEAR(environment::turbulence_intensity(15000 * feet, std::pow(10, -2.5)) / feet, 6.3, 1e-9);
  EXPECT_NEAR(environment::turbulence_intensity(0, 1e-9) / feet, 18.7, 1e-9);
  EXPECT_NEAR(environment::turbulence_intensity(1e6, 1e-6) / feet, 7.2, 1e-9);
  for (double h = 100; h < 3000; h += 1) {
    const auto a = environment::standard_turbulence(h * feet, 15, 1e-3, TurbulenceSpectrum::dryden);
    const auto b = environment::standard_turbulence((h + 1) * feet, 15, 1e-3, TurbulenceSpectrum::dryden);
    EXPECT_NEAR(b.length.z / a.length.z, 1, 0.011) << h;
    EXPECT_NEAR(b.intensity.x / a.intensity.x, 1, 0.011) << h;
  }
  EXPECT_NEAR(environment::standard_turbulence(5000, 15, 1e-3, TurbulenceSpectrum::dryden).length.x / feet, 1750, 1e-9);
}

// One-sided spectra add up to σ²; the tails fall with k⁻² and k^(−5/3), and the transverse ones are 2 and 4/3 as high.
TEST(Turbulence, AnalyticSpectra) {
  for (const auto kind : {TurbulenceSpectrum::dryden, TurbulenceSpectrum::von_karman}) {
    double u = 0, w = 0;
    for (double x = -14; x < 12; x += 1e-3) {
      const double k = std::exp(x) / 50;
      u += environment::longitudinal_spectrum(kind, 2, 50, k) * k * 1e-3;
      w += environment::transverse_spectrum(kind, 2, 50, k) * k * 1e-3;
    }
    EXPECT_NEAR(u, 4, 4e-3);
    EXPECT_NEAR(w, 4, 4e-3);
    const double k = 1e4;
    const double slope = std::log(environment::longitudinal_spectrum(kind, 1, 1, 2 * k) /
                                  environment::longitudinal_spectrum(kind, 1, 1, k)) /
                         std::log(2.0);
    EXPECT_NEAR(slope, kind == TurbulenceSpectrum::dryden ? -2 : -5.0 / 3, 1e-4);
    EXPECT_NEAR(environment::transverse_spectrum(kind, 1, 1, k) / environment::longitudinal_spectrum(kind, 1, 1, k),
                kind == TurbulenceSpectrum::dryden ? 1.5 : 4.0 / 3, 1e-3);
  }
}

Turbulence field_of(TurbulenceSpectrum kind, std::uint64_t seed, double length = 100, int shells = 24) {
  TurbulenceDef def;
  def.spectrum = kind;
  def.scales = {{1.5, 1.5, 1.5}, {length, length, length}};
  def.mean_wind = {20, 0, 0};
  def.shells = shells;
  def.seed = seed;
  return Turbulence::make(def).value();
}

// The variance over space is σ² of every component, mode by mode; every mode is free of divergence.
TEST(Turbulence, EveryComponentHasItsVariance) {
  const Turbulence field = field_of(TurbulenceSpectrum::von_karman, 3);
  Vec3d variance{}, mixed{};
  for (const Turbulence::Mode& m : field.modes()) {
    EXPECT_NEAR(math::dot(m.wave_number, m.cosine), 0, 1e-12 * math::length(m.wave_number));
    EXPECT_NEAR(math::dot(m.wave_number, m.sine), 0, 1e-12 * math::length(m.wave_number));
    variance +=
        0.5 * Vec3d{m.cosine.x * m.cosine.x + m.sine.x * m.sine.x, m.cosine.y * m.cosine.y + m.sine.y * m.sine.y,
                    m.cosine.z * m.cosine.z + m.sine.z * m.sine.z};
    mixed += 0.5 * Vec3d{m.cosine.x * m.cosine.y + m.sine.x * m.sine.y, m.cosine.y * m.cosine.z + m.sine.y * m.sine.z,
                         m.cosine.z * m.cosine.x + m.sine.z * m.sine.x};
  }
  EXPECT_LT(math::distance(variance, Vec3d{1, 1, 1}), 1e-12);
  EXPECT_LT(math::length(mixed), 1e-12) << "isotropic: components do not hang together";
}

// Power spectra of what a fixed anemometer records, over bands of an octave, beside MIL-F-8785C; the mean of 60 seeds.
TEST(Turbulence, RecordsHaveTheAnalyticSpectrum) {
  for (const auto kind : {TurbulenceSpectrum::dryden, TurbulenceSpectrum::von_karman}) {
    constexpr int seeds = 60;
    constexpr int bands = 6;
    double u[bands] = {}, w[bands] = {};
    // Octaves of wave number from .005 rad/m: L k = .5 … 32.
    const auto edge = [](int i) { return 0.005 * std::exp2(double(i)); };
    for (int seed = 1; seed <= seeds; ++seed) {
      const Turbulence field = field_of(kind, std::uint64_t(seed));
      // Along the mean wind a mode is a line at k·x̂ of the power it has in the component: the exact spectrum of the
      // infinite record. (The test below ties records to the modes.)
      for (const Turbulence::Mode& m : field.modes()) {
        const double k = std::abs(m.wave_number.x) / 100;
        for (int i = 0; i < bands; ++i)
          if (k >= edge(i) && k < edge(i + 1)) {
            u[i] += 0.5 * 2.25 * (m.cosine.x * m.cosine.x + m.sine.x * m.sine.x) / seeds;
            w[i] += 0.5 * 2.25 * (m.cosine.y * m.cosine.y + m.sine.y * m.sine.y) / seeds;
          }
      }
    }
    for (int i = 0; i < bands; ++i) {
      double want_u = 0, want_w = 0;
      for (int s = 0; s < 1000; ++s) {
        const double k = edge(i) + (edge(i + 1) - edge(i)) * (s + 0.5) / 1000, dk = (edge(i + 1) - edge(i)) / 1000;
        want_u += environment::longitudinal_spectrum(kind, 1.5, 100, k) * dk;
        want_w += environment::transverse_spectrum(kind, 1.5, 100, k) * dk;
      }
      EXPECT_NEAR(u[i] / want_u, 1, 0.15) << "octave " << i << " along";
      EXPECT_NEAR(w[i] / want_w, 1, 0.15) << "octave " << i << " up";
    }
  }
}

// A record in time at one place: mean, variance and correlation. Dryden: R_uu(r) = σ² e^(−r/L), r = U t.
TEST(Turbulence, RecordsInTime) {
  double correlation = 0, variance = 0, across = 0;
  constexpr int seeds = 24;
  for (int seed = 0; seed < seeds; ++seed) {
    const Turbulence field = field_of(TurbulenceSpectrum::dryden, std::uint64_t(100 + seed), 100, 12);
    double mean = 0;
    std::vector<Vec3d> record;
    for (int i = 0; i < 1200; ++i) {
      record.push_back(field.at({7, 50, -3}, i * 1.25));  // 25 m of wind a sample
      mean += record.back().x / 1200;
    }
    for (std::size_t i = 0; i + 4 < record.size(); ++i) {
      variance += record[i].x * record[i].x / (1196.0 * seeds);
      correlation += record[i].x * record[i + 4].x / (1196.0 * seeds);  // 100 m apart
      across += record[i].y * record[i + 4].y / (1196.0 * seeds);
    }
    EXPECT_LT(std::abs(mean), 0.6);
  }
  EXPECT_NEAR(variance / 2.25, 1, 0.06);
  EXPECT_NEAR(correlation / 2.25, std::exp(-1.0), 0.06);
  EXPECT_NEAR(across / 2.25, std::exp(-1.0) * 0.5, 0.06) << "transverse: e^(−r/L)(1 − r/2L)";
}

TEST(Turbulence, IsAFieldOfPlaceAndTime) {
  const Turbulence field = field_of(TurbulenceSpectrum::dryden, 9);
  // Frozen: it is carried along by the mean wind.
  EXPECT_LT(math::distance(field.at({40, 3, 8}, 2), field.at({0, 3, 8}, 0)), 1e-12);
  EXPECT_EQ(field.at({1, 2, 3}, 4), field_of(TurbulenceSpectrum::dryden, 9).at({1, 2, 3}, 4));
  EXPECT_NE(field.at({1, 2, 3}, 4), field_of(TurbulenceSpectrum::dryden, 10).at({1, 2, 3}, 4));
  EXPECT_EQ(Turbulence().at({1, 2, 3}, 4), Vec3d{});
  // No divergence, by differences.
  const double h = 1e-4;
  const Vec3d p{5, 60, -20};
  const double divergence =
      (field.at(p + Vec3d{h, 0, 0}, 1).x - field.at(p - Vec3d{h, 0, 0}, 1).x + field.at(p + Vec3d{0, h, 0}, 1).y -
       field.at(p - Vec3d{0, h, 0}, 1).y + field.at(p + Vec3d{0, 0, h}, 1).z - field.at(p - Vec3d{0, 0, h}, 1).z) /
      (2 * h);
  EXPECT_NEAR(divergence, 0, 1e-7);
  // The axes go with the mean wind: u along it, however it blows.
  TurbulenceDef def;
  def.scales = {{2, 1, 0.5}, {300, 300, 60}};
  def.mean_wind = {0, 0, 15};
  const Turbulence turned = Turbulence::make(def).value();
  Vec3d squares{};
  for (int i = 0; i < 4000; ++i) {
    const Vec3d v = turned.at({0, 30, 0}, 7.3 * i);
    squares += Vec3d{v.x * v.x, v.y * v.y, v.z * v.z} / 4000;
  }
  EXPECT_NEAR(std::sqrt(squares.z), 2, 0.35);
  EXPECT_NEAR(std::sqrt(squares.x), 1, 0.2);
  EXPECT_NEAR(std::sqrt(squares.y), 0.5, 0.1);
}

// Air that rises in the middle comes back down around it: no net flow through any level, and no divergence anywhere.
TEST(Thermal, MakesNoAir) {
  const Thermal thermal{.base = {10, 5, -20}, .strength = 4, .radius = 80, .depth = 900, .lean = {0.2, 0, -0.1}};
  EXPECT_NEAR(environment::thermal_at(thermal, thermal.base + Vec3d{0.2 * 300, 300, -0.1 * 300}).y, 4, 1e-12);
  double flow = 0, fastest = 0;
  for (double r = 0.5; r < 600; r += 1) {
    const double w = environment::thermal_at(thermal, thermal.base + Vec3d{0.2 * 450 + r, 450, -0.1 * 450}).y;
    flow += 2 * math::pi * r * w;
    fastest = std::max(fastest, w);
  }
  EXPECT_NEAR(flow / (math::pi * 80 * 80 * fastest), 0, 1e-3);
  const double h = 1e-3;
  for (const Vec3d p : {Vec3d{60, 200, -40}, Vec3d{100, 700, 10}, Vec3d{20, 30, -30}}) {
    const auto v = [&](double x, double y, double z) { return environment::thermal_at(thermal, p + Vec3d{x, y, z}); };
    const double divergence =
        (v(h, 0, 0).x - v(-h, 0, 0).x + v(0, h, 0).y - v(0, -h, 0).y + v(0, 0, h).z - v(0, 0, -h).z) / (2 * h);
    EXPECT_NEAR(divergence, 0, 1e-9);
  }
  EXPECT_EQ(environment::thermal_at(thermal, {10, 4, -20}), Vec3d{});
  EXPECT_EQ(environment::thermal_at(thermal, {10, 906, -20}), Vec3d{});
  // Allen 2006: w* 2.56 m/s, z_i 1401 m; at a third of the layer the radius is .102 ζ^⅓ (1 − ζ/4) z_i = 90.8 m.
  const Thermal day = environment::thermal_of_day({}, 2.56, 1401);
  EXPECT_NEAR(day.radius, 90.83, 0.05);
  EXPECT_NEAR(day.strength, 1.5 * 2.56 * std::cbrt(1.0 / 3) * (1 - 1.1 / 3), 1e-12);
}

// What the wind lost behind an obstacle is its drag: ∫ u (U − u) dA = ½ C_D A U².
TEST(Wake, LeeCarriesTheDrag) {
  const environment::Obstacle house{.center = {0, 10, 0}, .area = 120, .drag_coefficient = 1.1};
  for (const double x : {40.0, 100.0, 400.0}) {
    double lost = 0;
    for (double r = 0.05; r < 200; r += 0.1) {
      const double u = environment::lee_factor(house, {1, 0, 0}, {x, 10 + r, 0});
      lost += 2 * math::pi * r * 0.1 * u * (1 - u);
    }
    EXPECT_NEAR(lost / (0.5 * 1.1 * 120), 1, 0.01) << x;
  }
  EXPECT_EQ(environment::lee_factor(house, {1, 0, 0}, {-5, 10, 0}), 1) << "nothing in front of it";
  EXPECT_LT(environment::lee_factor(house, {1, 0, 0}, {20, 10, 0}),
            environment::lee_factor(house, {1, 0, 0}, {90, 10, 0}));
}

// Down between the cores, up outside; the pair sinks at Γ/(2π b₀).
TEST(Wake, VortexPair) {
  const environment::WakeVortexPair pair{
      .point = {0, 200, 0}, .circulation = 400, .spacing = 40, .core_radius = 2, .decay_time = 1e6};
  EXPECT_NEAR(environment::wake_vortices_at(pair, {0, 200, 0}, 0).y, -2 * 400 / (2 * math::pi * 20) * 400 / 404, 1e-9);
  EXPECT_GT(environment::wake_vortices_at(pair, {50, 200, 60}, 0).y, 0);
  const double sink = 400 / (2 * math::pi * 40);
  EXPECT_NEAR(environment::wake_vortices_at(pair, {0, 200 - sink, 0}, 1).y,
              environment::wake_vortices_at(pair, {0, 200, 0}, 0).y, 0.05);
}

TEST(WindField, AddsItsParts) {
  WindField field;
  EXPECT_TRUE(field.calm());
  EXPECT_EQ(field.at({1, 2, 3}, 4), Vec3d{});
  field.mean = {.velocity = {8, 0, 0}, .profile = environment::WindProfile::power};
  EXPECT_NEAR(field.at({0, 30, 0}, 0, 20).x, 8, 1e-12) << "ten metres over ground at 20 m";
  field.layers = {{0, {2, 0, 0}}, {100, {6, 0, 4}}, {500, {0, 0, 8}}};
  EXPECT_LT(math::distance(field.at({0, 50, 0}, 0), Vec3d{4, 0, 2}), 1e-12);
  EXPECT_LT(math::distance(field.at({0, 300, 0}, 0), Vec3d{3, 0, 6}), 1e-12);
  EXPECT_LT(math::distance(field.at({0, 900, 0}, 0), Vec3d{0, 0, 8}), 1e-12);
  field.thermals.push_back({.base = {0, 0, 0}, .strength = 5});
  EXPECT_NEAR(field.at({0, 1000.0 / 3, 0}, 0).y, 5, 1e-9);
  field.obstacles.push_back({.center = {0, 50, 0}, .area = 100});
  EXPECT_LT(field.at({40, 50, 20}, 0).x, 4);
}

TEST(WindField, RefusesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const WindField& field) {
    const core::Status s = environment::validate(field);
    return s.ok() ? std::string("accepted") : s.error().message;
  };
  WindField field;
  EXPECT_EQ(message(field), "accepted");
  field.gusts.push_back({.velocity = {1, 0, 0}, .direction = {2, 0, 0}});
  EXPECT_EQ(message(field), "wind: gusts[0].direction is 2, expected a length of 1");
  field.gusts.clear();
  field.thermals.push_back({.radius = -1});
  EXPECT_NE(message(field).find("thermals[0].radius is -1"), std::string::npos);
  field.thermals.clear();
  field.layers = {{10, {}}, {5, {}}};
  EXPECT_NE(message(field).find("layers[1].height is 5"), std::string::npos);
  field.layers.clear();
  field.mean.velocity.y = nan;
  EXPECT_NE(message(field).find("velocity"), std::string::npos);
  TurbulenceDef def;
  def.scales.length.y = 0;
  EXPECT_EQ(Turbulence::make(def).error().message, "Turbulence::make: length.v is 0, expected more than 0 m");
  def = {};
  def.shells = 100;
  EXPECT_NE(Turbulence::make(def).error().message.find("shells is 100"), std::string::npos);
}

// One object is asked for everything.
TEST(Environment, AnswersForAll) {
  environment::Environment::Definition d;
  d.gravity.kind = environment::GravityField::Kind::uniform;
  d.air.temperature = 10;
  d.altitude = 1000;
  d.wind.mean.velocity = {3, 0, 0};
  d.water = environment::Sea();
  d.terrain = [](double x, double) { return 0.1 * x; };
  const environment::Environment here = environment::Environment::make(d).value();
  EXPECT_EQ(here.gravity({5, 5, 5}), (Vec3d{0, -environment::standard_gravity, 0}));
  const environment::AirState air = here.air({0, 500, 0}),
                              same = environment::standard_atmosphere(1500, {.temperature = 10});
  EXPECT_EQ(air.density, same.density);
  EXPECT_NEAR(here.thin_air({0, 500, 0}).density, same.density, 1e-5);
  EXPECT_EQ(here.wind({0, 50, 0}, 0), (Vec3d{3, 0, 0}));
  EXPECT_EQ(here.ground(20, 7), 2);
  ASSERT_NE(here.water(), nullptr);
  EXPECT_EQ(here.water()->height(1, 2, 3), 0);
  d.vacuum = true;
  EXPECT_EQ(environment::Environment::make(d).value().air({}).density, 0);
  EXPECT_EQ(environment::Environment::make(d).value().thin_air({}).density, 0);
  EXPECT_EQ(environment::Environment().wind({1, 2, 3}, 0), Vec3d{});
  d.air.relative_humidity = 2;
  EXPECT_EQ(environment::Environment::make(d).error().message,
            "Environment::make: air.relative_humidity is 2, expected 0 … 1");
}

Turbulence eddies(TurbulenceSpectrum spectrum, Vec3d length) {
  return Turbulence::make({.spectrum = spectrum,
                           .scales = {.intensity = {2, 1.5, 1}, .length = length},
                           .mean_wind = {6, 0, 2},
                           .seed = 5})
      .value();
}

TEST(WindPatch, EddiesAtItsNodesAreTheField) {
  for (const Vec3d length : {Vec3d{60, 60, 60}, Vec3d{60, 40, 20}}) {
    const Turbulence field = eddies(TurbulenceSpectrum::von_karman, length);
    const environment::WindGrid grid{.corner = {-70, 3, 1e4}, .spacing = 1.5, .columns = 33, .layers = 9, .rows = 4};
    std::vector<math::Vec3f> nodes(std::size_t(grid.size()));
    field.add_at(grid, 1234.5, nodes);
    std::size_t node = 0;
    for (int row = 0; row < grid.rows; ++row)
      for (int layer = 0; layer < grid.layers; ++layer)
        for (int column = 0; column < grid.columns; ++column, ++node)
          EXPECT_LT(math::length(Vec3d(nodes[node]) -
                                 field.at(grid.corner + grid.spacing * Vec3d(column, layer, row), 1234.5)),
                    2e-5);
  }
}

// With 8192 nodes in a box of 100 m by 50, a fortieth of a gust; a quarter of eddies that are a hundred and fifty
// metres long and down to a hundredth of that, for what is smaller than a cell is somewhere else; a tenth with 64 times
// as many.
TEST(WindPatch, IsAsGoodAsItsSpacing) {
  WindField field{.mean = {.velocity = {8, 0, 0}, .profile = environment::WindProfile::power},
                  .gusts = {{.velocity = {5, 1, 0}, .front = -20, .gradient_distance = 20, .speed = 8}},
                  .thermals = {{.base = {10, 0, 10}, .strength = 2, .radius = 30, .depth = 200}},
                  .obstacles = {{.center = {-30, 5, 0}, .area = 80}}};
  math::Random random(3);
  const auto error = [&](int nodes, double& spacing) {
    environment::WindPatch patch;
    patch.set(field, {-50, 0, -50}, {50, 50, 50}, 4, 0, nodes);
    EXPECT_LE(patch.grid().size(), nodes);
    spacing = patch.grid().spacing;
    double squares = 0;
    constexpr int places = 2000;
    for (int i = 0; i < places; ++i) {
      const Vec3d p{random.uniform(-50.0, 50.0), random.uniform(0.1, 50.0), random.uniform(-50.0, 50.0)};
      squares += math::length_squared(field.mean_at(p.y) + patch.at(p) - field.at(p, 4)) / places;
    }
    return std::sqrt(squares);
  };
  double coarse_spacing = 0, fine_spacing = 0;
  const double coarse = error(1 << 13, coarse_spacing), fine = error(1 << 19, fine_spacing);
  EXPECT_LT(coarse, 0.15) << "of gusts of 5 m/s, at " << coarse_spacing << " m";
  EXPECT_LT(fine, coarse * fine_spacing / coarse_spacing * 1.3);

  field = {.turbulence = Turbulence::make({.scales = {.length = {150, 150, 150}}}).value()};
  const double eddies_coarse = error(1 << 13, coarse_spacing), eddies_fine = error(1 << 19, fine_spacing);
  EXPECT_LT(eddies_coarse, 0.3 * std::sqrt(3.0)) << "of 1 m/s in each component, at " << coarse_spacing << " m";
  EXPECT_LT(eddies_fine, 0.12 * std::sqrt(3.0)) << "at " << fine_spacing << " m";
  environment::WindPatch calm;
  calm.set({.mean = {.velocity = {8, 0, 0}}}, {}, {1, 1, 1}, 0);
  EXPECT_TRUE(calm.nodes().empty());
  EXPECT_EQ(calm.at({3, 4, 5}), Vec3d{});
}

}  // namespace wind_field_test
