#include "carom/environment/column.h"

#include <algorithm>

namespace carom::environment {

AirColumn::AirColumn(const AtmosphereOffset& offset, double ground_altitude) {
  constexpr double lowest = -5000, highest = 40000, spacing = 50;
  lowest_ = lowest - ground_altitude;
  per_metre_ = 1 / spacing;
  const int count = int((highest - lowest) / spacing) + 1;
  last_ = count - 1;
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
    *this = WindColumn(wind.velocity);
    return;
  }
  // Profiles are steep near the ground: heights in geometric steps of 5 %, from where the wind begins.
  const double start = wind.profile == WindProfile::logarithmic ? wind.roughness_length : 1e-3;
  levels_.push_back({start, wind_at(wind, start)});
  for (double height = math::max(start, 1e-3); height < top;) {
    height = math::min(height * 1.05, top);
    levels_.push_back({height, wind_at(wind, height)});
  }
  prepare();
}

WindColumn::WindColumn(std::span<const Level> levels) : levels_(levels.begin(), levels.end()) {
  std::stable_sort(levels_.begin(), levels_.end(), [](const Level& a, const Level& b) { return a.height < b.height; });
  prepare();
}

WindColumn WindColumn::raised(double by) const {
  std::vector<Level> levels = levels_;
  for (Level& level : levels) level.height += by;
  return WindColumn(levels);
}

void WindColumn::prepare() {
  constexpr double octaves = 30;  // what is nearer to the lowest level than that is searched level by level
  if (levels_.empty()) return;
  lowest_ = levels_.front().velocity;
  if (levels_.size() < 2) return;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    legs_.push_back({levels_[i].height, levels_[i].velocity, {}, 0});
    const double span = i + 1 < levels_.size() ? levels_[i + 1].height - levels_[i].height : 0;
    if (span > 0) legs_.back().shear = (levels_[i + 1].velocity - levels_[i].velocity) / span;
    const math::Vec3d below = i > 0 ? legs_[i - 1].shear : math::Vec3d{};
    const double beside = span + (i > 0 ? levels_[i].height - levels_[i - 1].height : 0);
    legs_.back().bend = beside * math::length(legs_.back().shear - below);
    sharpest_bend_ = math::max(sharpest_bend_, legs_.back().bend);
  }
  legs_.push_back({1e308, {}, {}, 0});
  const double whole = levels_.back().height - levels_.front().height;
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x) >> 48; };
  first_cell_ = bits(math::max(whole, 0.0) * math::exp2(-octaves));
  last_cell_ = bits(whole);
  first_.assign(std::size_t(last_cell_ - first_cell_) + 1, 0);
  std::uint32_t level = 0;
  for (std::size_t i = 1; i < first_.size(); ++i) {
    const double start = std::bit_cast<double>((first_cell_ + i) << 48);
    while (level + 2 < levels_.size() && levels_[level + 1].height - levels_.front().height <= start) ++level;
    first_[i] = level;
  }
}

}  // namespace carom::environment
