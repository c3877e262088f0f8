#include "carom/environment/wave_spectrum.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::environment {
namespace {

constexpr double two_pi = 2 * math::pi;

/// S without its scale, over x = ω/ω_p.
double shape(double x, double gamma) {
  if (!(x > 0.05)) return 0;
  const double x4 = x * x * x * x, sigma = x <= 1 ? 0.07 : 0.09;
  const double base = math::exp(-1.25 / x4) / (x4 * x);
  if (gamma == 1) return base;
  const double d = (x - 1) / sigma;
  return base * math::exp(math::log(gamma) * math::exp(-0.5 * d * d));
}

/// ∫ xⁿ shape dx over a band, by Simpson's rule.
double band_moment(double from, double to, double gamma, int n, int steps) {
  const double h = (to - from) / (2 * steps);
  const auto value = [&](int i) {
    const double x = from + h * i;
    const double power = n == 0 ? 1 : n == 1 ? x : n == 2 ? x * x : 1 / x;
    return power * shape(x, gamma);
  };
  double sum = value(0) + value(2 * steps);
  for (int i = 1; i < 2 * steps; ++i) sum += (i % 2 == 1 ? 4 : 2) * value(i);
  return sum * h / 3;
}

/// ∫₀^∞ xⁿ shape dx: the peak, the flanks, and beyond x = 4 the tail term by term, exp(−1.25 x⁻⁴) = 1 − 1.25 x⁻⁴ + …
double whole_moment(double gamma, int n) {
  double sum = band_moment(0.2, 0.7, gamma, n, 60) + band_moment(0.7, 1, gamma, n, 100) +
               band_moment(1, 1.5, gamma, n, 120) + band_moment(1.5, 4, gamma, n, 120);
  const double start = math::pow(4.0, n - 4.0);
  constexpr double step = 1.25 / 256;
  sum += start * (1.0 / (4 - n) - step / (8 - n) + 0.5 * step * step / (12 - n));
  return sum;
}

/// ln Γ(x), x ≥ .5: Stirling's series after shifting to x ≥ 9 (error < 1e-13).
double log_gamma(double x) {
  double shift = 0;
  while (x < 9) shift += math::log(x), x += 1;
  const double r = 1 / x, r2 = r * r;
  return (x - 0.5) * math::log(x) - x + 0.91893853320467274178 +
         r * (1.0 / 12 - r2 * (1.0 / 360 - r2 * (1.0 / 1260 - r2 * (1.0 / 1680 - r2 / 1188)))) - shift;
}

/// The angle below which the share `q` of the spread lies.
double spread_quantile(double s, double q) {
  constexpr int steps = 720;
  double sum = 0, before = spread_density(s, -math::pi);
  for (int i = 1; i <= steps; ++i) {
    const double angle = -math::pi + two_pi * i / steps, here = spread_density(s, angle);
    const double slice = 0.5 * (before + here) * two_pi / steps;
    if (sum + slice >= q) return angle - two_pi / steps * (1 - (q - sum) / slice);
    sum += slice;
    before = here;
  }
  return math::pi;
}

}  // namespace

double wave_number(double frequency, double depth, double gravity) {
  if (!(frequency > 0)) return 0;
  const double deep = frequency * frequency / gravity, y = deep * depth;
  if (y > 20) return deep;
  // x = k h of x tanh x = y. Start: Eckart 1952, within 5 %.
  double x = y / math::sqrt(math::tanh(y));
  for (int i = 0; i < 8; ++i) {
    const double t = math::tanh(x), next = x - (x * t - y) / (t + x * (1 - t * t));
    const bool settled = math::abs(next - x) <= 1e-16 * x;
    x = next;
    if (settled) break;
  }
  return x / depth;
}

double wave_frequency_at_depth(double k, double depth, double gravity) {
  return math::sqrt(gravity * k * math::tanh(math::min(k * depth, 30.0)));
}

WaveSpectrum fully_grown_sea(double wind, double gravity) {
  // m₀ = α U⁴/(4 β g²), ω_p = (4β/5)^¼ g/U.
  const double height = 2 * math::sqrt(0.0081 / 0.74) * wind * wind / gravity;
  const double peak = math::sqrt(math::sqrt(0.8 * 0.74)) * gravity / wind;
  return {height, two_pi / peak, 1};
}

WaveSpectrum fetch_limited_sea(double wind, double fetch, double gamma, double gravity) {
  const double alpha = 0.076 * math::pow(wind * wind / (fetch * gravity), 0.22);
  const double peak = 22 * math::cbrt(gravity * gravity / (wind * fetch));
  const double m0 = alpha * gravity * gravity / (peak * peak * peak * peak) * whole_moment(gamma, 0);
  return {4 * math::sqrt(m0), two_pi / peak, gamma};
}

WaveSpectrum sea_state(int code) {
  constexpr double bounds[11] = {0, 0, 0.1, 0.5, 1.25, 2.5, 4, 6, 9, 14, 20};
  const int i = math::clamp(code, 0, 9);
  const double height = 0.5 * (bounds[i] + bounds[i + 1]);
  // Of a fully grown sea T_p ∝ √H_s.
  const WaveSpectrum unit = fully_grown_sea(10);
  const double period = unit.peak_period * math::sqrt(math::max(height, 1e-4) / unit.significant_height);
  return {height, period, 1};
}

