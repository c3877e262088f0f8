// Where slabs and bricks begin and end.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/math/vec.h"

namespace carom::blast::detail {

/// Of a thickness: planes that cells of a lattice share must not pass exactly through corners of a mesh.
inline constexpr double off_lattice = 1.7e-7;

/// Errors: a number of slabs, a jitter or a normal that cannot be.
template <class V>
core::Status check_slabs(const V& normal, int count, int most, double jitter) {
  if (count < 1 || count > most) return core::Error{core::refused("count", count, core::text("1 to ", most, " slabs"))};
  if (!(jitter >= 0 && jitter <= 1)) return core::Error{core::refused("jitter", jitter, "0 to 1")};
  if (!(length_squared(normal) > 0) || !is_finite(normal)) return core::Error{"normal: expected a direction"};
  return {};
}
/// The `count` − 1 borders of slabs between two places.
inline std::vector<double> slab_borders(double low, double high, int count, double jitter, std::uint64_t seed) {
  math::Random random(seed);
  const double step = (high - low) / count;
  std::vector<double> borders;
  for (int k = 1; k < count; ++k)
    borders.push_back(low + step * (k + off_lattice + 0.5 * jitter * random.uniform(-1.0, 1.0)));
  return borders;
}

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
