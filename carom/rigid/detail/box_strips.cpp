#include "carom/rigid/detail/box_strips.h"

namespace carom::rigid::detail {

bool BoxStrips::begin(const geometry::Bounds2d& whole, std::size_t count) {
  boxes_.clear();
  boxes_.reserve(count);
  origin_ = whole.low, extent_ = whole.high - whole.low, sum_ = {};
  return extent_.x < exact && extent_.y < exact;
}

void BoxStrips::add(std::uint32_t item, const geometry::Bounds2d& box, const geometry::Bounds2d& old) {
  const math::Vec2d low = max(box.low - origin_, math::Vec2d{}), high = min(box.high - origin_, extent_);
  const math::Vec2d far{exact, exact}, old_low = max(old.low - origin_, -far), old_high = min(old.high - origin_, far);
  sum_ += high - low;
  boxes_.push_back({{float(low.x), float(low.y), float(high.x), float(high.y), float(old_low.x), float(old_low.y),
                     float(old_high.x), float(old_high.y)},
                    item,
                    0,
                    0,
                    0,
                    0});
}

bool BoxStrips::sort() {
  const std::size_t count = boxes_.size();
  // Along the axis along which boxes overlap least.
  const int along = sum_.y / (extent_.y + 1e-9) < sum_.x / (extent_.x + 1e-9) ? 1 : 0, across = 1 - along;
  measure(extent_[along], extent_[across], 3 * sum_[across] / double(count));  // three boxes wide
  std::uint32_t place[bins] = {};
  for (Box& box : boxes_) {
    box.key = std::uint16_t(bin_of(box.side[along])), box.last = std::uint16_t(bin_of(box.side[2 + along]));
    ++place[box.key];
    box.first_strip = std::uint16_t(strip_of(box.side[across]));
    box.last_strip = std::uint16_t(strip_of(box.side[2 + across]));
    for (int s = box.first_strip; s <= box.last_strip; ++s) ++first_[std::size_t(s) + 1];
  }
  order_by_bins(boxes_, place);
  std::int32_t at[most_strips];
  std::uint64_t in_strip[most_strips];
  const std::size_t room = lay_out(count, padding, at, in_strip);
  if (room == 0) return false;
  for (std::vector<float>& row : row_) row.resize(room);
  float* row[8];
  int side[8];  // of a box, for each row
  for (int i = 0; i < 8; ++i) row[i] = row_[i].data(), side[i] = i / 2 * 2 + (i % 2 == 0 ? along : across);
  std::uint32_t* const item = item_.data();
  std::uint16_t *const key = key_.data(), *const last = last_.data();
  std::uint64_t compared = 0;  // times their number: with what begins before a box ends, as far as it is in its strips
  for (std::size_t k = 0; k < count; ++k) {
    const Box& box = boxes_[order_[k]];
    const std::uint64_t met = place[box.last] - k;  // by now the end of that bin
    for (int s = box.first_strip; s <= box.last_strip; ++s) {
      compared += met * in_strip[s];
      const std::size_t p = std::size_t(at[s]++);
      for (int i = 0; i < 8; ++i) row[i][p] = box.side[side[i]];
      item[p] = box.item, key[p] = box.key, last[p] = box.last;
    }
  }
  const std::uint64_t most = 256 * std::uint64_t(count);
  if (compared > most * std::uint64_t(count)) return false;
  for (int s = 0; s < strip_count(); ++s)
    for (int k = 0; k < padding; ++k) row_[0][std::size_t(at[s]) + std::size_t(k)] = 1e30f;
  return true;
}

StripRows BoxStrips::rows() const {
  const auto row = [&](int i) { return row_[i].data(); };
  return {{row(0), row(1)}, {row(2), row(3)}, {row(4), row(5)}, {row(6), row(7)}, key_.data(), last_.data()};
}

}  // namespace carom::rigid::detail
