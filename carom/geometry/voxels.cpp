#include "carom/geometry/voxels.h"

#include "carom/geometry/detail/text.h"

namespace carom::geometry {

core::Result<std::shared_ptr<const VoxelGrid>> make_voxel_grid(int columns, int layers, int rows, float cell,
                                                               std::vector<std::uint8_t> cells) {
  constexpr int max_side = 1024;
  constexpr std::size_t max_cells = std::size_t(1) << 26;
  for (const auto& [name, count] :
       {std::pair{"columns", columns}, std::pair{"layers", layers}, std::pair{"rows", rows}})
    if (count < 1 || count > max_side)
      return detail::error("make_voxel_grid: %d %s, expected 1 to %d", count, name, max_side);
  const std::size_t total = std::size_t(columns) * std::size_t(layers) * std::size_t(rows);
  if (total > max_cells) return detail::error("make_voxel_grid: %zu cells, expected at most %zu", total, max_cells);
  if (auto s = detail::check_range("make_voxel_grid: cell", cell, min_shape_size, max_shape_size); !s) return s.error();
  if (double(math::max(columns, math::max(layers, rows))) * double(cell) > max_shape_size)
    return detail::error("make_voxel_grid: the grid is longer than %g m", max_shape_size);
  if (!cells.empty() && cells.size() != total)
    return detail::error("make_voxel_grid: %zu cells, expected none or columns × layers × rows = %zu", cells.size(),
                         total);
  auto grid = std::make_shared<VoxelGrid>();
  grid->columns = columns, grid->layers = layers, grid->rows = rows, grid->cell = cell;
  grid->cells = std::move(cells);
  if (grid->cells.empty()) grid->cells.assign(total, 0);
  return std::shared_ptr<const VoxelGrid>(std::move(grid));
}

core::Status check_cells(const VoxelGrid& grid, const VoxelBlock& b, std::span<const std::uint8_t> cells) {
  const struct {
    const char* name;
    int first, count, size;
  } axes[] = {{"column", b.column, b.columns, grid.columns},
              {"layer", b.layer, b.layers, grid.layers},
              {"row", b.row, b.rows, grid.rows}};
  for (const auto& a : axes)
    if (a.first < 0 || a.count < 1 || a.first > a.size - a.count)
      return detail::error("the block begins at %s %d and has %d %ss, expected at least one within the grid's %d",
                           a.name, a.first, a.count, a.name, a.size);
  const std::size_t total = std::size_t(b.columns) * std::size_t(b.layers) * std::size_t(b.rows);
  if (cells.size() != total)
    return detail::error("%zu cells for a block of %zu, expected one for each", cells.size(), total);
  return {};
}

core::Status set_cells(VoxelGrid& grid, const VoxelBlock& b, std::span<const std::uint8_t> cells) {
  if (auto s = check_cells(grid, b, cells); !s) return s;
  std::size_t next = 0;
  for (int k = 0; k < b.rows; ++k)
    for (int j = 0; j < b.layers; ++j)
      for (int i = 0; i < b.columns; ++i) grid.cells[grid.index(b.column + i, b.layer + j, b.row + k)] = cells[next++];
  return {};
}

}  // namespace carom::geometry
