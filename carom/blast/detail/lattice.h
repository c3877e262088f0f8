// Where slabs and bricks begin and end.
#pragma once

#include <cstdint>

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::blast::detail {

/// Of a thickness: planes that cells of a lattice share must not pass exactly through corners of a mesh.
inline constexpr double off_lattice = 1.7e-7;

/// Which bricks of a row, the first of which begins at `corner`, lie between two places.
struct BrickRow {
  std::int64_t first = 0, last = 0;
  bool countable = false;  ///< false: a million or more
  BrickRow(double low, double high, double corner, double size, double shift) {
    const double from = (low - corner) / size - shift, to = (high - corner) / size - shift;
    countable = math::abs(from) < 1e6 && math::abs(to) < 1e6;
    if (!countable) return;
    first = std::int64_t(math::floor(from + 1e-6));
    last = math::max(first, std::int64_t(math::floor(to - 1e-6)));
  }
};

}  // namespace carom::blast::detail
