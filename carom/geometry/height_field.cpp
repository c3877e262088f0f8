#include "carom/geometry/height_field.h"

#include <algorithm>

#include "carom/geometry/detail/text.h"

namespace carom::geometry {

core::Result<std::shared_ptr<const HeightField>> make_height_field(int columns, int rows, Vec2f cell,
                                                                   std::vector<float> heights,
                                                                   std::vector<std::uint8_t> holes,
                                                                   std::vector<std::uint8_t> materials) {
  constexpr int max_side = 1 << 15;  // so that the number of triangles fits an int
  if (columns < 2 || rows < 2 || columns > max_side || rows > max_side)
    return detail::error("make_height_field: %d columns and %d rows, expected 2 to %d of each", columns, rows,
                         max_side);
  if (auto s = detail::check_range("make_height_field: cell.x", cell.x, min_shape_size, max_shape_size); !s)
    return s.error();
  if (auto s = detail::check_range("make_height_field: cell.y", cell.y, min_shape_size, max_shape_size); !s)
    return s.error();
  if (double(columns - 1) * cell.x > max_shape_size || double(rows - 1) * cell.y > max_shape_size)
    return detail::error("make_height_field: the field is %g m by %g m, expected at most %g m",
                         double(columns - 1) * cell.x, double(rows - 1) * cell.y, max_shape_size);
  const std::size_t vertices = std::size_t(columns) * std::size_t(rows);
  if (heights.size() != vertices)
    return detail::error("make_height_field: %zu heights, expected columns × rows = %zu", heights.size(), vertices);
  const std::size_t cells = std::size_t(columns - 1) * std::size_t(rows - 1);
  if (!holes.empty() && holes.size() != cells)
    return detail::error("make_height_field: %zu holes, expected none or one a cell, %zu", holes.size(), cells);
  if (!materials.empty() && materials.size() != cells)
    return detail::error("make_height_field: %zu materials, expected none or one a cell, %zu", materials.size(), cells);
  float low = heights[0], high = heights[0];
  for (std::size_t i = 0; i < vertices; ++i) {
    if (!(abs(double(heights[i])) <= max_shape_size))
      return detail::error(
          "make_height_field: the height at column %zu, row %zu is %g: expected a number of at most %g",
          i % std::size_t(columns), i / std::size_t(columns), double(heights[i]), max_shape_size);
    low = min(low, heights[i]), high = max(high, heights[i]);
  }
  auto field = std::make_shared<HeightField>();
  field->columns = columns, field->rows = rows, field->cell = cell;
  field->heights = std::move(heights), field->holes = std::move(holes);
  field->materials = std::move(materials);
  field->low = low, field->high = high;
  return std::shared_ptr<const HeightField>(std::move(field));
}

namespace {

core::Status check_rectangle(const GridRectangle& r, int columns, int rows, std::size_t values, const char* what) {
  const struct {
    const char* name;
    int first, count, size;
  } axes[] = {{"column", r.column, r.columns, columns}, {"row", r.row, r.rows, rows}};
  for (const auto& a : axes)
    if (a.first < 0 || a.count < 1 || a.first > a.size - a.count)
      return detail::error("the rectangle begins at %s %d and has %d %ss, expected at least one within the field's %d",
                           a.name, a.first, a.count, a.name, a.size);
  const std::size_t total = std::size_t(r.columns) * std::size_t(r.rows);
  if (values != total)
    return detail::error("%zu %s for a rectangle of %zu, expected one for each", values, what, total);
  return {};
}

void write_cells(std::vector<std::uint8_t>& all, int columns, int rows, const GridRectangle& r,
                 std::span<const std::uint8_t> values) {
  if (all.empty()) all.assign(std::size_t(columns) * std::size_t(rows), 0);
  for (int j = 0; j < r.rows; ++j)
    std::copy_n(values.begin() + std::ptrdiff_t(j) * r.columns, r.columns,
                all.begin() + std::ptrdiff_t(r.row + j) * columns + r.column);
}

}  // namespace

core::Status check_heights(const HeightField& field, const GridRectangle& r, std::span<const float> heights) {
  if (auto s = check_rectangle(r, field.columns, field.rows, heights.size(), "heights"); !s) return s;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (!(abs(double(heights[i])) <= max_shape_size))
      return detail::error("the height at column %d, row %d is %g: expected a number of at most %g",
                           r.column + int(i) % r.columns, r.row + int(i) / r.columns, double(heights[i]),
                           max_shape_size);
  return {};
}
core::Status check_cells(const HeightField& field, const GridRectangle& r, std::span<const std::uint8_t> values) {
  return check_rectangle(r, field.columns - 1, field.rows - 1, values.size(), "values");
}

core::Status set_heights(HeightField& field, const GridRectangle& r, std::span<const float> heights) {
  if (auto s = check_heights(field, r, heights); !s) return s;
  for (int j = 0; j < r.rows; ++j)
    std::copy_n(heights.begin() + std::ptrdiff_t(j) * r.columns, r.columns,
                field.heights.begin() + std::ptrdiff_t(r.row + j) * field.columns + r.column);
  for (const float h : heights) field.low = min(field.low, h), field.high = max(field.high, h);
  return {};
}
core::Status set_holes(HeightField& field, const GridRectangle& r, std::span<const std::uint8_t> holes) {
  if (auto s = check_cells(field, r, holes); !s) return s;
  write_cells(field.holes, field.columns - 1, field.rows - 1, r, holes);
  return {};
}
core::Status set_materials(HeightField& field, const GridRectangle& r, std::span<const std::uint8_t> materials) {
  if (auto s = check_cells(field, r, materials); !s) return s;
  write_cells(field.materials, field.columns - 1, field.rows - 1, r, materials);
  return {};
}

}  // namespace carom::geometry
