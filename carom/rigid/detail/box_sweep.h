// Which of many boxes in space meet, where they are sparse and nearly all of them moved: in strips along one axis,
// sorted along another, four at a time. A tree is better where many lie together.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "carom/geometry/dynamic_tree.h"
#include "carom/math/simd.h"
#include "carom/rigid/detail/strip_order.h"

namespace carom::rigid::detail {

class BoxSweep : public StripOrder {
 public:
  /// Takes the leaves of a tree, whose boxes lie on a grid of 2⁻¹⁰ m. False where it would take longer than the tree,
  /// or floats do not hold the boxes exactly.
  bool take(core::TaskScheduler& scheduler, const geometry::DynamicTree3& tree);
  /// Calls visit(item, item) for those that meet in a strip, each pair in one strip only.
  template <class Visit>
  void visit_strip(int strip, Visit&& visit) const {
    using F = math::WideFloat<4>;
    const std::size_t end = std::size_t(strip_end(strip));
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
  /// Is it still what it took from the tree?
  bool holds(const geometry::DynamicTree3& tree) const { return version_ == tree.version(); }
  /// Calls visit(item) for those of a strip whose boxes meet a box, and maybe for some that pass it by 2 mm; each in
  /// one strip only.
  template <class Visit>
  void query_strip(int strip, const geometry::Bounds3d& box, Visit&& visit) const {
    const Range range(*this, box);
    if (!range.empty) query_strip(strip, range, visit);
  }
  /// The same of all strips.
  template <class Visit>
  void query(const geometry::Bounds3d& box, Visit&& visit) const {
    const Range range(*this, box);
    if (range.empty) return;
    for (int strip = range.first_strip; strip <= range.last_strip; ++strip) query_strip(strip, range, visit);
  }
  /// Calls visit(vector) for all that it holds between steps, of no meaning then.
  template <class Self, class Visit>
  static void visit_lists(Self& self, Visit&& visit) {
    visit(self.boxes_);
    visit_order(self, visit);
    for (auto& list : self.low_) visit(list);
    for (auto& list : self.high_) visit(list);
  }

 private:
  struct Box {
    float low[3], high[3];
    std::uint32_t item;
    std::uint16_t key = 0, last = 0, first_strip = 0, last_strip = 0;
  };
  /// A box as the strips see it.
  struct Range {
    float low[3] = {}, high[3] = {};
    int first_key = 0, last_key = 0, first_strip = 0, last_strip = 0;
    bool empty = true;

    Range(const BoxSweep& sweep, const geometry::Bounds3d& box) {
      constexpr double rounding = 1e-3;  // m, of floats at the farthest
      for (int k = 0; k < 3; ++k) {
        const int axis = sweep.axes_[k];
        const double from = math::max(box.low[axis] - sweep.origin_[axis], 0.0) - rounding,
                     to = math::min(box.high[axis] - sweep.origin_[axis], sweep.extent_[axis]) + rounding;
        if (!(from <= to)) return;
        low[k] = float(from), high[k] = float(to);
      }
      first_key = math::max(sweep.bin_of(low[0]) - sweep.longest_, 0), last_key = sweep.bin_of(high[0]);
      first_strip = sweep.strip_of(low[1]), last_strip = sweep.strip_of(high[1]);
      empty = false;
    }
  };
  template <class Visit>
  void query_strip(int strip, const Range& range, Visit&& visit) const {
    using F = math::WideFloat<4>;
    if (strip < range.first_strip || strip > range.last_strip) return;
    const F low[3] = {F::splat(range.low[0]), F::splat(range.low[1]), F::splat(range.low[2])},
            high[3] = {F::splat(range.high[0]), F::splat(range.high[1]), F::splat(range.high[2])};
    const std::uint16_t *begin = &key_[std::size_t(first_[std::size_t(strip)])],
                        *end = &key_[std::size_t(strip_end(strip))];
    if (range.first_key > 0) begin = std::lower_bound(begin, end, range.first_key);
    const std::size_t stop = std::size_t(end - key_.data());
    for (std::size_t k = std::size_t(begin - key_.data()); k < stop && key_[k] <= range.last_key; k += 4) {
      std::uint32_t meets = bitmask((F::load(&low_[0][k]) <= high[0]) & (low[0] <= F::load(&high_[0][k])) &
                                    (F::load(&low_[1][k]) <= high[1]) & (low[1] <= F::load(&high_[1][k])) &
                                    (F::load(&low_[2][k]) <= high[2]) & (low[2] <= F::load(&high_[2][k])));
      for (; meets != 0; meets &= meets - 1) {
        const std::size_t j = k + std::size_t(__builtin_ctz(meets));
        if (math::max(strip_of(low_[1][j]), range.first_strip) == strip) visit(item_[j]);
      }
    }
  }

  std::vector<Box> boxes_;
  // By place in the strips; axes in the order sweep, strips, the other.
  std::vector<float> low_[3], high_[3];
  math::Vec3d origin_{}, extent_{};  ///< m, of all boxes
  int axes_[3] = {0, 1, 2};          ///< in the order sweep, strips, the other
  int longest_ = 0;                  ///< bins from where a box begins to where it ends, at most
  std::uint64_t version_ = 0;        ///< of the tree
};

}  // namespace carom::rigid::detail
