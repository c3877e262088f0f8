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
  std::vector<std::uint8_t> holes;      ///< empty, or one a cell, (rows − 1)·(columns − 1)
  std::vector<std::uint8_t> materials;  ///< likewise, as the user numbers them
  float low = 0, high = 0;              ///< m: no vertex is below or above; after edits there may be none at them
  bool edited = false;                  ///< by a world: snapshots carry the field
};
/// A rectangle of vertices or cells.
struct GridRectangle {
  int column = 0, row = 0;    ///< the first one along x and z
  int columns = 1, rows = 1;  ///< how many
};
CAROM_API core::Result<std::shared_ptr<const HeightField>> make_height_field(int columns, int rows, Vec2f cell,
                                                                             std::vector<float> heights,
                                                                             std::vector<std::uint8_t> holes = {},
                                                                             std::vector<std::uint8_t> materials = {});

/// What would be wrong with the call of the same name below.
CAROM_API core::Status check_heights(const HeightField& field, const GridRectangle& vertices,
                                     std::span<const float> heights);
CAROM_API core::Status check_cells(const HeightField& field, const GridRectangle& cells,
                                   std::span<const std::uint8_t> values);
/// Change a rectangle, row by row, in time proportional to it. Errors, which change nothing: a rectangle that is empty
/// or not within the grid, another number of values than it has, a height that is no number.
CAROM_API core::Status set_heights(HeightField& field, const GridRectangle& vertices, std::span<const float> heights);
/// 1: a hole, 0: ground.
CAROM_API core::Status set_holes(HeightField& field, const GridRectangle& cells, std::span<const std::uint8_t> holes);
CAROM_API core::Status set_materials(HeightField& field, const GridRectangle& cells,
                                     std::span<const std::uint8_t> materials);

}  // namespace carom::geometry
