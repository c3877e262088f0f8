#include "carom/environment/wind_field.h"

#include "carom/core/string.h"

namespace carom::environment {
using math::Vec3d;

bool WindField::calm() const {
  return mean.velocity == Vec3d{} && layers.empty() && turbulence.calm() && gusts.empty() && thermals.empty() &&
         wakes.empty();
}

bool WindField::steady() const {
  return turbulence.calm() && gusts.empty() && thermals.empty() && obstacles.empty() && wakes.empty();
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

Vec3d WindField::without_turbulence(Vec3d point, double time, Vec3d mean) const {
  Vec3d wind = mean;
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
  for (const Thermal& thermal : thermals) wind += thermal_at(thermal, point);
  for (const WakeVortexPair& pair : wakes) wind += wake_vortices_at(pair, point, time);
  return wind;
}

Vec3d WindField::at(Vec3d point, double time, double ground) const {
  const double height = point.y - ground;
  const Vec3d mean = mean_at(height);
  if (height <= 0) return mean;
  return without_turbulence(point, time, mean) + turbulence.at(point, time);
}

void WindField::beyond_mean(const WindGrid& grid, double time, double ground, std::span<math::Vec3f> out) const {
  const bool eddies_only = gusts.empty() && obstacles.empty() && thermals.empty() && wakes.empty();
  std::size_t node = 0;
  for (int row = 0; row < grid.rows; ++row)
    for (int layer = 0; layer < grid.layers; ++layer) {
      const double y = math::max(layer * grid.spacing + grid.corner.y, ground);
      const Vec3d mean = mean_at(y - ground);
      for (int column = 0; column < grid.columns; ++column, ++node) {
        const Vec3d point{column * grid.spacing + grid.corner.x, y, row * grid.spacing + grid.corner.z};
        out[node] = eddies_only ? math::Vec3f{} : math::Vec3f(without_turbulence(point, time, mean) - mean);
      }
    }
  turbulence.add_at(grid, time, out);
}

void WindPatch::place(Vec3d low, Vec3d high, int nodes) {
  nodes_.reserve(std::size_t(nodes));
  const auto count = [&](double spacing, int axis) {
    return math::floor(high[axis] / spacing) - math::floor(low[axis] / spacing) + 2;
  };
  // The least spacing of 1, 1.5, 2, 3, 4 … times a power of two.
  double spacing = 1.0 / 64;
  for (bool half = true; count(spacing, 0) * count(spacing, 1) * count(spacing, 2) > nodes; half = !half)
    spacing *= half ? 1.5 : 4.0 / 3;
  grid_.spacing = spacing;
  for (int axis = 0; axis < 3; ++axis) grid_.corner[axis] = math::floor(low[axis] / spacing) * spacing;
  grid_.columns = int(count(spacing, 0));
  grid_.layers = int(count(spacing, 1));
  grid_.rows = int(count(spacing, 2));
  nodes_.resize(std::size_t(grid_.size()));
}

void WindPatch::set(const WindField& field, Vec3d low, Vec3d high, double time, double ground, int nodes) {
  nodes_.clear();
  if (field.steady()) return;
  place(low, high, nodes);
  field.beyond_mean(grid_, time, ground, nodes_);
}

void WindPatch::set_whole(const WindField& field, Vec3d low, Vec3d high, double time, double ground, int nodes) {
  place(low, high, nodes);
  field.beyond_mean(grid_, time, ground, nodes_);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::size_t layer = i / std::size_t(grid_.columns) % std::size_t(grid_.layers);
    const double height = grid_.corner.y + double(layer) * grid_.spacing - ground;
    nodes_[i] += math::Vec3f(field.mean_at(math::max(height, 0.0)));
  }
}

Vec3d WindPatch::at(Vec3d point) const {
  if (nodes_.empty()) return {};
  const int counts[3] = {grid_.columns, grid_.layers, grid_.rows};
  int cell[3];
  float part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double place = math::clamp((point[axis] - grid_.corner[axis]) / grid_.spacing, 0.0, counts[axis] - 1.0);
    cell[axis] = math::min(int(place), counts[axis] - 2);
    part[axis] = float(place - cell[axis]);
  }
  const auto along = [&](int layer, int row) {
    const std::size_t i =
        (std::size_t(row) * std::size_t(grid_.layers) + std::size_t(layer)) * std::size_t(grid_.columns) +
        std::size_t(cell[0]);
    return nodes_[i] + part[0] * (nodes_[i + 1] - nodes_[i]);
  };
  const auto above = [&](int row) {
    const math::Vec3f low = along(cell[1], row);
    return low + part[1] * (along(cell[1] + 1, row) - low);
  };
  const math::Vec3f near = above(cell[2]);
  return Vec3d(near + part[2] * (above(cell[2] + 1) - near));
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
