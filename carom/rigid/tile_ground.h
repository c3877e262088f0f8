// Ground of square tiles in the plane, to be dug and filled: their outlines as one-sided chains on a body.
#pragma once

#include "carom/rigid/world.h"

namespace carom::rigid {

/// The borders between filled and empty cells as closed chains, counterclockwise round what is solid and clockwise
/// round caves in it; straight runs of one material are one segment, so nothing catches between tiles. Cells are row by
/// row from below: 0 is empty, m is filled with material m − 1. Cells that meet at a corner only are apart. Errors: no
/// cell or more than 4096 along an axis, another number of cells, a cell size that is no length.
CAROM_API Result<std::vector<std::shared_ptr<const geometry::Chain>>> outline_tiles(
    int columns, int rows, float cell, std::span<const std::uint8_t> cells);

/// Keeps the outlines of a grid of tiles on a body of a world. After a change only islands and caves whose outline
/// changed are made anew; who lies on those wakes. The grid itself is the caller's: snapshots of the world hold the
/// outlines, and a TileGround that is copied at the time of a snapshot goes with it.
class CAROM_API TileGround {
 public:
  /// The grid's lower left corner is the body's origin. `definition` is that of every outline: its `surfaces` are what
  /// the materials stand for. Errors: those of outline_tiles and World::add_shape, a dynamic body.
  static Result<TileGround> create(World2& world, BodyId body, int columns, int rows, float cell,
                                   std::vector<std::uint8_t> cells, const ShapeDef<Dim2>& definition = {});
  /// Writes a block of cells, row by row. Errors, which change nothing: a block that is empty or not within the grid,
  /// another number of values, a world or body that is not the one it was made for.
  Status set_cells(World2& world, const geometry::GridRectangle& block, std::span<const std::uint8_t> values);

  std::uint8_t at(int column, int row) const {
    return cells_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::span<const ShapeId> shapes() const { return shapes_; }  ///< one an outline

 private:
  Status update(World2& world, std::vector<std::uint8_t> cells);
  BodyId body_{};
  ShapeDef<Dim2> definition_{};
  int columns_ = 0, rows_ = 0;
  float cell_ = 1;
  std::vector<std::uint8_t> cells_;
  std::vector<std::shared_ptr<const geometry::Chain>> outlines_;
  std::vector<ShapeId> shapes_;
};

}  // namespace carom::rigid
