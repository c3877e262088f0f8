#include "carom/geometry/detail/mesh_formats.h"

namespace carom::geometry::detail {

namespace {

namespace ear_clipping {

// Beyond this many corners the search would cost more than a good triangulation is worth: fans then.
constexpr std::size_t most_corners = 1000;

// Projected on the coordinate plane that the polygon faces most, counterclockwise.
std::vector<Vec2d> project(std::span<const Vec3d> vertices, std::span<const std::uint32_t> polygon) {
  Vec3d normal{};
  const Vec3d origin = vertices[polygon[0]];
  for (std::size_t i = 0; i < polygon.size(); ++i)
    normal += cross(vertices[polygon[i]] - origin, vertices[polygon[(i + 1) % polygon.size()]] - origin);
  const Vec3d size = abs(normal);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  std::vector<Vec2d> points;
  for (const std::uint32_t i : polygon) {
    const Vec3d p = vertices[i] - origin;
    const Vec2d q{p[(axis + 1) % 3], p[(axis + 2) % 3]};
    points.push_back(normal[axis] < 0 ? Vec2d{q.y, q.x} : q);
  }
  return points;
}

bool is_ear(const std::vector<Vec2d>& points, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
  const Vec2d a = points[left[before]], b = points[left[i]], c = points[left[after]];
  if (!(cross(b - a, c - b) > 0)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == before || k == i || k == after) continue;
    const Vec2d p = points[left[k]];
    if (p == a || p == b || p == c) continue;
    if (cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0) return false;
  }
  return true;
}

}  // namespace ear_clipping

}  // namespace

void triangulate_polygon(std::span<const Vec3d> vertices, std::span<const std::uint32_t> polygon,
                         std::vector<std::uint32_t>& indices) {
  using namespace ear_clipping;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    indices.insert(indices.end(), {polygon[a], polygon[b], polygon[c]});
  };
  if (polygon.size() == 3) return add(0, 1, 2);
  if (polygon.size() > most_corners) {
    for (std::uint32_t i = 1; i + 1 < polygon.size(); ++i) add(0, i, i + 1);
    return;
  }
  const std::vector<Vec2d> points = project(vertices, polygon);
  std::vector<std::uint32_t> left(polygon.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  std::size_t start = 1;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t ear = start % n;
    std::size_t tries = 0;
    while (tries < n && !is_ear(points, left, (start + tries) % n)) ++tries;
    if (tries < n) ear = (start + tries) % n;
    add(left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]);
    left.erase(left.begin() + std::ptrdiff_t(ear));
    start = ear;
  }
  add(left[0], left[1], left[2]);
}

}  // namespace carom::geometry::detail
