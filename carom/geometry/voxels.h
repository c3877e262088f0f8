// Ground of cubes that are filled or empty, to be dug and filled.
#pragma once

#include "carom/geometry/shape3.h"

namespace carom::geometry {

/// Cell (i, j, k) fills the cube from (i, j, k)·cell to (i + 1, j + 1, k + 1)·cell. Only faces between filled and empty
/// cells are surface; beyond the grid all is empty.
struct VoxelGrid {
  int columns = 0, layers = 0, rows = 0;  ///< cells along x, y and z
  float cell = 1;                         ///< m, edge of a cube
  /// cells[(k·layers + j)·columns + i]: 0 is empty, m is filled with material m − 1.
  std::vector<std::uint8_t> cells;
  bool edited = false;  ///< by a world: snapshots carry the cells

  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(layers) + std::size_t(j)) * std::size_t(columns) + std::size_t(i);
  }
  std::uint8_t at(int i, int j, int k) const {
    return i < 0 || j < 0 || k < 0 || i >= columns || j >= layers || k >= rows ? std::uint8_t(0)
                                                                               : cells[index(i, j, k)];
  }
};
/// `cells`: none (all empty), or one a cell. Errors: fewer than one cell or more than 1024 along an axis, more than
/// 2^26 in all, a cell size that is no length, another number of cells.
CAROM_API core::Result<std::shared_ptr<const VoxelGrid>> make_voxel_grid(int columns, int layers, int rows, float cell,
                                                                         std::vector<std::uint8_t> cells = {});

/// A block of cells.
struct VoxelBlock {
  int column = 0, layer = 0, row = 0;     ///< the first cell along x, y and z
  int columns = 1, layers = 1, rows = 1;  ///< how many
};
/// Errors: a block that is empty or not within the grid, another number of cells than it has.
CAROM_API core::Status check_cells(const VoxelGrid& grid, const VoxelBlock& block, std::span<const std::uint8_t> cells);
/// Writes the block, in the order of VoxelGrid::cells. What `check_cells` refuses changes nothing.
CAROM_API core::Status set_cells(VoxelGrid& grid, const VoxelBlock& block, std::span<const std::uint8_t> cells);

}  // namespace carom::geometry
