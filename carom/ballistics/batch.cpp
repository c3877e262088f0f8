#include "carom/ballistics/batch.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "carom/ballistics/detail/batch_step.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {

/// A row of values as a table row wants it: every value with the difference to the next row's, zeros up to `Row`.
template <int Values, int Row>
void append_rows(std::vector<float>& table, int rows, const auto& values_of) {
  double here[Values], next[Values];
  values_of(0, here);
  for (int i = 0; i < rows; ++i) {
    values_of(i + 1, next);
    for (int k = 0; k < Values; ++k) {
      table.push_back(float(here[k]));
      table.push_back(float(next[k]) - float(here[k]));
      here[k] = next[k];
    }
    table.resize(std::size_t(i + 1) * Row, 0.0f);
  }
}

constexpr std::size_t padding = 16;
constexpr int drag_nodes = 1024;

}  // namespace detail

BatchRound chunk_round(double mass, double density) {
  const double area = 1.5 * math::square(math::cbrt(mass / density));
  return {.area_per_mass = area / mass, .mass = mass, .frontal_area = area};
}

ProjectileBatch::ProjectileBatch(const DragCurve& drag, const Conditions& conditions, Vec3d origin, int lanes)
    : origin_(origin) {
  const double last = math::max(drag.points().back().mach, 0.1);
  nodes_per_mach_ = float(detail::drag_nodes / last);
  detail::append_rows<1, detail::drag_row>(
      drag_, detail::drag_nodes, [&](int i, double* value) { value[0] = drag(last * i / detail::drag_nodes); });
  set_conditions(conditions);
  const math::InstructionSet set =
      lanes == 0 ? math::detect_instruction_set() : math::choose_instruction_set(math::instruction_set_of_width(lanes));
  lanes_ = math::simd_width(set);
}

void ProjectileBatch::set_conditions(const Conditions& conditions) {
  const std::span<const environment::WindColumn::Level> winds = conditions.wind.levels();
  const double base = winds.size() > 1 ? winds.front().height : 0;  // where profiles begin
  base_ = float(base - origin_.y);
  air_.clear();
  air_.reserve(std::size_t(2) * detail::air_cells * detail::air_row);
  for (const double side : {1.0, -1.0})
    for (int i = 0; i < detail::air_cells; ++i) {
      const auto distance = [](int cell) {
        return double(std::bit_cast<float>((detail::air_first + cell) << detail::air_shift));
      };
      double here[5], next[5];
      const auto values_at = [&](double height, double(&value)[5]) {
        const environment::AirColumn::Air air = conditions.air.at(height);
        const Vec3d wind = conditions.wind.at(height);
        value[0] = air.density;
        value[1] = 1 / air.speed_of_sound;
        for (int k = 0; k < 3; ++k) value[2 + k] = wind[k];
      };
      values_at(base + side * distance(i), here);
      values_at(base + side * distance(i + 1), next);
      for (int k = 0; k < 5; ++k) {
        air_.push_back(float(here[k]));
        air_.push_back(float((next[k] - here[k]) / (distance(i + 1) - distance(i))));
      }
      air_.resize(air_.size() + detail::air_row - 10, 0.0f);
    }
  gravity_ = float(conditions.gravity);
  for (int k = 0; k < 3; ++k) turning_[k] = float(-2 * conditions.rotation[k]);
}

void ProjectileBatch::reserve(std::size_t count) {
  for (std::vector<float>& array : data_)
    array.reserve((count + detail::padding - 1) / detail::padding * detail::padding);
  rounds_.reserve(count);
}

std::size_t ProjectileBatch::add(const FlightPoint& start, double area_per_mass) {
  return add(start, BatchRound{.area_per_mass = area_per_mass});
}

std::size_t ProjectileBatch::add(const FlightPoint& start, const BatchRound& round) {
  if (count_ == data_[0].size())
    for (std::vector<float>& array : data_) array.resize(count_ + detail::padding, 0.0f);
  const std::size_t i = count_++;
  const Vec3d position = start.position - origin_;
  for (int k = 0; k < 3; ++k) {
    data_[k][i] = data_[6 + k][i] = float(position[k]);
    data_[3 + k][i] = float(start.velocity[k]);
  }
  data_[9][i] = float(0.5 * round.area_per_mass);
  rounds_.push_back(round);
  if (!(round.frontal_area > 0)) rounds_.back().frontal_area = round.area_per_mass * round.mass;
  return i;
}

