#include "carom/environment/wind_field.h"

#include "carom/core/string.h"

namespace carom::environment {
using math::Vec3d;

bool WindField::calm() const {
  return mean.velocity == Vec3d{} && layers.empty() && turbulence.calm() && gusts.empty() && thermals.empty() &&
         wakes.empty();
}

Vec3d WindField::mean_at(double height) const {
  if (layers.empty()) return wind_at(mean, height);
  if (!(height > layers.front().height)) return layers.front().velocity;
  std::size_t i = 1;
  while (i < layers.size() && height >= layers[i].height) ++i;
  if (i == layers.size()) return layers.back().velocity;
  const WindColumn::Level &a = layers[i - 1], &b = layers[i];
  return a.velocity + ((height - a.height) / (b.height - a.height)) * (b.velocity - a.velocity);
}

Vec3d WindField::at(Vec3d point, double time, double ground) const {
  const double height = point.y - ground;
  Vec3d wind = mean_at(height);
  const bool underground = height <= 0;
  if (underground) return wind;
  for (const Gust& gust : gusts) wind += gust_at(gust, point, time);
  if (!obstacles.empty()) {
    const Vec3d flat{wind.x, 0, wind.z};
    const double speed = math::length(flat);
    if (speed > 0) {
      double left = 1;
      for (const Obstacle& obstacle : obstacles) left *= lee_factor(obstacle, flat / speed, point);
      wind = {left * wind.x, wind.y, left * wind.z};
    }
  }
  wind += turbulence.at(point, time);
  for (const Thermal& thermal : thermals) wind += thermal_at(thermal, point);
  for (const WakeVortexPair& pair : wakes) wind += wake_vortices_at(pair, point, time);
  return wind;
}

WindColumn column_of(const WindField& field, double ground) {
  const WindColumn above = field.layers.empty() ? WindColumn(field.mean, 20e3) : WindColumn(field.layers);
  return ground == 0 ? above : above.raised(ground);
}

core::Status validate(const WindField& field) {
  core::Status status;
  const auto wants = [&](bool good, const auto& name, double found, const char* expected) {
    if (!good && status.ok()) status = core::Error{core::text("wind: ", name, " is ", found, ", expected ", expected)};
  };
  const auto finite = [&](Vec3d v, const auto& name) {
    for (int i = 0; i < 3; ++i) wants(math::is_finite(v[i]), name, v[i], "finite components");
  };
  const auto positive = [&](double x, const auto& name) {
    wants(x > 0 && math::is_finite(x), name, x, "a finite number above 0");
  };
  const auto unit = [&](Vec3d v, const auto& name) {
    const double length = math::length(v);
    wants(math::abs(length - 1) < 1e-6, name, length, "a length of 1");
  };
  finite(field.mean.velocity, "velocity");
  if (field.mean.profile != WindProfile::uniform) positive(field.mean.reference_height, "reference_height");
  wants(math::is_finite(field.mean.exponent), "exponent", field.mean.exponent, "a finite number");
  if (field.mean.profile == WindProfile::logarithmic)
    wants(field.mean.roughness_length > 0 && field.mean.roughness_length < field.mean.reference_height,
          "roughness_length", field.mean.roughness_length, "above 0 and below the reference height");
  for (std::size_t i = 0; i < field.layers.size(); ++i) {
    wants(math::is_finite(field.layers[i].height) && (i == 0 || field.layers[i].height > field.layers[i - 1].height),
          core::text("layers[", i, "].height"), field.layers[i].height, "more than the layer before");
    finite(field.layers[i].velocity, core::text("layers[", i, "].velocity"));
  }
  for (std::size_t i = 0; i < field.gusts.size(); ++i) {
    const auto name = [&](const char* part) { return core::text("gusts[", i, "].", part); };
    finite(field.gusts[i].velocity, name("velocity"));
    unit(field.gusts[i].direction, name("direction"));
    wants(math::is_finite(field.gusts[i].front), name("front"), field.gusts[i].front, "a finite place");
    wants(math::is_finite(field.gusts[i].speed), name("speed"), field.gusts[i].speed, "a finite speed");
    positive(field.gusts[i].gradient_distance, name("gradient_distance"));
  }
  for (std::size_t i = 0; i < field.thermals.size(); ++i) {
    const auto name = [&](const char* part) { return core::text("thermals[", i, "].", part); };
    finite(field.thermals[i].base, name("base"));
    finite(field.thermals[i].lean, name("lean"));
    wants(math::is_finite(field.thermals[i].strength), name("strength"), field.thermals[i].strength, "a finite speed");
    positive(field.thermals[i].radius, name("radius"));
    positive(field.thermals[i].depth, name("depth"));
  }
  for (std::size_t i = 0; i < field.obstacles.size(); ++i) {
    const auto name = [&](const char* part) { return core::text("obstacles[", i, "].", part); };
    finite(field.obstacles[i].center, name("center"));
    positive(field.obstacles[i].area, name("area"));
    positive(field.obstacles[i].drag_coefficient, name("drag_coefficient"));
    wants(field.obstacles[i].growth >= 0 && math::is_finite(field.obstacles[i].growth), name("growth"),
          field.obstacles[i].growth, "0 or more");
  }
  for (std::size_t i = 0; i < field.wakes.size(); ++i) {
    const auto name = [&](const char* part) { return core::text("wakes[", i, "].", part); };
    finite(field.wakes[i].point, name("point"));
    unit(field.wakes[i].direction, name("direction"));
    wants(math::abs(field.wakes[i].direction.y) < 1e-6, name("direction.y"), field.wakes[i].direction.y, "0");
    wants(math::is_finite(field.wakes[i].circulation), name("circulation"), field.wakes[i].circulation, "finite");
    positive(field.wakes[i].spacing, name("spacing"));
    positive(field.wakes[i].core_radius, name("core_radius"));
    positive(field.wakes[i].decay_time, name("decay_time"));
  }
  return status;
}

}  // namespace carom::environment
