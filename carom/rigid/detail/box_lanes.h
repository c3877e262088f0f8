// Boxes side by side, for tests of many against many. Plain data, so that sources compiled for different instruction
// sets can share it.
#pragma once

#include "carom/math/simd.h"

namespace carom::rigid::detail {

/// In float: exact, because fat bounds lie on a grid (2⁻¹⁰ m) and are within 8 km of one origin; what is farther away
/// stays so when it is rounded.
template <class D, int Room>
struct BoxLanes {
  static constexpr int dimension = D::dimension;
  float low[dimension][Room], high[dimension][Room];

  void put(int lane, const typename D::Bounds& box, const typename D::Position& origin) {
    for (int k = 0; k < dimension; ++k) {
      low[k][lane] = float(box.low[k] - origin[k]);
      high[k][lane] = float(box.high[k] - origin[k]);
    }
  }
  /// A box that meets none.
  void put_nowhere(int lane) {
    for (int k = 0; k < dimension; ++k) low[k][lane] = 1e6f, high[k][lane] = -1e6f;
  }
};

/// Neighbours that look for partners together, and what is near them, each with its box of now and that of before.
template <class D>
struct BoxGroup {
  static constexpr int most_members = 16, room = 64;
  BoxLanes<D, most_members> boxes, old_boxes;
  BoxLanes<D, room> others, old_others;
};

}  // namespace carom::rigid::detail
