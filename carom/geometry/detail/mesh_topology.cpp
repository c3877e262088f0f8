#include "carom/geometry/detail/mesh_topology.h"

#include <algorithm>

#include "carom/geometry/detail/weld.h"

namespace carom::geometry::detail {

namespace {

namespace topology {

using math::Vec3d;

// Disjoint sets whose representative is their lowest member.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) {
    for (std::uint32_t i = 0; i < n; ++i) parent_[i] = i;
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent_[a < b ? b : a] = a < b ? a : b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Cell {
  std::int64_t x, y, z;
  std::uint32_t point;
};
bool same_cell(const Cell& a, const Cell& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
bool cell_before(const Cell& a, const Cell& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  if (a.z != b.z) return a.z < b.z;
  return a.point < b.point;
}

// Points in one cell of the size of the tolerance are one; so are the points of neighbouring cells whose first points
// are near enough to have points within tolerance of each other.
std::vector<std::uint32_t> weld_near(std::span<const Vec3d> points, double tolerance) {
  Vec3d low = points[0];
  for (const Vec3d& p : points) low = math::min(low, p);
  std::vector<Cell> cells(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3d d = (points[i] - low) / tolerance;
    cells[i] = {std::int64_t(d.x), std::int64_t(d.y), std::int64_t(d.z), i};
  }
  std::sort(cells.begin(), cells.end(), cell_before);
  Sets sets(points.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0 && same_cell(cells[i - 1], cells[i])) {
      sets.join(cells[i - 1].point, cells[i].point);
      continue;
    }
    for (int k = 0; k < 27; ++k) {
      const Cell wanted{cells[i].x + k % 3 - 1, cells[i].y + k / 3 % 3 - 1, cells[i].z + k / 9 - 1, 0};
      const auto other = std::lower_bound(cells.begin(), cells.end(), wanted, cell_before);
      if (other == cells.end() || !same_cell(*other, wanted)) continue;
      if (math::distance(points[cells[i].point], points[other->point]) < 4.5 * tolerance)
        sets.join(cells[i].point, other->point);
    }
  }
  std::vector<std::uint32_t> welded(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) welded[i] = sets.find(i);
  return welded;
}

struct Edge {
  std::uint32_t low, high, triangle;
  bool reversed;
};

void classify(MeshTopology& mesh, std::span<const Edge> edge) {
  const auto note = [&edge](std::size_t& count, std::uint32_t(&first)[2]) {
    if (count++ == 0) first[0] = edge[0].low, first[1] = edge[0].high;
  };
  std::size_t reversed = 0;
  for (const Edge& e : edge) reversed += e.reversed;
  if (edge.size() == 1) return note(mesh.open, mesh.open_edge);
  if (2 * reversed == edge.size()) {
    mesh.non_manifold += edge.size() > 2;
    return;
  }
  if (edge.size() == 2) return note(mesh.against, mesh.against_edge);
  note(mesh.unbalanced, mesh.unbalanced_edge);
}

}  // namespace topology

}  // namespace

MeshTopology connect(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices, double tolerance) {
  using namespace topology;
  const std::vector<std::uint32_t> welded = tolerance > 0 ? weld_near(vertices, tolerance) : weld_equal(vertices);
  MeshTopology mesh;
  std::vector<Edge> edges;
  mesh.corners.reserve(indices.size());
  edges.reserve(indices.size());
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const std::uint32_t c[3] = {welded[indices[i]], welded[indices[i + 1]], welded[indices[i + 2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    const std::uint32_t triangle = std::uint32_t(mesh.corners.size() / 3);
    mesh.corners.insert(mesh.corners.end(), c, c + 3);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = c[k], b = c[(k + 1) % 3];
      edges.push_back({math::min(a, b), math::max(a, b), triangle, a > b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle < b.triangle;
  });
  Sets sets(mesh.corners.size() / 3);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    for (; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high; ++end)
      sets.join(edges[end - 1].triangle, edges[end].triangle);
    classify(mesh, std::span<const Edge>(edges).subspan(i, end - i));
    i = end;
  }
  mesh.component.resize(mesh.corners.size() / 3);
  for (std::uint32_t t = 0; t < mesh.component.size(); ++t) {
    const std::uint32_t first = sets.find(t);
    mesh.component[t] = first == t ? mesh.components++ : mesh.component[first];
  }
  return mesh;
}

}  // namespace carom::geometry::detail