double spectral_density(const WaveSpectrum& s, double frequency) {
  const double peak = two_pi / s.peak_period;
  const double m0 = s.significant_height * s.significant_height / 16;
  return m0 / (peak * whole_moment(s.peak_enhancement, 0)) * shape(frequency / peak, s.peak_enhancement);
}

double spectral_moment(const WaveSpectrum& s, int n) {
  const double peak = two_pi / s.peak_period, m0 = s.significant_height * s.significant_height / 16;
  const double power = n == 0 ? 1 : n == 1 ? peak : n == 2 ? peak * peak : 1 / peak;
  return m0 * power * whole_moment(s.peak_enhancement, n) / whole_moment(s.peak_enhancement, 0);
}

double spread_density(double s, double angle) {
  const double half = math::cos(0.5 * math::clamp(angle, -math::pi, math::pi));
  const double scale = math::exp(log_gamma(s + 1) - log_gamma(s + 0.5)) / (2 * math::sqrt(math::pi));
  return half > 0 ? scale * math::pow(half, 2 * s) : (s > 0 ? 0 : scale);
}

core::Result<std::vector<WaveComponent>> wave_components(const SeaDef& sea) {
  const auto refuse = [](const char* field, double found, const char* expected) {
    return core::Error{core::text("wave_components: ", field, " is ", found, ", expected ", expected)};
  };
  const WaveSpectrum& s = sea.spectrum;
  if (!(s.significant_height >= 0) || !math::is_finite(s.significant_height))
    return refuse("significant_height", s.significant_height, "0 m or more");
  if (!(s.peak_period > 0) || !math::is_finite(s.peak_period))
    return refuse("peak_period", s.peak_period, "more than 0 s");
  if (!(s.peak_enhancement >= 1) || !(s.peak_enhancement <= 10))
    return refuse("peak_enhancement", s.peak_enhancement, "1 … 10");
  if (!math::is_finite(sea.direction)) return refuse("direction", sea.direction, "a finite angle");
  if (!(sea.spread <= 1000)) return refuse("spread", sea.spread, "at most 1000");
  if (sea.components < 1 || sea.components > 256) return refuse("components", sea.components, "1 … 256");
  if (!(sea.depth > 0)) return refuse("depth", sea.depth, "more than 0 m");
  if (!(sea.gravity > 0) || !math::is_finite(sea.gravity)) return refuse("gravity", sea.gravity, "more than 0 m/s²");

  // Bands between quantiles of half energy, half frequency: fine at the peak and still some short waves.
  constexpr double low = 0.6, high = 4;
  constexpr int cells = 680;
  const double gamma = s.peak_enhancement, whole = band_moment(low, high, gamma, 0, 2 * cells);
  std::vector<double> edges{low};
  double sum = 0;
  for (int i = 0, next = 1; i < cells && next < sea.components; ++i) {
    const double x0 = low + (high - low) * i / cells, x1 = low + (high - low) * (i + 1) / cells;
    const double slice = 0.5 * band_moment(x0, x1, gamma, 0, 2) / whole + 0.5 / cells;
    for (double target = double(next) / sea.components; next < sea.components && sum + slice >= target;
         target = double(++next) / sea.components)
      edges.push_back(x0 + (x1 - x0) * (target - sum) / slice);
    sum += slice;
  }
  while (int(edges.size()) < sea.components) edges.push_back(high);
  edges.push_back(high);

  math::Random random(sea.seed, 0x5EA);
  std::vector<std::uint32_t> order(std::size_t(sea.components));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::uint32_t(i);
  random.shuffle(order.data(), std::uint32_t(order.size()));
  const double peak = two_pi / s.peak_period;
  std::vector<WaveComponent> out;
  double energy = 0;
  for (int i = 0; i < sea.components; ++i) {
    const double x0 = edges[std::size_t(i)], x1 = edges[std::size_t(i) + 1];
    WaveComponent wave;
    const double share = band_moment(x0, x1, gamma, 0, 8);
    energy += share;
    wave.amplitude = math::sqrt(share);
    wave.frequency = peak * random.uniform(x0, x1);
    wave.wave_number = wave_number(wave.frequency, sea.depth, sea.gravity);
    double angle = sea.direction;
    const double q = (order[std::size_t(i)] + random.uniform()) / sea.components;
    if (sea.spread > 0) angle += spread_quantile(sea.spread, q);
    const math::SinCos<double> heading = math::sincos(angle);
    wave.direction_x = heading.cos;
    wave.direction_z = heading.sin;
    wave.phase = random.uniform(0.0, two_pi);
    out.push_back(wave);
  }
  const double scale = energy > 0 ? s.significant_height / math::sqrt(8 * energy) : 0;  // Σ a²/2 = H_s²/16
  for (WaveComponent& wave : out) wave.amplitude *= scale;
  return out;
}

WaveComponent regular_wave(double height, double period, double direction, double depth, double gravity, double phase) {
  const math::SinCos<double> heading = math::sincos(direction);
  const double frequency = two_pi / period;
  return {0.5 * height, wave_number(frequency, depth, gravity), frequency, heading.cos, heading.sin, phase};
}

}  // namespace carom::environment