void ProjectileBatch::remove(std::size_t index) {
  if (index >= count_) return;
  --count_;
  for (std::vector<float>& array : data_) {
    array[index] = array[count_];
    array[count_] = 0;  // padding flies too, and must stay finite
  }
  rounds_[index] = rounds_[count_];
  rounds_.pop_back();
}

void ProjectileBatch::place(std::size_t index, const FlightPoint& point) {
  const Vec3d position = point.position - origin_;
  for (int k = 0; k < 3; ++k) {
    data_[k][index] = float(position[k]);
    data_[3 + k][index] = float(point.velocity[k]);
  }
}

void ProjectileBatch::sort(double cell) {
  const float per_metre = float(1 / cell);
  // Eleven bits an axis, the lowest bits of x, y and z side by side; the index below them keeps equal keys in order.
  const auto spread = [](std::uint64_t x) {
    x = (x | x << 16) & 0x0000ff0000ffull;
    x = (x | x << 8) & 0x00f00f00f00full;
    x = (x | x << 4) & 0x0c30c30c30c3ull;
    return (x | x << 2) & 0x249249249249ull;
  };
  keys_.resize(count_);
  keys_scratch_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const float place = math::clamp(data_[k][i] * per_metre + 1024.0f, 0.0f, 2047.0f);
      key |= spread(std::uint64_t(place)) << k;
    }
    keys_[i] = key << 24 | i;
  }
  for (int shift = 24; shift < 57; shift += 11) {
    std::uint32_t starts[2048] = {};
    for (const std::uint64_t key : keys_) ++starts[key >> shift & 2047];
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) sum += std::exchange(start, sum);
    for (const std::uint64_t key : keys_) keys_scratch_[starts[key >> shift & 2047]++] = key;
    keys_.swap(keys_scratch_);
  }
  moved_.resize(count_);
  for (std::vector<float>& array : data_) {
    for (std::size_t i = 0; i < count_; ++i) moved_[i] = array[keys_[i] & 0xffffff];
    std::copy(moved_.begin(), moved_.end(), array.begin());
  }
  moved_rounds_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) moved_rounds_[i] = rounds_[keys_[i] & 0xffffff];
  rounds_.swap(moved_rounds_);
}

void ProjectileBatch::clear() {
  count_ = 0;
  rounds_.clear();
  for (std::vector<float>& array : data_) array.clear();
}

void ProjectileBatch::step(double dt, std::size_t from, std::size_t to) {
  to = math::min(to, count_);
  if (from >= to) return;
  detail::BatchStep batch{};
  for (int k = 0; k < 3; ++k) {
    batch.position[k] = data_[k].data();
    batch.velocity[k] = data_[3 + k].data();
    batch.previous[k] = data_[6 + k].data();
    batch.turning[k] = turning_[k];
  }
  batch.half_area_per_mass = data_[9].data();
  batch.drag = drag_.data();
  batch.air = air_.data();
  batch.nodes_per_mach = nodes_per_mach_;
  // The last cell is never left: a hair below the end keeps the node within the table.
  batch.last_node = float(detail::drag_nodes) - 0.001f;
  batch.base = base_;
  batch.gravity = gravity_;
  batch.dt = float(dt);
  batch.most_drag = 1 / batch.dt;
#if CAROM_WIDE_UNITS
  if (lanes_ == 16) return detail::batch_avx512::step(batch, from, to);
  if (lanes_ == 8) return detail::batch_avx2::step(batch, from, to);
#endif
  detail::batch_baseline::step(batch, from, to);
}

FlightPoint ProjectileBatch::at(std::size_t i) const {
  return {origin_ + Vec3d{data_[0][i], data_[1][i], data_[2][i]}, {data_[3][i], data_[4][i], data_[5][i]}};
}

Vec3d ProjectileBatch::previous_position(std::size_t i) const {
  return origin_ + Vec3d{data_[6][i], data_[7][i], data_[8][i]};
}

}  // namespace carom::ballistics
