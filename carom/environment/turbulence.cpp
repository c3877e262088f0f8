#include "carom/environment/turbulence.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::environment {
using math::Vec3d;
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
  return field;
}

Vec3d Turbulence::at(Vec3d point, double time) const {
  if (modes_.empty()) return {};
  const Vec3d moved = point - definition_.mean_wind * time;
  const Vec3d local{math::dot(moved, along_), moved.y, math::dot(moved, across_)};
  const TurbulenceScales& s = definition_.scales;
  // Each component is a component of the unit field with its own length: one pass for each length that differs.
  Vec3d sum{};
  const double lengths[3] = {s.length.x, s.length.z, s.length.y};  // of u, w (up), v
  bool done[3] = {};
  for (int i = 0; i < 3; ++i) {
    if (done[i]) continue;
    const Vec3d x = local / lengths[i];
    Vec3d pass{};
    for (const Mode& mode : modes_) {
      const math::SinCos<double> turn = math::sincos(math::dot(mode.wave_number, x));
      pass += turn.cos * mode.cosine + turn.sin * mode.sine;
    }
    for (int j = i; j < 3; ++j)
      if (lengths[j] == lengths[i]) {
        sum[j] = pass[j];
        done[j] = true;
      }
  }
  return along_ * (s.intensity.x * sum.x) + Vec3d{0, s.intensity.z * sum.y, 0} + across_ * (s.intensity.y * sum.z);
}

}  // namespace carom::environment
