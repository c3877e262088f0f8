// Vertices that stand in one place are one vertex.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "carom/math/vec.h"

namespace carom::geometry::detail {

/// For every point the lowest index of a point with the same coordinates. Points must be finite.
template <class T>
std::vector<std::uint32_t> weld_equal(std::span<const math::Vec3<T>> points) {
  std::vector<std::uint32_t> order(points.size()), welded(points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [points](std::uint32_t a, std::uint32_t b) {
    const math::Vec3<T>&p = points[a], &q = points[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    welded[order[i]] = i > 0 && points[order[i]] == points[order[i - 1]] ? welded[order[i - 1]] : order[i];
  return welded;
}

}  // namespace carom::geometry::detail
