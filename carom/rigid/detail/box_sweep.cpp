#include "carom/rigid/detail/box_sweep.h"

#include <algorithm>

namespace carom::rigid::detail {

bool BoxSweep::take(core::TaskScheduler& scheduler, const geometry::DynamicTree3& tree) {
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
  parts_.resize(std::size_t(part_count(scheduler.thread_count(), count)));
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    parts_[p].begin = std::uint32_t(count * p / parts_.size());
    parts_[p].end = std::uint32_t(count * (p + 1) / parts_.size());
  }
  float *low[3], *high[3];
  int along[3];
  for (int k = 0; k < 3; ++k) {
    low_[k].resize(room_for(count)), high_[k].resize(room_for(count));
    low[k] = low_[k].data(), high[k] = high_[k].data(), along[k] = axes[k];
  }
  // Where boxes crowd, the tree is faster.
  const bool sparse = arrange(
      scheduler, boxes_, low_[0], 64,
      [&](Box& box) {
        box.key = std::uint16_t(bin_of(box.low[axes[0]])), box.last = std::uint16_t(bin_of(box.high[axes[0]]));
        box.first_strip = std::uint16_t(strip_of(box.low[axes[1]]));
        box.last_strip = std::uint16_t(strip_of(box.high[axes[1]]));
      },
      [low, high, along](const Box& box, std::size_t place) {
        for (int axis = 0; axis < 3; ++axis) {
          low[axis][place] = box.low[along[axis]];
          high[axis][place] = box.high[along[axis]];
        }
      });
  if (!sparse) return false;
  longest_ = 0;
  for (const Box& box : boxes_) longest_ = math::max(longest_, box.last - box.key);
  version_ = tree.version();
  return true;
}

}  // namespace carom::rigid::detail
