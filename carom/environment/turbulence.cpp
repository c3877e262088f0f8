#include "carom/environment/turbulence.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/math/simd.h"

namespace carom::environment {
using math::Vec3d;
using math::Vec3f;
namespace {

constexpr double feet = 0.3048, von_karman_scale = 1.339;

/// E(k) of the isotropic field with σ = 1 and L = 1, ∫ E dk = 3/2: the spectrum in space whose section along a line is
/// the one-dimensional spectrum. Batchelor, The Theory of Homogeneous Turbulence (1953), eq. 3.4.18 and on.
double energy(TurbulenceSpectrum spectrum, double k) {
  if (spectrum == TurbulenceSpectrum::dryden) {
    const double q = 1 + k * k;
    return 8 / math::pi * k * k * k * k / (q * q * q);
  }
  const double x = von_karman_scale * k;
  return 55 / (9 * math::pi) * x * x * x * x * math::pow(1 + x * x, -17.0 / 6);
}

/// ∫ E dk over a shell, by Simpson's rule in ln k.
double shell_energy(TurbulenceSpectrum spectrum, double from, double to) {
  constexpr int steps = 8;
  const double h = math::log(to / from) / (2 * steps);
  double sum = 0;
  for (int i = 0; i <= 2 * steps; ++i) {
    const double k = from * math::exp(h * i);
    const double weight = i == 0 || i == 2 * steps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * k * energy(spectrum, k);
  }
  return sum * h / 3;
}

}  // namespace

TurbulenceScales low_altitude_turbulence(double height, double wind_at_20_feet) {
  const double h = math::clamp(height / feet, 10.0, 1000.0);
  const double q = 0.177 + 0.000823 * h, up = 0.1 * wind_at_20_feet;
  const double flat = up / math::pow(q, 0.4), length = h * feet / math::pow(q, 1.2);
  return {{flat, flat, up}, {length, length, h * feet}};
}

TurbulenceScales high_altitude_turbulence(double intensity, TurbulenceSpectrum spectrum) {
  const double length = (spectrum == TurbulenceSpectrum::dryden ? 1750 : 2500) * feet;
  return {{intensity, intensity, intensity}, {length, length, length}};
}

double turbulence_intensity(double altitude, double exceedance) {
  // Figure 7 of MIL-F-8785C: ft/s at altitudes in ft, for probabilities of .2 and 10⁻¹ … 10⁻⁶.
  constexpr int rows = 12, columns = 7;
  constexpr double heights[rows] = {500, 1750, 3750, 7500, 15000, 25000, 35000, 45000, 55000, 65000, 75000, 80000};
  constexpr double exponents[columns] = {0.69897, 1, 2, 3, 4, 5, 6};  // −log₁₀ of the probability
  constexpr double table[rows][columns] = {{3.2, 4.2, 6.6, 8.6, 11.8, 15.6, 18.7},
                                           {2.2, 3.6, 6.9, 9.6, 13.0, 17.6, 21.5},
                                           {1.5, 3.3, 7.4, 10.6, 16.0, 23.0, 28.4},
                                           {0, 1.6, 6.7, 10.1, 15.1, 23.6, 30.2},
                                           {0, 0, 4.6, 8.0, 11.6, 22.1, 30.7},
                                           {0, 0, 2.7, 6.6, 9.7, 20.0, 31.0},
                                           {0, 0, 0.4, 5.0, 8.1, 16.0, 25.2},
                                           {0, 0, 0, 4.2, 8.2, 15.1, 23.1},
                                           {0, 0, 0, 2.7, 7.9, 12.1, 17.5},
                                           {0, 0, 0, 0, 4.9, 7.9, 10.7},
                                           {0, 0, 0, 0, 3.2, 6.2, 8.4},
                                           {0, 0, 0, 0, 2.1, 5.1, 7.2}};
  const double h = math::clamp(altitude / feet, heights[0], heights[rows - 1]);
  const double p = math::clamp(-math::log10(math::clamp(exceedance, 1e-6, 1.0)), exponents[0], exponents[columns - 1]);
  int row = 0, column = 0;
  while (row + 2 < rows && h >= heights[row + 1]) ++row;
  while (column + 2 < columns && p >= exponents[column + 1]) ++column;
  const double t = (h - heights[row]) / (heights[row + 1] - heights[row]);
  const double u = (p - exponents[column]) / (exponents[column + 1] - exponents[column]);
  const auto at = [&](int r) { return table[r][column] + u * (table[r][column + 1] - table[r][column]); };
  return feet * (at(row) + t * (at(row + 1) - at(row)));
}

TurbulenceScales standard_turbulence(double height, double wind_at_20_feet, double exceedance,
                                     TurbulenceSpectrum spectrum) {
  constexpr double low = 1000 * feet, high = 2000 * feet;
  const TurbulenceScales below = low_altitude_turbulence(math::min(height, low), wind_at_20_feet);
  if (height <= low) return below;
  const TurbulenceScales above =
      high_altitude_turbulence(turbulence_intensity(math::max(height, high), exceedance), spectrum);
  const double t = math::min((height - low) / (high - low), 1.0);
  return {below.intensity + t * (above.intensity - below.intensity), below.length + t * (above.length - below.length)};
}

double longitudinal_spectrum(TurbulenceSpectrum spectrum, double sigma, double length, double k) {
  const double scale = 2 * sigma * sigma * length / math::pi;
  if (spectrum == TurbulenceSpectrum::dryden) return scale / (1 + math::square(length * k));
  return scale * math::pow(1 + math::square(von_karman_scale * length * k), -5.0 / 6);
}

double transverse_spectrum(TurbulenceSpectrum spectrum, double sigma, double length, double k) {
  const double scale = sigma * sigma * length / math::pi;
  if (spectrum == TurbulenceSpectrum::dryden) {
    const double q = math::square(length * k);
    return scale * (1 + 3 * q) / ((1 + q) * (1 + q));
  }
  const double q = math::square(von_karman_scale * length * k);
  return scale * (1 + 8.0 / 3 * q) * math::pow(1 + q, -11.0 / 6);
}

core::Result<Turbulence> Turbulence::make(const TurbulenceDef& def) {
  const auto refuse = [](const char* field, double found, const char* expected) {
    return core::Error{core::text("Turbulence::make: ", field, " is ", found, ", expected ", expected)};
  };
  constexpr const char* intensities[3] = {"intensity.u", "intensity.v", "intensity.w"};
  constexpr const char* lengths[3] = {"length.u", "length.v", "length.w"};
  for (int i = 0; i < 3; ++i) {
    const double sigma = def.scales.intensity[i], length = def.scales.length[i];
    if (!(sigma >= 0) || !math::is_finite(sigma)) return refuse(intensities[i], sigma, "0 m/s or more");
    if (!(length > 0) || !math::is_finite(length)) return refuse(lengths[i], length, "more than 0 m");
  }
  if (!math::is_finite(def.mean_wind)) return refuse("mean_wind", def.mean_wind.x, "a finite velocity");
  if (!(def.smallest >= 0) || !math::is_finite(def.smallest)) return refuse("smallest", def.smallest, "0 m or more");
  if (def.shells < 4 || def.shells > 64) return refuse("shells", def.shells, "4 … 64");

  Turbulence field;
  field.definition_ = def;
  const Vec3d flat{def.mean_wind.x, 0, def.mean_wind.z};
  if (math::length(flat) > 1e-9) field.along_ = math::normalize(flat);
  field.across_ = math::cross(field.along_, Vec3d{0, 1, 0});

  const double largest_length = math::max(def.scales.length.x, math::max(def.scales.length.y, def.scales.length.z));
  const double low = 0.1, high = def.smallest > 0 ? math::max(2.0, 2 * math::pi * largest_length / def.smallest) : 600;
  math::Random random(def.seed, 0xA1B);
  const double golden = 0.5 * (1 + math::sqrt(5.0));
  const Vec3d axes[6] = {{0, 1, golden},  {0, 1, -golden}, {1, golden, 0},
                         {1, -golden, 0}, {golden, 0, 1},  {-golden, 0, 1}};
  double total = 0;
  std::vector<double> share;
  for (int shell = 0; shell < def.shells; ++shell) {
    share.push_back(shell_energy(def.spectrum, low * math::pow(high / low, double(shell) / def.shells),
                                 low * math::pow(high / low, double(shell + 1) / def.shells)));
    total += share.back();
  }
  for (int shell = 0; shell < def.shells; ++shell) {
    const math::Quatd turn = random.rotation();
    // Each of six directions carries 1/6 of the shell's share of σ_u² + σ_v² + σ_w² = 3, a²/2 in each polarisation.
    const double amplitude = math::sqrt(3 * share[std::size_t(shell)] / total / 6);
    for (const Vec3d& axis : axes) {
      const double k = low * math::pow(high / low, (shell + random.uniform()) / def.shells);
      const Vec3d n = math::rotate(turn, math::normalize(axis));
      const Vec3d p = math::normalize(math::cross(n, math::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
      const Vec3d q = math::cross(n, p);
      // Both polarisations a quarter turn apart, so that the components do not hang together; either hand.
      const math::SinCos<double> start = math::sincos(random.uniform(0.0, 2 * math::pi));
      const double hand = random.chance(0.5) ? 1 : -1;
      field.modes_.push_back({k * n, amplitude * (start.cos * p + (hand * start.sin) * q),
                              amplitude * ((hand * start.cos) * q - start.sin * p)});
    }
  }
  // Each component is a component of the unit field with its own length.
  const Vec3d axes_of[3] = {field.along_, {0, 1, 0}, field.across_};
  const double sigma[3] = {def.scales.intensity.x, def.scales.intensity.z, def.scales.intensity.y};
  const double length[3] = {def.scales.length.x, def.scales.length.z, def.scales.length.y};  // of u, w (up), v
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && (length[i] == length[0] || length[i] == length[i - 1])) continue;
    for (const Mode& mode : field.modes_) {
      Mode wave;
      for (int j = 0; j < 3; ++j) {
        wave.wave_number += axes_of[j] * (mode.wave_number[j] / length[i]);
        if (length[j] != length[i]) continue;
        wave.cosine += axes_of[j] * (sigma[j] * mode.cosine[j]);
        wave.sine += axes_of[j] * (sigma[j] * mode.sine[j]);
      }
      field.waves_.push_back(wave);
    }
  }
  return field;
}

Vec3d Turbulence::at(Vec3d point, double time) const {
  const Vec3d moved = point - definition_.mean_wind * time;
  Vec3d sum{};
  for (const Mode& wave : waves_) {
    const math::SinCos<double> turn = math::sincos(math::dot(wave.wave_number, moved));
    sum += turn.cos * wave.cosine + turn.sin * wave.sine;
  }
  return sum;
}

void Turbulence::add_at(const WindGrid& grid, double time, std::span<Vec3f> out) const {
  using F = math::WideFloat<4>;
  constexpr int most = 64;  // waves at a time
  const Vec3d corner = grid.corner - definition_.mean_wind * time;
  for (std::size_t first = 0; first < waves_.size(); first += most) {
    const int count = int(math::min(waves_.size() - first, std::size_t(most)));
    alignas(16) float cosine[3][most] = {}, sine[3][most] = {}, turn_cos[most] = {}, turn_sin[most] = {};
    math::SinCos<double> up[most], at[most];
    for (int i = 0; i < count; ++i) {
      const Mode& wave = waves_[first + std::size_t(i)];
      for (int k = 0; k < 3; ++k) {
        cosine[k][i] = float(wave.cosine[k]);
        sine[k][i] = float(wave.sine[k]);
      }
      const math::SinCos<double> turn = math::sincos(wave.wave_number.x * grid.spacing);
      turn_cos[i] = float(turn.cos);
      turn_sin[i] = float(turn.sin);
      up[i] = math::sincos(wave.wave_number.y * grid.spacing);
    }
    std::size_t node = 0;
    for (int row = 0; row < grid.rows; ++row) {
      for (int i = 0; i < count; ++i)
        at[i] = math::sincos(
            math::dot(waves_[first + std::size_t(i)].wave_number, corner + Vec3d{0, 0, row * grid.spacing}));
      for (int layer = 0; layer < grid.layers; ++layer) {
        alignas(16) float c[most] = {}, s[most] = {};
        for (int i = 0; i < count; ++i) {
          c[i] = float(at[i].cos);
          s[i] = float(at[i].sin);
          at[i] = {at[i].cos * up[i].sin + at[i].sin * up[i].cos, at[i].cos * up[i].cos - at[i].sin * up[i].sin};
        }
        for (int column = 0; column < grid.columns; ++column, ++node) {
          F sum[3] = {F::zero(), F::zero(), F::zero()};
          for (int i = 0; i < count; i += 4) {
            const F ci = F::load(c + i), si = F::load(s + i), tc = F::load(turn_cos + i), ts = F::load(turn_sin + i);
            for (int k = 0; k < 3; ++k) sum[k] = sum[k] + (ci * F::load(cosine[k] + i) + si * F::load(sine[k] + i));
            (ci * tc - si * ts).store(c + i);
            (ci * ts + si * tc).store(s + i);
          }
          for (int k = 0; k < 3; ++k) out[node][k] += (sum[k][0] + sum[k][1]) + (sum[k][2] + sum[k][3]);
        }
      }
    }
  }
}

}  // namespace carom::environment
