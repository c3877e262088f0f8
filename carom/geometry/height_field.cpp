#include "carom/geometry/height_field.h"

#include "carom/geometry/detail/text.h"

namespace carom::geometry {

core::Result<std::shared_ptr<const HeightField>> make_height_field(int columns, int rows, Vec2f cell,
                                                                   std::vector<float> heights,
                                                                   std::vector<std::uint8_t> holes) {
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
  field->low = low, field->high = high;
  return std::shared_ptr<const HeightField>(std::move(field));
}

}  // namespace carom::geometry
