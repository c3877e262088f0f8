// Which of many boxes in space meet, where they are sparse and nearly all of them moved: in strips along one axis,
// sorted along another, four at a time. A tree is better where many lie together.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/geometry/dynamic_tree.h"
#include "carom/math/simd.h"

namespace carom::rigid::detail {

class BoxSweep {
 public:
  /// Takes the leaves of a tree, whose boxes lie on a grid of 2⁻¹⁰ m. False where it would take longer than the tree,
  /// or floats do not hold the boxes exactly.
  bool take(const geometry::DynamicTree3& tree);
  int strip_count() const { return int(first_.size()) - 1; }
  /// Calls visit(item, item) for those that meet in a strip, each pair in one strip only.
  template <class Visit>
  void visit_strip(int strip, Visit&& visit) const {
    using F = math::WideFloat<4>;
    const std::size_t end = std::size_t(first_[std::size_t(strip) + 1]) - padding;
    for (std::size_t i = std::size_t(first_[std::size_t(strip)]); i + 1 < end; ++i) {
      const F low[3] = {F::splat(low_[0][i]), F::splat(low_[1][i]), F::splat(low_[2][i])},
              high[3] = {F::splat(high_[0][i]), F::splat(high_[1][i]), F::splat(high_[2][i])};
      const std::uint16_t last = last_[i];
      for (std::size_t k = i + 1; k < end && key_[k] <= last; k += 4) {
        std::uint32_t meets = bitmask((F::load(&low_[0][k]) <= high[0]) & (low[0] <= F::load(&high_[0][k])) &
                                      (F::load(&low_[1][k]) <= high[1]) & (low[1] <= F::load(&high_[1][k])) &
                                      (F::load(&low_[2][k]) <= high[2]) & (low[2] <= F::load(&high_[2][k])));
        for (; meets != 0; meets &= meets - 1) {
          const std::size_t j = k + std::size_t(__builtin_ctz(meets));
          if (strip_of(math::max(low_[1][i], low_[1][j])) == strip) visit(item_[i], item_[j]);
        }
      }
    }
  }
  /// Calls visit(vector) for all that it holds between steps, of no meaning then.
  template <class Visit>
  void visit_lists(Visit&& visit) {
    each_list(*this, visit);
  }
  template <class Visit>
  void visit_lists(Visit&& visit) const {
    each_list(*this, visit);
  }

 private:
  template <class Self, class Visit>
  static void each_list(Self& self, Visit& visit) {
    visit(self.boxes_), visit(self.order_), visit(self.first_), visit(self.item_), visit(self.key_), visit(self.last_);
    for (auto& list : self.low_) visit(list);
    for (auto& list : self.high_) visit(list);
  }
  struct Box {
    float low[3], high[3];
    std::uint32_t item;
    std::uint16_t key, last;
  };
  static constexpr int most_strips = 128, bins = 1024;
  static constexpr std::size_t padding = 4;  ///< boxes that meet none, after each strip

  int strip_of(float y) const { return math::clamp(int(y * strips_per_metre_), 0, strip_count() - 1); }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;  ///< of boxes along the axis of the sweep
  std::vector<std::int32_t> first_;   ///< of each strip, and the end
  // By place in the strips; axes in the order sweep, strips, the other.
  std::vector<float> low_[3], high_[3];
  std::vector<std::uint32_t> item_;
  std::vector<std::uint16_t> key_, last_;  ///< bins in which a box begins and ends along the sweep
  float strips_per_metre_ = 0;
};

}  // namespace carom::rigid::detail
