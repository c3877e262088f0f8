// Terrain as heights over a regular grid.
#pragma once

#include "carom/geometry/shape3.h"

namespace carom::geometry {

/// Vertex (i, j) is at (i·cell.x, heights[j·columns + i], j·cell.y), i along +x and j along +z; each cell is two
/// triangles split from (i, j) to (i + 1, j + 1), solid below. NaN heights are refused; a cell whose `hole` bit is set
/// has no surface.
struct HeightField {
  int columns = 0, rows = 0;  ///< vertices along x and z, ≥ 2
  Vec2f cell{1, 1};           ///< m, spacing along x and z
  std::vector<float> heights;
  std::vector<std::uint8_t> holes;  ///< empty, or one a cell, (rows − 1)·(columns − 1)
  float low = 0, high = 0;
};
CAROM_API core::Result<std::shared_ptr<const HeightField>> make_height_field(int columns, int rows, Vec2f cell,
                                                                             std::vector<float> heights,
                                                                             std::vector<std::uint8_t> holes = {});

}  // namespace carom::geometry
