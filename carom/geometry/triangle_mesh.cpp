#include "carom/geometry/triangle_mesh.h"

#include <algorithm>

#include "carom/geometry/detail/text.h"
#include "carom/geometry/detail/weld.h"

namespace carom::geometry {

namespace {

namespace mesh_edges {

// Edges whose faces turn by less than this count as flat: sin 1°.
constexpr double flat = 0.0174524;

struct Edge {
  std::uint32_t low, high;  // welded corners
  std::uint32_t triangle;
  std::uint8_t side;
  bool reversed;
};

bool before(const Edge& a, const Edge& b) {
  if (a.low != b.low) return a.low < b.low;
  if (a.high != b.high) return a.high < b.high;
  if (a.triangle != b.triangle) return a.triangle < b.triangle;
  return a.side < b.side;
}

Vec3d corner(const TriangleMesh& mesh, std::uint32_t triangle, std::uint32_t k) {
  return Vec3d(mesh.vertices[mesh.indices[3 * triangle + k % 3]]);
}

// True where the neighbour's far corner does not lie below the triangle's plane by more than the flat angle.
bool flat_or_concave(const TriangleMesh& mesh, const Edge& e, const Edge& other) {
  const Vec3d a = corner(mesh, e.triangle, e.side), b = corner(mesh, e.triangle, e.side + 1u);
  const Vec3d normal = normalize(cross(b - a, corner(mesh, e.triangle, e.side + 2u) - a));
  const Vec3d far = corner(mesh, other.triangle, other.side + 2u) - a;
  const Vec3d along = normalize(b - a);
  const double reach = length(far - dot(far, along) * along);
  return dot(far, normal) >= -flat * reach;
}

void set_flags(TriangleMesh& mesh) {
  const std::vector<std::uint32_t> welded = detail::weld_equal(std::span<const Vec3f>(mesh.vertices));
  const std::uint32_t triangles = std::uint32_t(mesh.triangle_count());
  std::vector<Edge> edges;
  edges.reserve(3 * std::size_t(triangles));
  for (std::uint32_t t = 0; t < triangles; ++t)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[mesh.indices[3 * t + k]], b = welded[mesh.indices[3 * t + (k + 1u) % 3]];
      edges.push_back({min(a, b), max(a, b), t, k, a > b});
    }
  std::sort(edges.begin(), edges.end(), before);
  mesh.edge_flags.assign(triangles, 0);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i == 1) {
      mesh.edge_flags[edges[i].triangle] |= std::uint8_t(edge0_open << edges[i].side);
    } else if (end - i == 2 && edges[i].reversed != edges[i + 1].reversed &&
               flat_or_concave(mesh, edges[i], edges[i + 1])) {
      mesh.edge_flags[edges[i].triangle] |= std::uint8_t(edge0_flat << edges[i].side);
      mesh.edge_flags[edges[i + 1].triangle] |= std::uint8_t(edge0_flat << edges[i + 1].side);
    }
    i = end;
  }
}

// Triangles that have no area have no normal.
bool degenerate(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d u = Vec3d(b) - Vec3d(a), v = Vec3d(c) - Vec3d(a), w = v - u;
  const double longest = max(dot(u, u), max(dot(v, v), dot(w, w)));
  return !(length(cross(u, v)) > 1e-7 * longest);
}

}  // namespace mesh_edges

/// The first `count` of a list, in no more memory than they need.
template <class T>
std::vector<T> exactly(std::vector<T> list, std::size_t count) {
  if (list.size() == count && list.capacity() == count) return list;
  return {list.begin(), list.begin() + std::ptrdiff_t(count)};
}

}  // namespace

core::Result<std::shared_ptr<const TriangleMesh>> make_triangle_mesh(std::vector<Vec3f> vertices,
                                                                     std::vector<std::uint32_t> indices,
                                                                     std::vector<std::uint8_t> materials) {
  constexpr std::size_t max_triangles = std::size_t(1) << 29;
  if (indices.empty() || indices.size() % 3 != 0 || indices.size() / 3 > max_triangles)
    return detail::error("make_triangle_mesh: %zu indices, expected three a triangle, from 1 to %zu triangles",
                         indices.size(), max_triangles);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (auto s = detail::check_point("it", vertices[i], max_shape_size); !s)
      return detail::error("make_triangle_mesh: vertex %zu: %s", i, s.error().message.c_str());
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= vertices.size())
      return detail::error("make_triangle_mesh: triangle %zu refers to vertex %u of %zu", i / 3, indices[i],
                           vertices.size());
  if (!materials.empty() && materials.size() != indices.size() / 3)
    return detail::error("make_triangle_mesh: %zu materials, expected none or one a triangle, %zu", materials.size(),
                         indices.size() / 3);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = std::move(vertices);
  const std::size_t all = indices.size() / 3;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all; ++i) {
    const std::uint32_t corner[3] = {indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]};
    if (mesh_edges::degenerate(mesh->vertices[corner[0]], mesh->vertices[corner[1]], mesh->vertices[corner[2]]))
      continue;
    for (std::size_t k = 0; k < 3; ++k) indices[3 * kept + k] = corner[k];
    if (!materials.empty()) materials[kept] = materials[i];
    ++kept;
  }
  if (kept == 0) return detail::error("make_triangle_mesh: none of the %zu triangles has an area", all);
  mesh->indices = exactly(std::move(indices), 3 * kept);
  if (!materials.empty()) mesh->materials = exactly(std::move(materials), kept);
  mesh_edges::set_flags(*mesh);
  std::vector<detail::BuildItem<Vec3f>> items(kept);  // only now: a large mesh needs the most memory while it is built
  for (std::size_t i = 0; i < kept; ++i) {
    const Vec3f a = mesh->vertices[mesh->indices[3 * i]], b = mesh->vertices[mesh->indices[3 * i + 1]],
                c = mesh->vertices[mesh->indices[3 * i + 2]];
    items[i] = {{min(a, min(b, c)), max(a, max(b, c))}, std::uint32_t(i)};
  }
  mesh->bounds = items[0].box;
  for (const auto& item : items) mesh->bounds = merge(mesh->bounds, item.box);
  mesh->tree = detail::build_static_tree(std::move(items));
  return std::shared_ptr<const TriangleMesh>(std::move(mesh));
}

}  // namespace carom::geometry
