#include "carom/rigid/detail/box_strips.h"

namespace carom::rigid::detail {

bool BoxStrips::begin(const geometry::Bounds2d& whole, int parts, std::size_t room) {
  parts_.resize(std::size_t(parts));
  boxes_.resize(std::size_t(parts) * room);
  for (std::size_t p = 0; p < parts_.size(); ++p)
    parts_[p].begin = parts_[p].end = std::uint32_t(p * room), parts_[p].sum = {};
  origin_ = whole.low, extent_ = whole.high - whole.low;
  return extent_.x < exact && extent_.y < exact;
}

void BoxStrips::add(int part, std::uint32_t item, const geometry::Bounds2d& box, const geometry::Bounds2d& old) {
  const math::Vec2d low = max(box.low - origin_, math::Vec2d{}), high = min(box.high - origin_, extent_);
  const math::Vec2d far{exact, exact}, old_low = max(old.low - origin_, -far), old_high = min(old.high - origin_, far);
  Part& to = parts_[std::size_t(part)];
  to.sum += high - low;
  boxes_[to.end++] = {{float(low.x), float(low.y), float(high.x), float(high.y), float(old_low.x), float(old_low.y),
                       float(old_high.x), float(old_high.y)},
                      item};
}

bool BoxStrips::sort(core::TaskScheduler& scheduler) {
  std::size_t count = 0;
  math::Vec2d sum{};
  for (const Part& part : parts_) count += part.end - part.begin, sum += part.sum;
  // Along the axis along which boxes overlap least.
  const int along = sum.y / (extent_.y + 1e-9) < sum.x / (extent_.x + 1e-9) ? 1 : 0, across = 1 - along;
  measure(extent_[along], extent_[across], 3 * sum[across] / double(count));  // three boxes wide
  float* row[8];
  int side[8];  // of a box, for each row
  for (int i = 0; i < 8; ++i) row_[i].resize(room_for(count)), row[i] = row_[i].data();
  for (int i = 0; i < 8; ++i) side[i] = i / 2 * 2 + (i % 2 == 0 ? along : across);
  return arrange(
      scheduler, boxes_, row_[0], 256,
      [&](Box& box) {
        box.key = std::uint16_t(bin_of(box.side[along])), box.last = std::uint16_t(bin_of(box.side[2 + along]));
        box.first_strip = std::uint16_t(strip_of(box.side[across]));
        box.last_strip = std::uint16_t(strip_of(box.side[2 + across]));
      },
      [row, side](const Box& box, std::size_t place) {
        for (int i = 0; i < 8; ++i) row[i][place] = box.side[side[i]];
      });
}

StripRows BoxStrips::rows() const {
  const auto row = [&](int i) { return row_[i].data(); };
  return {{row(0), row(1)}, {row(2), row(3)}, {row(4), row(5)}, {row(6), row(7)}, key_.data(), last_.data()};
}

}  // namespace carom::rigid::detail
