#include "carom/geometry/decomposition.h"

#include <algorithm>
#include <utility>

#include "carom/geometry/detail/hull_builder.h"
#include "carom/geometry/detail/text.h"
#include "carom/geometry/mass_properties.h"

namespace carom::geometry {
namespace {
namespace decomposition {

/// Cubic cells of one size; (i, j, k) along x, y, z.
struct Grid {
  Vec3d origin{};
  double cell = 1;
  int count[3] = {1, 1, 1};

  Vec3f corner(detail::GridPoint p) const { return Vec3f(origin + cell * detail::to_vector(p)); }
};
struct Cell {
  std::int16_t at[3];
};
struct Part {
  std::vector<Cell> cells;      // row by row along x, level by level along z
  std::int64_t air_sixths = 0;  ///< of its hull, what is in no cell: in sixths of a cell
};
using detail::GridPoint;

/// The cells whose centres are inside, column by column along x: inside is what an odd number of surfaces lies before.
/// False where a column passes an odd number in all, which a closed mesh never shows.
bool fill(const Grid& grid, std::span<const Vec3f> vertices, std::span<const std::uint32_t> indices, int attempt,
          std::vector<Cell>& out) {
  out.clear();
  const std::size_t columns = std::size_t(grid.count[1]) * std::size_t(grid.count[2]);
  std::vector<std::vector<double>> crossings(columns);
  // A little off the centres, so that no column runs along an edge of a mesh made on round numbers; farther off in
  // every attempt.
  const double off_y = 0.5 + 1.234567e-4 * (1 + attempt), off_z = 0.5 - 2.345678e-4 * (1 + 2 * attempt);
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    Vec3d p[3];
    for (std::size_t c = 0; c < 3; ++c) p[c] = (Vec3d(vertices[indices[t + c]]) - grid.origin) * (1 / grid.cell);
    const double low_y = min(p[0].y, min(p[1].y, p[2].y)), high_y = max(p[0].y, max(p[1].y, p[2].y));
    const double low_z = min(p[0].z, min(p[1].z, p[2].z)), high_z = max(p[0].z, max(p[1].z, p[2].z));
    const double area = (p[1].y - p[0].y) * (p[2].z - p[0].z) - (p[1].z - p[0].z) * (p[2].y - p[0].y);
    if (area == 0) continue;
    for (int k = max(0, int(low_z) - 1); k < min(grid.count[2], int(high_z) + 2); ++k)
      for (int j = max(0, int(low_y) - 1); j < min(grid.count[1], int(high_y) + 2); ++j) {
        const double y = j + off_y, z = k + off_z;
        double weight[3];
        bool inside = true;
        for (int c = 0; c < 3 && inside; ++c) {
          const Vec3d &a = p[(c + 1) % 3], &b = p[(c + 2) % 3];
          weight[c] = ((a.y - y) * (b.z - z) - (a.z - z) * (b.y - y)) / area;
          inside = weight[c] > 0;
        }
        if (!inside) continue;
        const double x = weight[0] * p[0].x + weight[1] * p[1].x + weight[2] * p[2].x;
        crossings[std::size_t(k) * std::size_t(grid.count[1]) + std::size_t(j)].push_back(x);
      }
  }
  for (int k = 0; k < grid.count[2]; ++k)
    for (int j = 0; j < grid.count[1]; ++j) {
      std::vector<double>& x = crossings[std::size_t(k) * std::size_t(grid.count[1]) + std::size_t(j)];
      if (x.size() % 2 != 0) return false;
      std::sort(x.begin(), x.end());
      std::size_t before = 0;
      for (int i = 0; i < grid.count[0]; ++i) {
        while (before < x.size() && x[before] < i + 0.5) ++before;
        if (before % 2 == 1) out.push_back({{std::int16_t(i), std::int16_t(j), std::int16_t(k)}});
      }
    }
  return true;
}

/// How far corners of cells reach along x on a level, by y: from `low` to `high`; nowhere where low > high.
struct Level {
  std::vector<std::int16_t> low, high;
  explicit Level(std::size_t rows) : low(rows, INT16_MAX), high(rows, INT16_MIN) {}
  void cover(std::size_t row, const Cell& first, const Cell& last) {
    low[row] = min(low[row], first.at[0]);
    high[row] = max(high[row], std::int16_t(last.at[0] + 1));
  }
};

/// The corners of the convex outline of a level, its left side and its right one (Andrew's monotone chain, 1979).
void add_outline(const Level& level, std::int64_t first_y, std::int64_t z, std::vector<GridPoint>& out) {
  for (const int side : {-1, 1}) {
    const std::size_t begin = out.size();
    const auto bulges = [&](GridPoint a, GridPoint b, GridPoint c) {
      return side * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) > 0;
    };
    for (std::size_t row = 0; row < level.low.size(); ++row) {
      if (level.low[row] > level.high[row]) continue;
      const GridPoint p{side < 0 ? level.low[row] : level.high[row], first_y + std::int64_t(row), z};
      while (out.size() >= begin + 2 && !bulges(out[out.size() - 2], out.back(), p)) out.pop_back();
      out.push_back(p);
    }
  }
}

/// The corners of cells on which their hull hangs, in cells: of every level along z those of its convex outline, for
/// which of every row along x the two ends do.
std::vector<GridPoint> hull_corners(std::span<const Cell> cells) {
  int first_y = cells.front().at[1], last_y = first_y;
  for (const Cell& c : cells) first_y = min(first_y, int(c.at[1])), last_y = max(last_y, int(c.at[1]));
  const Level nothing(std::size_t(last_y - first_y + 2));
  Level here = nothing, above = nothing;  // the lower and the upper corners of a layer of cells
  std::vector<GridPoint> corners;
  int z = cells.front().at[2];
  for (std::size_t i = 0; i < cells.size();) {
    std::size_t last = i;
    const auto same_row = [&](const Cell& c) { return c.at[1] == cells[i].at[1] && c.at[2] == cells[i].at[2]; };
    while (last + 1 < cells.size() && same_row(cells[last + 1])) ++last;
    for (; z < cells[i].at[2]; ++z) {
      add_outline(here, first_y, z, corners);
      here = std::exchange(above, nothing);
    }
    for (const std::size_t side : {0, 1})
      for (Level* level : {&here, &above})
        level->cover(std::size_t(cells[i].at[1] - first_y) + side, cells[i], cells[last]);
    i = last + 1;
  }
  add_outline(here, first_y, z, corners);
  add_outline(above, first_y, z + 1, corners);
  return corners;
}

core::Result<std::shared_ptr<const Hull>> hull_of(const Grid& grid, std::span<const Cell> cells, int max_vertices) {
  std::vector<Vec3f> points;
  for (const GridPoint& corner : hull_corners(cells)) points.push_back(grid.corner(corner));
  HullOptions options;
  options.max_vertices = max_vertices;
  options.simplify = true;
  return make_hull(points, options);
}

/// Of the hull of so many of their corners as make_hull leaves too: exact.
std::int64_t air_sixths_of(std::span<const Cell> cells, int max_vertices) {
  const std::vector<GridPoint> corners = hull_corners(cells);
  std::int64_t sixths = 0;
  for (const detail::HullTriangle& t :
       detail::triangulate_hull(corners, 0, std::size_t(max_vertices), true).triangles) {
    const GridPoint a = corners[t.corner[0]];
    sixths -= detail::orient(detail::normal_of(a, corners[t.corner[1]], corners[t.corner[2]]), a, corners[0]);
  }
  return max(sixths - 6 * std::int64_t(cells.size()), std::int64_t(0));
}

/// Planes worth a try: where the section of the part changes most, and the middle.
std::vector<int> planes_across(const Part& part, int axis) {
  int low = part.cells[0].at[axis], high = low;
  for (const Cell& c : part.cells) low = min(low, int(c.at[axis])), high = max(high, int(c.at[axis]));
  std::vector<int> area(std::size_t(high - low + 1));
  for (const Cell& c : part.cells) ++area[std::size_t(c.at[axis] - low)];
  std::vector<int> planes;
  for (int i = low + 1; i <= high; ++i) planes.push_back(i);
  const auto step = [&](int i) { return std::abs(area[std::size_t(i - low)] - area[std::size_t(i - low - 1)]); };
  std::stable_sort(planes.begin(), planes.end(), [&](int a, int b) { return step(a) > step(b); });
  if (planes.size() > 4) {
    planes.resize(4);
    const int middle = (low + high + 1) / 2;
    if (std::find(planes.begin(), planes.end(), middle) == planes.end()) planes.push_back(middle);
  }
  return planes;
}

/// Splits the part at a plane of the grid; false where nothing is on one side.
bool split(const Part& part, int axis, int plane, int max_vertices, Part& a, Part& b) {
  a = {}, b = {};
  for (const Cell& c : part.cells) (c.at[axis] < plane ? a : b).cells.push_back(c);
  if (a.cells.empty() || b.cells.empty()) return false;
  for (Part* side : {&a, &b}) side->air_sixths = air_sixths_of(side->cells, max_vertices);
  return true;
}

/// The air that a cut through the middle, across the best axis, would leave: a ring loses its hole with the second cut
/// only, and slices would look better than quarters to whoever looks no farther than one.
std::int64_t air_after_halving(const Part& part, int max_vertices) {
  std::int64_t least = part.air_sixths;
  if (least == 0) return least;
  for (int axis = 0; axis < 3; ++axis) {
    int low = part.cells[0].at[axis], high = low;
    for (const Cell& c : part.cells) low = min(low, int(c.at[axis])), high = max(high, int(c.at[axis]));
    Part a, b;
    if (high > low && split(part, axis, (low + high + 1) / 2, max_vertices, a, b))
      least = min(least, a.air_sixths + b.air_sixths);
  }
  return least;
}

/// The two parts with the least air together, as far as another cut shows; false if the part is one cell.
bool cut(const Part& part, int max_vertices, Part& first, Part& second) {
  double least = 0;
  bool any = false;
  for (int axis = 0; axis < 3; ++axis)
    for (const int plane : planes_across(part, axis)) {
      Part a, b;
      if (!split(part, axis, plane, max_vertices, a, b)) continue;
      // Of cuts that leave the same, the one that leaves less at once, and the one nearer to halves.
      const double uneven = math::abs(double(a.cells.size()) - double(b.cells.size()));
      const double besides = 0.1 * double(a.air_sixths + b.air_sixths) + 0.06 * uneven;
      // Most are worse before their halves are cut in turn, which takes the time.
      if (any && besides >= least) continue;
      const std::int64_t air_of_first = air_after_halving(a, max_vertices);
      if (any && double(air_of_first) + besides >= least) continue;
      const double score = double(air_of_first + air_after_halving(b, max_vertices)) + besides;
      if (any && score >= least) continue;
      any = true, least = score;
      first = std::move(a), second = std::move(b);
    }
  return any;
}

core::Status check(std::span<const Vec3f> vertices, std::span<const std::uint32_t> indices,
                   const DecompositionOptions& o) {
  if (indices.empty() || indices.size() % 3 != 0)
    return detail::error("decompose_convex: %zu indices, expected three a triangle", indices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (auto s = detail::check_point("it", vertices[i], max_shape_size); !s)
      return detail::error("decompose_convex: vertex %zu: %s", i, s.error().message.c_str());
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= vertices.size())
      return detail::error("decompose_convex: triangle %zu refers to vertex %u of %zu", i / 3, indices[i],
                           vertices.size());
  if (o.max_parts < 1 || o.max_parts > 256)
    return detail::error("decompose_convex: max_parts is %d, expected 1 to 256", o.max_parts);
  if (o.resolution < 4 || o.resolution > 128)
    return detail::error("decompose_convex: resolution is %d, expected 4 to 128", o.resolution);
  if (o.max_vertices < 8 || o.max_vertices > 255)
    return detail::error("decompose_convex: max_vertices is %d, expected 8 to 255", o.max_vertices);
  return detail::check_range("decompose_convex: concavity", o.concavity, 0, 1);
}

}  // namespace decomposition
}  // namespace

