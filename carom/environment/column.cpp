#include "carom/environment/column.h"

#include <algorithm>

namespace carom::environment {

AirColumn::AirColumn(const AtmosphereOffset& offset, double ground_altitude) {
  constexpr double lowest = -5000, highest = 40000, spacing = 50;
  lowest_ = lowest - ground_altitude;
  per_metre_ = 1 / spacing;
  const int count = int((highest - lowest) / spacing) + 1;
  nodes_.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const AirState air = standard_atmosphere(lowest + spacing * i, offset);
    nodes_.push_back({air.density, air.speed_of_sound});
  }
}

AirColumn AirColumn::uniform(double density, double speed_of_sound) {
  AirColumn column{Empty{}};
  column.nodes_ = {{density, speed_of_sound}, {density, speed_of_sound}};
  return column;
}

WindColumn::WindColumn(const Wind& wind, double top) {
  if (wind.profile == WindProfile::uniform) {
    levels_ = {{0, wind.velocity}};
    return;
  }
  // Profiles are steep near the ground: heights in geometric steps of 5 %, from where the wind begins.
  const double start = wind.profile == WindProfile::logarithmic ? wind.roughness_length : 1e-3;
  levels_.push_back({start, wind_at(wind, start)});
  for (double height = math::max(start, 1e-3); height < top;) {
    height = math::min(height * 1.05, top);
    levels_.push_back({height, wind_at(wind, height)});
  }
}

WindColumn::WindColumn(std::span<const Level> levels) : levels_(levels.begin(), levels.end()) {
  std::stable_sort(levels_.begin(), levels_.end(), [](const Level& a, const Level& b) { return a.height < b.height; });
}

math::Vec3d WindColumn::between(double height) const {
  if (!(height > levels_.front().height)) return levels_.front().velocity;
  if (height >= levels_.back().height) return levels_.back().velocity;
  const auto above = std::upper_bound(levels_.begin(), levels_.end(), height,
                                      [](double h, const Level& level) { return h < level.height; });
  const Level &a = *(above - 1), &b = *above;
  return a.velocity + ((height - a.height) / (b.height - a.height)) * (b.velocity - a.velocity);
}

}  // namespace carom::environment
