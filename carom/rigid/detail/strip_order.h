// Boxes in strips along one axis, in each sorted by bins along another: what the sweeps of space (BoxSweep) and of the
// plane (BoxStrips) have in common.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/math/vec.h"

namespace carom::rigid::detail {

class StripOrder {
 public:
  int strip_count() const { return int(first_.size()) - 1; }
  std::int32_t strip_begin(int strip) const { return first_[std::size_t(strip)]; }
  std::int32_t strip_end(int strip) const { return first_[std::size_t(strip) + 1] - padding; }
  /// Into how many parts threads should cut so many boxes. No order depends on it.
  static int part_count(int threads, std::size_t boxes) {
    return math::clamp(int(boxes / 1024), 1, math::clamp(threads, 1, most_parts));
  }

 protected:
  static constexpr int most_strips = 128, bins = 1024, most_parts = 8;
  static constexpr int padding = 16;    ///< places after each strip that meet none, for the widest lanes
  static constexpr double exact = 8e3;  ///< m: multiples of 2⁻¹⁰ m are exact in floats up to 16 km

  /// Boxes that one thread measures and orders.
  struct Part {
    std::uint32_t begin = 0, end = 0;  ///< among all
    math::Vec2d sum{};                 ///< m, of their sizes, in the plane
    std::uint32_t place[bins];         ///< how many each bin has, then where the next one goes
    std::uint32_t in_strip[most_strips];
  };

  int bin_of(float x) const { return math::clamp(int(x * bins_per_metre_), 0, bins - 1); }
  int strip_of(float y) const { return math::clamp(int(y * strips_per_metre_), 0, strip_count() - 1); }
  /// Bins on an extent (m), and strips of that width (m) on another.
  void measure(double along, double across, double width) {
    bins_per_metre_ = float(bins) / (float(along) + 1e-6f);
    const int strips = math::clamp(int(across / (width + 1e-3)), 1, most_strips);
    first_.reserve(most_strips + 1);  // the number of strips goes up and down from step to step
    first_.assign(std::size_t(strips) + 1, 0);
    strips_per_metre_ = float(strips) / (float(across) + 1e-6f);
  }
  /// Lays the boxes of all parts out: by strips, in each by bins. Bins rise with the coordinate, so that what begins in
  /// a later one than that in which a box ends does not meet it. Box has key, last, first_strip and last_strip, which
  /// find(box) sets; put(box, place) copies the rest; `lows` get where boxes begin along the bins, and beyond all of
  /// them after each strip. False where most boxes lie in several strips, or each is near `most_near` others.
  template <class Box, class Find, class Put>
  bool arrange(core::TaskScheduler& scheduler, std::vector<Box>& boxes, std::vector<float>& lows,
               std::uint64_t most_near, const Find& find, const Put& put) {
    const int parts = int(parts_.size());
    scheduler.parallel_for(parts, 1, [&](int p, int, int) {
      Part& part = parts_[std::size_t(p)];
      std::fill(std::begin(part.place), std::end(part.place), 0u);
      std::fill(std::begin(part.in_strip), std::end(part.in_strip), 0u);
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        find(boxes[i]);
        ++part.place[boxes[i].key];
        for (int s = boxes[i].first_strip; s <= boxes[i].last_strip; ++s) ++part.in_strip[s];
      }
    });
    std::uint32_t count = 0, bin_end[bins];
    for (int bin = 0; bin < bins; ++bin) {
      for (Part& part : parts_) {
        const std::uint32_t here = part.place[bin];
        part.place[bin] = count;
        count += here;
      }
      bin_end[bin] = count;
    }
    order_.resize(count);
    scheduler.parallel_for(parts, 1, [&](int p, int, int) {
      Part& part = parts_[std::size_t(p)];
      for (std::uint32_t i = part.begin; i < part.end; ++i) order_[part.place[boxes[i].key]++] = i;
    });

    std::size_t total = 0;
    std::uint64_t in_strip[most_strips];
    const int strips = strip_count();
    for (int s = 0; s < strips; ++s) {
      in_strip[s] = 0;
      for (const Part& part : parts_) in_strip[s] += part.in_strip[s];
      first_[std::size_t(s)] = std::int32_t(total);
      total += in_strip[s] + padding;
    }
    first_.back() = std::int32_t(total);
    const std::size_t room = room_for(count);
    if (total > room) return false;
    item_.resize(room), key_.resize(room), last_.resize(room);
    std::uint64_t
        near[most_parts];  // times their number: with what begins before a box ends, as far as it is in its strips
    scheduler.parallel_for(parts, 1, [&](int p, int, int) {
      const std::int32_t from = std::int32_t(total * std::size_t(p) / std::size_t(parts)),
                         to = std::int32_t(total * std::size_t(p + 1) / std::size_t(parts));
      int begin = 0;
      while (begin < strips && first_[std::size_t(begin)] < from) ++begin;
      int end = begin;
      std::int32_t at[most_strips];
      for (; end < strips && first_[std::size_t(end)] < to; ++end) at[end] = first_[std::size_t(end)];
      // Local: to the compiler, whatever is written might change the others.
      const Put put_here = put;
      const Box* const all = boxes.data();
      const std::uint32_t* const order = order_.data();
      std::uint32_t* const item = item_.data();
      std::uint16_t *const key = key_.data(), *const last = last_.data();
      std::uint64_t met_here = 0;
      for (std::uint32_t k = 0; k < count && begin < end; ++k) {
        const Box& box = all[order[k]];
        const std::uint64_t met = bin_end[box.last] - k;
        const int stop = math::min(int(box.last_strip) + 1, end);
        for (int s = math::max(int(box.first_strip), begin); s < stop; ++s) {
          met_here += met * in_strip[s];
          const std::size_t place = std::size_t(at[s]++);
          item[place] = box.item, key[place] = box.key, last[place] = box.last;
          put_here(box, place);
        }
      }
      near[p] = met_here;
    });
    for (int p = 1; p < parts; ++p) near[0] += near[p];
    if (near[0] > most_near * count * count) return false;
    for (int s = 0; s < strips; ++s) std::fill_n(&lows[std::size_t(strip_end(s))], padding, 1e30f);
    return true;
  }
  /// That all rows need for so many boxes at most.
  static std::size_t room_for(std::size_t boxes) { return 2 * boxes + padding * most_strips; }
  template <class Self, class Visit>
  static void visit_order(Self& self, Visit&& visit) {
    visit(self.parts_), visit(self.order_), visit(self.first_), visit(self.item_), visit(self.key_), visit(self.last_);
  }

  std::vector<Part> parts_;
  std::vector<std::uint32_t> order_;  ///< of boxes along the axis of the sweep
  std::vector<std::int32_t> first_;   ///< of each strip, and the end
  // By place in the strips:
  std::vector<std::uint32_t> item_;
  std::vector<std::uint16_t> key_, last_;  ///< bins in which a box begins and ends along the sweep
  float bins_per_metre_ = 0, strips_per_metre_ = 0;
};

}  // namespace carom::rigid::detail
