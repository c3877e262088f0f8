// Bounds that need not be exact.
#pragma once

#include <bit>
#include <cstdint>

namespace carom::rigid::detail {

/// A bound from below without most of its bits, and no larger: the six that are left are enough, and a difference of
/// snapshots need not carry the others. (Seven would be 0xFFFF0000, a mask that gcc 12 loses at -O2 where it writes the
/// lower half of a register for it.)
inline float coarse(float bound) {
  if (!(bound > 0)) return bound;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(bound) & 0xFFFE0000u);
}

}  // namespace carom::rigid::detail
