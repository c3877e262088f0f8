#include "carom/rigid/tile_ground.h"

#include <algorithm>

#include "carom/core/string.h"

namespace carom::rigid {
namespace {

/// Borders run with the solid on their left: along the bottom of a cell to the right, up its right side, and so on.
struct Tracer {
  int columns, rows;
  std::span<const std::uint8_t> cells;
  std::vector<std::uint8_t> seen;  ///< a bit for each side of each cell

  std::uint8_t at(int i, int j) const {
    return i < 0 || j < 0 || i >= columns || j >= rows ? std::uint8_t(0)
                                                       : cells[std::size_t(j) * std::size_t(columns) + std::size_t(i)];
  }
  static constexpr int outward[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}},
                       along[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  static constexpr int start[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

  bool is_border(int i, int j, int side) const {
    return at(i, j) != 0 && at(i + outward[side][0], j + outward[side][1]) == 0;
  }
  /// To the border that goes on where this one ends: round the cell's own corner, straight on, or up the next wall.
  void advance(int& i, int& j, int& side) const {
    const int beside[2] = {i + along[side][0], j + along[side][1]};
    const int before[2] = {beside[0] + outward[side][0], beside[1] + outward[side][1]};
    const bool solid = at(beside[0], beside[1]) != 0;
    if (!solid) {
      side = (side + 1) % 4;  // a cell that only touches the corner stays apart
    } else if (at(before[0], before[1]) == 0) {
      i = beside[0], j = beside[1];
    } else {
      i = before[0], j = before[1];
      side = (side + 3) % 4;
    }
  }
};

}  // namespace

Result<std::vector<std::shared_ptr<const geometry::Chain>>> outline_tiles(int columns, int rows, float cell,
                                                                          std::span<const std::uint8_t> cells) {
  constexpr int max_side = 4096;
  for (const auto& [name, count] : {std::pair{"columns", columns}, std::pair{"rows", rows}})
    if (count < 1 || count > max_side)
      return core::Error{core::text("outline_tiles: ", count, " ", name, ", expected 1 to ", max_side)};
  if (cells.size() != std::size_t(columns) * std::size_t(rows))
    return core::Error{core::text("outline_tiles: ", cells.size(),
                                  " cells, expected columns × rows = ", std::size_t(columns) * std::size_t(rows))};
  if (!(cell >= 1e-3f && cell <= 1e4f))
    return core::Error{core::text("outline_tiles: cell is ", double(cell), ", expected 0.001 to 10000 m")};
  Tracer trace{columns, rows, cells, std::vector<std::uint8_t>(cells.size(), 0)};
  const bool materials = std::any_of(cells.begin(), cells.end(), [](std::uint8_t c) { return c > 1; });
  std::vector<std::shared_ptr<const geometry::Chain>> outlines;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (int side = 0; side < 4; ++side) {
        if (!trace.is_border(i, j, side)) continue;
        if ((trace.seen[std::size_t(j) * std::size_t(columns) + std::size_t(i)] >> side & 1) != 0) continue;
        std::vector<Vec2f> points;
        std::vector<std::uint8_t> of;
        int ci = i, cj = j, cs = side, last_side = -1, last_material = -1;
        do {
          std::uint8_t& seen = trace.seen[std::size_t(cj) * std::size_t(columns) + std::size_t(ci)];
          seen = std::uint8_t(seen | 1 << cs);
          const int material = trace.at(ci, cj) - 1;
          if (cs != last_side || material != last_material) {
            points.push_back(Vec2f{float(ci + Tracer::start[cs][0]), float(cj + Tracer::start[cs][1])} * cell);
            of.push_back(std::uint8_t(material));
          }
          last_side = cs, last_material = material;
          trace.advance(ci, cj, cs);
        } while (ci != i || cj != j || cs != side);
        // It may have begun in the middle of a straight run.
        if (last_side == side && last_material == int(of.front()) && points.size() > 1) {
          points.erase(points.begin());
          of.erase(of.begin());
        }
        auto chain =
            geometry::make_chain(std::move(points), true, materials ? std::move(of) : std::vector<std::uint8_t>{});
        if (!chain.ok()) return chain.error();
        outlines.push_back(std::move(*chain));
      }
  return outlines;
}

Result<TileGround> TileGround::create(World2& world, BodyId body, int columns, int rows, float cell,
                                      std::vector<std::uint8_t> cells, const ShapeDef<Dim2>& definition) {
  const Result<BodyState<Dim2>> state = world.state(body);
  if (!state.ok()) return state.error();
  if (state->type == BodyType::dynamic)
    return core::Error{"TileGround::create: the body is dynamic, expected a fixed or kinematic one"};
  TileGround ground;
  ground.body_ = body;
  ground.definition_ = definition;
  ground.columns_ = columns, ground.rows_ = rows, ground.cell_ = cell;
  if (const Status s = ground.update(world, std::move(cells)); !s.ok()) return s.error();
  return ground;
}

Status TileGround::set_cells(World2& world, const geometry::GridRectangle& b, std::span<const std::uint8_t> values) {
  const struct {
    const char* name;
    int first, count, size;
  } axes[] = {{"column", b.column, b.columns, columns_}, {"row", b.row, b.rows, rows_}};
  for (const auto& a : axes)
    if (a.first < 0 || a.count < 1 || a.first > a.size - a.count)
      return core::Error{core::text("TileGround::set_cells: the block begins at ", a.name, " ", a.first, " and has ",
                                    a.count, " ", a.name, "s, expected at least one within the grid's ", a.size)};
  if (values.size() != std::size_t(b.columns) * std::size_t(b.rows))
    return core::Error{core::text("TileGround::set_cells: ", values.size(), " values for a block of ",
                                  std::size_t(b.columns) * std::size_t(b.rows), ", expected one for each")};
  std::vector<std::uint8_t> cells = cells_;
  for (int j = 0; j < b.rows; ++j)
    std::copy_n(values.begin() + std::ptrdiff_t(j) * b.columns, b.columns,
                cells.begin() + std::ptrdiff_t(b.row + j) * columns_ + b.column);
  return update(world, std::move(cells));
}

Status TileGround::update(World2& world, std::vector<std::uint8_t> cells) {
  auto outlines = outline_tiles(columns_, rows_, cell_, cells);
  if (!outlines.ok()) return outlines.error();
  std::vector<ShapeId> shapes(outlines->size());
  std::vector<bool> kept(shapes_.size(), false);
  for (std::size_t i = 0; i < outlines->size(); ++i)
    for (std::size_t k = 0; k < outlines_.size() && shapes[i].is_null(); ++k) {
      const geometry::Chain &a = *(*outlines)[i], &b = *outlines_[k];
      if (kept[k] || !(a.points == b.points) || a.materials != b.materials) continue;
      shapes[i] = shapes_[k];
      (*outlines)[i] = outlines_[k];
      kept[k] = true;
    }
  // New ones first: where one is refused, nothing has changed.
  std::vector<ShapeId> made;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!shapes[i].is_null()) continue;
    ShapeDef<Dim2> definition = definition_;
    if ((*outlines)[i]->materials.empty() && !definition.surfaces.empty()) {
      definition.material = definition.surfaces.front().material;
      definition.surface_velocity = definition.surfaces.front().surface_velocity;
      definition.surfaces.clear();
    }
    const Result<ShapeId> shape = world.add_shape(body_, (*outlines)[i], definition);
    if (!shape.ok()) {
      for (const ShapeId m : made) (void)world.destroy_shape(m);
      return shape.error();
    }
    shapes[i] = *shape;
    made.push_back(*shape);
  }
  for (std::size_t k = 0; k < shapes_.size(); ++k)
    if (!kept[k] && world.contains(shapes_[k])) (void)world.destroy_shape(shapes_[k]);
  cells_ = std::move(cells);
  outlines_ = std::move(*outlines);
  shapes_ = std::move(shapes);
  return {};
}

}  // namespace carom::rigid
