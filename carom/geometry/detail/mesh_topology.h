// Which triangles of a soup belong together, and whether they close.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/math/vec.h"

namespace carom::geometry::detail {

struct MeshTopology {
  std::vector<std::uint32_t> corners;    // three a triangle: welded vertices, triangles without area left out
  std::vector<std::uint32_t> component;  // of each triangle, numbered from 0 in order of appearance
  std::uint32_t components = 0;
  std::size_t open = 0, unbalanced = 0, against = 0, non_manifold = 0;    // edges
  std::uint32_t open_edge[2]{}, unbalanced_edge[2]{}, against_edge[2]{};  // the first of each: its vertices
};

/// Points closer than `tolerance` become one; 0: only those with equal coordinates.
MeshTopology connect(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices, double tolerance);

}  // namespace carom::geometry::detail
