#include "carom/rigid/detail/box_sweep.h"

#include <algorithm>

namespace carom::rigid::detail {

bool BoxSweep::take(const geometry::DynamicTree3& tree) {
  version_ = 0;
  const std::size_t count = std::size_t(tree.size());
  const geometry::Bounds3d whole = tree.root_bounds();
  const math::Vec3d extent = whole.high - whole.low;
  if (count < 64 || !(extent.x < exact && extent.y < exact && extent.z < exact)) return false;
  boxes_.clear();
  boxes_.reserve(count);
  math::Vec3d sum{};
  tree.visit_leaves([&](std::uint32_t item, const geometry::Bounds3d& box) {
    const math::Vec3d low = box.low - whole.low, high = box.high - whole.low;
    boxes_.push_back({{float(low.x), float(low.y), float(low.z)}, {float(high.x), float(high.y), float(high.z)}, item});
    sum += box.high - box.low;
  });
  origin_ = whole.low, extent_ = extent;
  int(&axes)[3] = axes_;  // the one first along which boxes overlap least
  axes[0] = 0, axes[1] = 1, axes[2] = 2;
  const auto share = [&](int axis) { return sum[axis] / (extent[axis] + 1e-9); };
  if (share(axes[1]) < share(axes[0])) std::swap(axes[0], axes[1]);
  if (share(axes[2]) < share(axes[1])) std::swap(axes[1], axes[2]);
  if (share(axes[1]) < share(axes[0])) std::swap(axes[0], axes[1]);

  measure(extent[axes[0]], extent[axes[1]], 3 * sum[axes[1]] / double(count));  // three boxes wide
  std::uint32_t place[bins] = {};
  longest_ = 0;
  for (Box& box : boxes_) {
    box.key = std::uint16_t(bin_of(box.low[axes[0]])), box.last = std::uint16_t(bin_of(box.high[axes[0]]));
    longest_ = math::max(longest_, box.last - box.key);
    ++place[box.key];
  }
  order_by_bins(boxes_, place);
  for (const Box& box : boxes_)
    for (int s = strip_of(box.low[axes[1]]), last = strip_of(box.high[axes[1]]); s <= last; ++s)
      ++first_[std::size_t(s) + 1];
  std::int32_t at[most_strips];
  std::uint64_t in_strip[most_strips];
  const std::size_t room = lay_out(count, padding, at, in_strip);
  if (room == 0) return false;
  for (int k = 0; k < 3; ++k) low_[k].resize(room), high_[k].resize(room);
  std::uint64_t compared = 0;  // times their number: with what begins before a box ends, as far as it is in its strips
  for (std::size_t k = 0; k < count; ++k) {
    const Box& box = boxes_[order_[k]];
    const std::uint64_t met = place[box.last] - k;  // by now the end of that bin
    for (int s = strip_of(box.low[axes[1]]), last = strip_of(box.high[axes[1]]); s <= last; ++s) {
      compared += met * in_strip[s];
      const std::size_t p = std::size_t(at[s]++);
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis][p] = box.low[axes[axis]];
        high_[axis][p] = box.high[axes[axis]];
      }
      item_[p] = box.item, key_[p] = box.key, last_[p] = box.last;
    }
  }
  const std::uint64_t most = 64 * std::uint64_t(count);
  if (compared > most * std::uint64_t(count)) return false;  // where boxes crowd, the tree is faster
  for (int s = 0; s < strip_count(); ++s)
    for (std::size_t k = 0; k < padding; ++k) low_[0][std::size_t(at[s]) + k] = 1e30f;
  version_ = tree.version();
  return true;
}

}  // namespace carom::rigid::detail
