#include "carom/environment/sea.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::environment {
using math::Vec3d;
namespace {

constexpr std::size_t max_components = 256;

/// How the motion falls off with depth: cosh k(y+h)/sinh kh, sinh k(y+h)/sinh kh, cosh k(y+h)/cosh kh, without
/// overflow.
struct Decay {
  double along, up, pressure;
};
Decay decay(double k, double y, double depth) {
  const double e = math::exp(k * y);
  if (k * depth > 20) return {e, e, e};
  const double bottom = math::exp(-2 * k * depth), mirrored = math::exp(-2 * k * (y + depth));
  return {e * (1 + mirrored) / (1 - bottom), e * (1 - mirrored) / (1 - bottom), e * (1 + mirrored) / (1 + bottom)};
}

core::Error refuse(std::string_view field, double found, const char* expected) {
  return core::Error{core::text("Sea::make: ", field, " is ", found, ", expected ", expected)};
}

}  // namespace

core::Result<Sea> Sea::make(const WaterBody& water, std::span<const WaveComponent> components) {
  if (!math::is_finite(water.level)) return refuse("level", water.level, "a finite height");
  if (!(water.depth > 0)) return refuse("depth", water.depth, "more than 0 m");
  if (!(water.density >= 0) || !math::is_finite(water.density))
    return refuse("density", water.density, "0 kg/m³ or more");
  if (!(water.gravity > 0) || !math::is_finite(water.gravity))
    return refuse("gravity", water.gravity, "more than 0 m/s²");
  if (!math::is_finite(water.current)) return refuse("current", water.current.x, "a finite velocity");
  if (components.size() > max_components)
    return refuse("the number of components", double(components.size()), "at most 256");
  Sea sea;
  sea.water_ = water;
  double energy = 0, weighted = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const WaveComponent& w = components[i];
    const auto name = [&](const char* field) { return core::text("components[", i, "].", field); };
    if (!math::is_finite(w.amplitude)) return refuse(name("amplitude"), w.amplitude, "a finite height");
    if (!(w.wave_number > 0) || !math::is_finite(w.wave_number))
      return refuse(name("wave_number"), w.wave_number, "more than 0 rad/m");
    if (!math::is_finite(w.frequency)) return refuse(name("frequency"), w.frequency, "a finite frequency");
    if (!math::is_finite(w.phase)) return refuse(name("phase"), w.phase, "a finite angle");
    const double length = math::hypot(w.direction_x, w.direction_z);
    if (!(math::abs(length - 1) < 1e-6)) return refuse(name("direction"), length, "a length of 1");
    sea.components_.push_back(w);
    energy += w.amplitude * w.amplitude;
    weighted += w.amplitude * w.amplitude * w.wave_number * w.wave_number;
  }
  sea.mean_wave_number_ = energy > 0 ? math::sqrt(weighted / energy) : 0;
  return sea;
}

core::Result<Sea> Sea::make(const WaterBody& water, SeaDef definition) {
  definition.depth = water.depth;
  definition.gravity = water.gravity;
  const core::Result<std::vector<WaveComponent>> components = wave_components(definition);
  if (!components.ok()) return components.error();
  return make(water, *components);
}

double Sea::significant_height() const {
  double energy = 0;
  for (const WaveComponent& w : components_) energy += 0.5 * w.amplitude * w.amplitude;
  return 4 * math::sqrt(energy);
}

double Sea::height(double x, double z, double time) const {
  double y = water_.level;
  for (const WaveComponent& w : components_) y += w.amplitude * math::sin(phase(w, x, z, time));
  return y;
}

void Sea::heights(std::span<const math::Vec2d> points, double time, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size() && i < out.size(); ++i) out[i] = height(points[i].x, points[i].y, time);
}