core::Result<std::vector<std::shared_ptr<const Hull>>> decompose_convex(std::span<const Vec3f> vertices,
                                                                        std::span<const std::uint32_t> indices,
                                                                        const DecompositionOptions& options) {
  using namespace decomposition;
  if (auto s = check(vertices, indices, options); !s) return s.error();
  {
    const std::vector<Vec3d> corners(vertices.begin(), vertices.end());
    if (auto mass = mesh_mass_properties(corners, indices, 1); !mass.ok())
      return core::Error{"decompose_convex: " + mass.error().message};
  }
  Vec3d low(vertices[indices[0]]), high = low;
  for (const std::uint32_t i : indices) low = min(low, Vec3d(vertices[i])), high = max(high, Vec3d(vertices[i]));
  const Vec3d size = high - low;
  Grid grid;
  grid.cell = max(size.x, max(size.y, size.z)) / options.resolution;
  if (!(grid.cell * options.resolution >= double(min_shape_size)))
    return detail::error("decompose_convex: the mesh is %g m large, expected at least %g m",
                         grid.cell * options.resolution, double(min_shape_size));
  for (int axis = 0; axis < 3; ++axis) {
    grid.count[axis] = max(1, int(size[axis] / grid.cell + 0.999));
    // What the cells exceed the mesh by is shared by both sides.
    grid.origin[axis] = low[axis] - 0.5 * (grid.count[axis] * grid.cell - size[axis]);
  }
  Part whole;
  bool closed = false;
  for (int attempt = 0; attempt < 3 && !closed; ++attempt) closed = fill(grid, vertices, indices, attempt, whole.cells);
  if (!closed) return core::Error{"decompose_convex: the mesh is open: lines pass through it an odd number of times"};
  if (whole.cells.empty())
    return detail::error("decompose_convex: no cell of %g m is inside the mesh: it is too thin for a resolution of %d",
                         grid.cell, options.resolution);
  const double enough = 6 * double(options.concavity) * double(whole.cells.size());  // air, in sixths of a cell
  whole.air_sixths = air_sixths_of(whole.cells, options.max_vertices);
  std::vector<Part> parts;
  parts.push_back(std::move(whole));
  while (int(parts.size()) < options.max_parts) {
    std::size_t worst = 0;
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (parts[i].air_sixths > parts[worst].air_sixths) worst = i;
    if (double(parts[worst].air_sixths) <= enough) break;
    Part first, second;
    if (!cut(parts[worst], options.max_vertices, first, second)) break;
    parts[worst] = std::move(first);
    parts.push_back(std::move(second));
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.cells.size() > b.cells.size(); });
  std::vector<std::shared_ptr<const Hull>> hulls;
  for (const Part& p : parts) {
    auto hull = hull_of(grid, p.cells, options.max_vertices);
    if (!hull.ok()) return hull.error();
    hulls.push_back(std::move(*hull));
  }
  return hulls;
}

}  // namespace carom::geometry
