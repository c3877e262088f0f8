// Space in cells, of which a bit each tells whether any of some boxes comes there: mostly none does, and then nothing
// else needs to be asked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/geometry/detail/tree_build.h"
#include "carom/math/simd.h"

namespace carom::geometry {

/// V: Vec2d or Vec3d.
template <class V>
class BoxCells {
 public:
  using Box = Bounds<V>;

  /// As if there were no box. Keeps the memory.
  void clear() { words_.clear(); }
  /// For boxes, which will be asked for with segments of about the length `asked` (m).
  void fill(std::span<const Box> boxes, double asked) {
    clear();
    if (boxes.empty()) return;
    double sum = 0;
    Box all = boxes.front();
    for (const Box& box : boxes) {
      all = merge(all, box);
      for (int k = 0; k < axes; ++k) sum += box.high[k] - box.low[k];
    }
    double size = 0;
    for (int k = 0; k < axes; ++k)
      size = math::max(size, math::max(all.high[k] - all.low[k], 1e-7 * math::abs(all.low[k])));
    const double slack = 1e-4 + 4e-6 * size;  // more than the floats of `crosses` lose
    double cell = math::max(1.25 * asked, math::max(slack, sum / (axes * double(boxes.size()))));
    for (;; cell *= 1.25) {
      double bits = 1;
      for (int k = 0; k < axes; ++k) {
        const double cells = (all.high[k] - all.low[k] + 2 * slack) / cell + (k == 0 ? 32 : 1);
        count_[k] = std::int32_t(math::min(cells, 1e9));
        bits *= cells;
      }
      if (bits < most_bits) break;
    }
    for (int k = 0; k < axes; ++k) low_[k] = all.low[k] - slack;
    per_metre_ = float(1 / cell);
    row_words_ = std::size_t(count_[0]) / 32 + 1;
    std::size_t rows = 1;
    for (int k = 1; k < axes; ++k) rows *= std::size_t(count_[k]);
    words_.assign(rows * row_words_ + 1, 0);
    for (const Box& box : boxes) {
      Place first = Place::zero(), last = Place::zero();
      for (int k = 0; k < axes; ++k) {
        const auto place = [&](double x) { return math::clamp((x - low_[k]) * double(per_metre_), 0.0, 1e9); };
        first.v[k] = std::int32_t(place(box.low[k] - slack));
        last.v[k] = math::min(std::int32_t(place(box.high[k] + slack)), count_[k] - 1);
      }
      visit(first, last, [&](std::size_t word, std::uint32_t bits) {
        words_[word] |= bits;
        return false;
      });
    }
  }
  /// False: the segment of a ray touches no box. Its coordinates must be finite.
  template <class Way>
  bool crosses(const V& from, const Way& way) const {
    using Four = math::WideFloat<4>;
    if (words_.empty()) return false;
    Four start = Four::zero(), along = Four::zero(), cells = Four::splat(1);
    for (int k = 0; k < axes; ++k) {
      start.set(k, float(from[k] - low_[k]));
      along.set(k, way[k]);
      cells.set(k, float(count_[k]));
    }
    const Four end = start + along, length = abs(along),
               slack = Four::splat(4e-6f * (length[0] + length[1] + length[2]));
    const Four scale = Four::splat(per_metre_);
    const Four first = (min(start, end) - slack) * scale, last = (max(start, end) + slack) * scale;
    if (bitmask(last < Four::zero()) != 0 || bitmask(first >= cells) != 0) return false;
    const auto low = to_int(max(Four::zero(), first)), high = to_int(min(cells - Four::splat(0.5f), last));
    const std::uint32_t x = std::uint32_t(low[0]), y = std::uint32_t(low[1]), z = std::uint32_t(low[2]);
    const std::uint32_t wide = std::uint32_t(high[0]) - x, tall = std::uint32_t(high[1]) - y,
                        deep = std::uint32_t(high[2]) - z;
    if ((tall | deep) > 1 || wide > 31) return crosses_many(low, high);
    // Mostly cells of four rows at most. No branch tells how many, for none would be foreseen.
    const auto row = [&](std::size_t a, std::size_t b) {
      const std::uint32_t* words = words_.data() + (b * std::size_t(count_[1]) + a) * row_words_ + (x >> 5);
      return words[0] | std::uint64_t(words[1]) << 32;
    };
    const std::uint64_t any = row(y, z) | row(y + tall, z) | row(y, z + deep) | row(y + tall, z + deep);
    return (any >> (x & 31) & ((std::uint64_t(2) << wide) - 1)) != 0;
  }

 private:
  static constexpr int axes = detail::Axes<V>::count;
  static constexpr double most_bits = 1 << 22;
  static constexpr std::int64_t most_rows = 16;  ///< of cells that a segment is looked for in
  using Place = math::WideInt<4>;                // of a cell, an axis a lane

  /// look(word, bits) until it returns true; whether it did.
  template <class Look>
  bool visit(const Place& first, const Place& last, Look&& look) const {
    for (std::int32_t z = first[2]; z <= last[2]; ++z)
      for (std::int32_t y = first[1]; y <= last[1]; ++y) {
        const std::size_t row = (std::size_t(z) * std::size_t(count_[1]) + std::size_t(y)) * row_words_;
        const std::int32_t from = first[0], to = last[0];
        for (std::int32_t word = from >> 5; word <= to >> 5; ++word) {
          std::uint32_t bits = ~std::uint32_t(0);
          if (word == from >> 5) bits &= ~std::uint32_t(0) << (from & 31);
          if (word == to >> 5) bits &= ~std::uint32_t(0) >> (31 - (to & 31));
          if (look(row + std::size_t(word), bits)) return true;
        }
      }
    return false;
  }
  [[gnu::noinline]] bool crosses_many(Place low, Place high) const {
    if (std::int64_t(high[1] - low[1] + 1) * (high[2] - low[2] + 1) > most_rows) return true;
    return visit(low, high, [&](std::size_t word, std::uint32_t bits) { return (words_[word] & bits) != 0; });
  }

  /// A word more than all rows, so that two can be read anywhere.
  std::vector<std::uint32_t> words_;
  std::size_t row_words_ = 0;
  std::int32_t count_[axes]{};  ///< of cells; along the first there are as many as its words hold
  float per_metre_ = 1;
  V low_{};  ///< where the first cell begins
};

}  // namespace carom::geometry