SeaPoint Sea::sample(Vec3d point, double time, const Footprint& footprint) const {
  math::SinCos<double> turn[max_components];
  double share[max_components];
  SeaPoint result;
  result.height = water_.level;
  double slope_x = 0, slope_z = 0;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const WaveComponent& w = components_[i];
    turn[i] = math::sincos(phase(w, point.x, point.z, time));
    // Of a disc the mean is 2 J₁(kr)/(kr) = 1 − (kr)²/8 + …, of a length l sin(kl/2)/(kl/2) = 1 − (kl)²/24 + …
    const double kx = w.wave_number * w.direction_x, kz = w.wave_number * w.direction_z;
    const double spread = 0.5 * (kx * kx * footprint.xx + 2 * kx * kz * footprint.xz + kz * kz * footprint.zz);
    share[i] = w.amplitude * (spread > 1e-4 ? math::exp(-spread) : 1);
    result.height += share[i] * turn[i].sin;
    const double slope = share[i] * w.wave_number * turn[i].cos;
    slope_x += slope * w.direction_x;
    slope_z += slope * w.direction_z;
  }
  result.normal = math::normalize(Vec3d{-slope_x, 1, -slope_z});
  result.velocity = water_.current;
  const double eta = result.height - water_.level, below = math::min(point.y - result.height, 0.0);
  double y = below;
  if (water_.stretching == Stretching::vertical)
    y = math::min(point.y - water_.level, 0.0);
  else if (water_.depth < deep_water)
    y = below * water_.depth / math::max(water_.depth + eta, 1e-3);
  y = math::max(y, -water_.depth);
  double dynamic = -eta;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const WaveComponent& w = components_[i];
    const Decay d = decay(w.wave_number, y, water_.depth);
    const double speed = share[i] * w.frequency, s = turn[i].sin, c = turn[i].cos;
    result.velocity += speed * Vec3d{w.direction_x * d.along * s, -d.up * c, w.direction_z * d.along * s};
    result.acceleration -=
        speed * w.frequency * Vec3d{w.direction_x * d.along * c, d.up * s, w.direction_z * d.along * c};
    dynamic += share[i] * d.pressure * s;
  }
  result.pressure = point.y < result.height ? water_.density * water_.gravity * (result.height - point.y + dynamic) : 0;
  return result;
}

void Sea::grid(double x, double z, double spacing, int columns, int rows, double time, std::span<double> out) const {
  const std::size_t count = std::size_t(math::max(columns, 0)) * std::size_t(math::max(rows, 0));
  if (count == 0 || out.size() < count) return;
  for (std::size_t i = 0; i < count; ++i) out[i] = water_.level;
  for (const WaveComponent& w : components_) {
    const math::SinCos<double> step = math::sincos(w.wave_number * w.direction_x * spacing);
    for (int row = 0; row < rows; ++row) {
      const math::SinCos<double> start = math::sincos(phase(w, x, z + spacing * row, time));
      double s = w.amplitude * start.sin, c = w.amplitude * start.cos;
      double* line = out.data() + std::size_t(row) * std::size_t(columns);
      for (int column = 0; column < columns; ++column) {
        line[column] += s;
        const double next = s * step.cos + c * step.sin;
        c = c * step.cos - s * step.sin;
        s = next;
      }
    }
  }
}

Vec3d Sea::stokes_drift(double depth_below) const {
  Vec3d drift{};
  for (const WaveComponent& w : components_) {
    const double k = w.wave_number, h = water_.depth, d = math::clamp(depth_below, 0.0, h);
    // cosh 2k(h−d)/(2 sinh² kh) = e^{−2kd} (1 + e^{−4k(h−d)})/(1 − e^{−2kh})².
    const double e = math::exp(-2 * k * d);
    double factor = e;
    if (k * h < 20) factor = e * (1 + math::exp(-4 * k * (h - d))) / math::square(1 - math::exp(-2 * k * h));
    const double speed = w.amplitude * w.amplitude * w.frequency * k * factor;
    drift += speed * Vec3d{w.direction_x, 0, w.direction_z};
  }
  return drift;
}

}  // namespace carom::environment
