// Which of many boxes of the plane meet that did not meet before, where much of them moved: in strips along one axis,
// sorted along the other, as many at a time as there are lanes.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/rigid/detail/strip_order.h"

namespace carom::rigid::detail {

/// Boxes in the order of their strips, for kernels: plain data.
struct StripRows {
  const float *low[2], *high[2], *old_low[2], *old_high[2];  ///< m; the first axis is that of the sweep
  const std::uint16_t *key, *last;                           ///< bins in which a box begins and ends along that
};
/// Tells that the box at place i meets those at places first, first + 1, … whose bits are set, and did not before.
using TellMeetings = void (*)(void* whom, std::int32_t i, std::int32_t first, std::uint32_t which);

class BoxStrips : public StripOrder {
 public:
  /// Forgets all boxes. Those to come, at most `room` in each part, reach into `whole`, and lie on a grid of 2⁻¹⁰ m.
  /// False where floats do not hold them exactly.
  bool begin(const geometry::Bounds2d& whole, int parts, std::size_t room);
  /// A box of now and what it was when pairs were last looked for: of what lies far off, that it met none here. Each
  /// part may be filled by a thread of its own.
  void add(int part, std::uint32_t item, const geometry::Bounds2d& box, const geometry::Bounds2d& old);
  /// Puts them in order. False where they crowd so that a tree is faster.
  bool sort(core::TaskScheduler& scheduler);

  StripRows rows() const;
  std::uint32_t item(std::int32_t place) const { return item_[std::size_t(place)]; }
  /// A pair that meets in several strips is that of one of them.
  bool is_of(int strip, std::int32_t i, std::int32_t k) const {
    const float a = row_[1][std::size_t(i)], b = row_[1][std::size_t(k)];
    return strip_of(a < b ? b : a) == strip;
  }
  /// Calls visit(vector) for all that it holds between steps, of no meaning then.
  template <class Self, class Visit>
  static void visit_lists(Self& self, Visit&& visit) {
    visit(self.boxes_);
    visit_order(self, visit);
    for (auto& row : self.row_) visit(row);
  }

 private:
  struct Box {
    float side[8];  ///< m: low, high, old low, old high, x and y of each
    std::uint32_t item;
    std::uint16_t key = 0, last = 0;  ///< bins
    std::uint16_t first_strip = 0, last_strip = 0;
  };

  std::vector<Box> boxes_;
  std::vector<float> row_[8];        ///< by place in the strips, as Box::side, the axis of the sweep before the other
  math::Vec2d origin_{}, extent_{};  ///< m
};

}  // namespace carom::rigid::detail
