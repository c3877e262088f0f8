// Boxes in strips along one axis, in each sorted by bins along another: what the sweeps of space (BoxSweep) and of the
// plane (BoxStrips) have in common.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/math/vec.h"

namespace carom::rigid::detail {

class StripOrder {
 public:
  int strip_count() const { return int(first_.size()) - 1; }

 protected:
  static constexpr int most_strips = 128, bins = 1024;
  static constexpr double exact = 8e3;  ///< m: multiples of 2⁻¹⁰ m are exact in floats up to 16 km

  int bin_of(float x) const { return math::clamp(int(x * bins_per_metre_), 0, bins - 1); }
  int strip_of(float y) const { return math::clamp(int(y * strips_per_metre_), 0, strip_count() - 1); }
  /// Bins on an extent (m), and empty strips of that width (m) on another.
  void measure(double along, double across, double width) {
    bins_per_metre_ = float(bins) / (float(along) + 1e-6f);
    const int strips = math::clamp(int(across / (width + 1e-3)), 1, most_strips);
    first_.reserve(most_strips + 1);  // the number of strips goes up and down from step to step
    first_.assign(std::size_t(strips) + 1, 0);
    strips_per_metre_ = float(strips) / (float(across) + 1e-6f);
  }
  /// Orders boxes by Box::key, their bins. `place` tells how many each bin has, and then where it ends. Bins rise with
  /// the coordinate, so that what begins in a later one than that in which a box ends does not meet it.
  template <class Box>
  void order_by_bins(const std::vector<Box>& boxes, std::uint32_t (&place)[bins]) {
    std::uint32_t before = 0;
    for (std::uint32_t& p : place) {
      const std::uint32_t here = p;
      p = before;
      before += here;
    }
    order_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) order_[place[boxes[i].key]++] = std::uint32_t(i);
  }
  /// From how many boxes a strip has, first_[strip + 1], to where it begins, with some places free after each. Returns
  /// the room for all rows, or 0 where most boxes lie in several strips.
  std::size_t lay_out(std::size_t boxes, std::size_t padding, std::int32_t (&at)[most_strips],
                      std::uint64_t (&in_strip)[most_strips]) {
    std::size_t total = 0;
    for (int s = 0; s < strip_count(); ++s) {
      const std::size_t here = std::size_t(first_[std::size_t(s) + 1]);
      at[s] = first_[std::size_t(s)] = std::int32_t(total), in_strip[s] = here;
      total += here + padding;
    }
    first_.back() = std::int32_t(total);
    const std::size_t room = 2 * boxes + padding * most_strips;
    if (total > room) return 0;
    item_.resize(room), key_.resize(room), last_.resize(room);
    return room;
  }
  template <class Self, class Visit>
  static void visit_order(Self& self, Visit&& visit) {
    visit(self.order_), visit(self.first_), visit(self.item_), visit(self.key_), visit(self.last_);
  }

  std::vector<std::uint32_t> order_;  ///< of boxes along the axis of the sweep
  std::vector<std::int32_t> first_;   ///< of each strip, and the end
  // By place in the strips:
  std::vector<std::uint32_t> item_;
  std::vector<std::uint16_t> key_, last_;  ///< bins in which a box begins and ends along the sweep
  float bins_per_metre_ = 0, strips_per_metre_ = 0;
};

}  // namespace carom::rigid::detail
