// Volume integrals of closed surfaces by the divergence theorem: every triangle and a common point span a tetrahedron.
#include "carom/geometry/detail/mesh_topology.h"
#include "carom/geometry/detail/text.h"
#include "carom/geometry/detail/volume_integrals.h"
#include "carom/geometry/tree_walk.h"
#include "carom/math/elementary.h"

namespace carom::geometry {

namespace {

namespace mesh_mass {

struct Piece {
  double volume = 0;
  std::uint32_t begin = 0, end = 0;  // in Mesh::order
  Bounds3d bounds{};
};

core::Error edge_error(const char* what, std::size_t count, std::span<const Vec3d> vertices,
                       const std::uint32_t (&edge)[2]) {
  const Vec3d a = vertices[edge[0]], b = vertices[edge[1]];
  return detail::error("the mesh is not a solid: %zu %s, the first from (%g, %g, %g) to (%g, %g, %g)", count, what, a.x,
                       a.y, a.z, b.x, b.y, b.z);
}

struct Mesh {
  std::vector<Vec3d> points;  // relative to a point in the middle, which keeps the sums accurate
  detail::MeshTopology topology;
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> order;  // triangles, piece by piece

  const Vec3d& corner(std::size_t triangle, std::size_t k) const { return points[topology.corners[3 * triangle + k]]; }
};

void find_pieces(Mesh& mesh) {
  const std::vector<std::uint32_t>& component = mesh.topology.component;
  mesh.pieces.resize(mesh.topology.components);
  for (const std::uint32_t k : component) ++mesh.pieces[k].end;
  std::uint32_t count = 0;
  for (Piece& piece : mesh.pieces) {
    piece.begin = count;
    count += piece.end;
    piece.end = piece.begin;
  }
  mesh.order.resize(component.size());
  for (std::uint32_t t = 0; t < component.size(); ++t) {
    const Vec3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    Piece& piece = mesh.pieces[component[t]];
    const Bounds3d box{min(a, min(b, c)), max(a, max(b, c))};
    piece.bounds = piece.end == piece.begin ? box : merge(piece.bounds, box);
    piece.volume += triple(a, b, c) / 6;
    mesh.order[piece.end++] = t;
  }
}

// How often a piece goes round p: the sum of its triangles' solid angles (Van Oosterom and Strackee 1983).
double winding(const Mesh& mesh, const Piece& piece, Vec3d p) {
  double sum = 0;
  for (std::uint32_t i = piece.begin; i < piece.end; ++i) {
    const std::uint32_t t = mesh.order[i];
    const Vec3d a = mesh.corner(t, 0) - p, b = mesh.corner(t, 1) - p, c = mesh.corner(t, 2) - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * math::atan2(triple(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * pi);
}

core::Status sort_out_pieces(const Mesh& mesh, Vec3d origin, MeshMass& out) {
  if (mesh.pieces.size() < 2) return {};
  std::vector<Bounds3f> boxes;
  for (const Piece& piece : mesh.pieces) {
    const float slack = 1e-6f * float(length(piece.bounds.high) + length(piece.bounds.low));
    boxes.push_back(grow(Bounds3f{Vec3f(piece.bounds.low), Vec3f(piece.bounds.high)}, slack));
  }
  const StaticTree tree = build_static_tree(boxes);
  constexpr std::uint64_t most_work = 1u << 30;
  std::uint64_t work = 0;
  for (std::uint32_t k = 0; k < mesh.pieces.size(); ++k) {
    const Piece& piece = mesh.pieces[k];
    const std::uint32_t t = mesh.order[piece.begin];
    const Vec3d p = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    double turns = 0;
    query(tree, Bounds3f{Vec3f(p), Vec3f(p)}, [&](std::uint32_t other) {
      const Piece& round = mesh.pieces[other];
      work += round.end - round.begin;
      if (other != k && work < most_work && contains(round.bounds, Bounds3d{p, p})) turns += winding(mesh, round, p);
      return true;
    });
    if (work >= most_work)
      return detail::error("the mesh is %zu pieces so deeply inside each other that cavities cannot be told apart",
                           mesh.pieces.size());
    const bool inside = turns > 0.5;
    if (piece.volume < 0 && !inside)
      return detail::error("the mesh is not a solid: its piece %u of %zu, at (%g, %g, %g), is inside out and no cavity",
                           k + 1, mesh.pieces.size(), p.x + origin.x, p.y + origin.y, p.z + origin.z);
    if (inside) ++(piece.volume < 0 ? out.cavities : out.overlapping);
  }
  return {};
}

core::Status check_input(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices, double density) {
  constexpr std::size_t max_triangles = std::size_t(1) << 28;
  if (!(density > 0) || !is_finite(density))
    return detail::error("density is %g kg/m³: expected a positive number", density);
  if (indices.empty() || indices.size() % 3 != 0 || indices.size() / 3 > max_triangles)
    return detail::error("the mesh has %zu indices: expected three a triangle, from 1 to %zu triangles", indices.size(),
                         max_triangles);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d p = abs(vertices[i]);
    if (!(max(p.x, max(p.y, p.z)) <= 1e12) || !is_finite(p))
      return detail::error("vertex %zu of the mesh is (%g, %g, %g): expected finite coordinates of at most 1e12 m", i,
                           vertices[i].x, vertices[i].y, vertices[i].z);
  }
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] >= vertices.size())
      return detail::error("triangle %zu of the mesh refers to vertex %u of %zu", i / 3, indices[i], vertices.size());
  return {};
}

}  // namespace mesh_mass

}  // namespace

core::Result<MeshMass> mesh_mass_properties(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices,
                                            double density) {
  using namespace mesh_mass;
  if (auto s = check_input(vertices, indices, density); !s) return s.error();
  MeshMass out;
  out.bounds = {vertices[indices[0]], vertices[indices[0]]};
  for (const std::uint32_t i : indices)
    out.bounds = {min(out.bounds.low, vertices[i]), max(out.bounds.high, vertices[i])};
  const Vec3d origin = out.bounds.center();
  const double size = length(out.bounds.high - out.bounds.low);

  Mesh mesh;
  mesh.topology = detail::connect(vertices, indices, 0);
  if (mesh.topology.open > 0 && size > 0) mesh.topology = detail::connect(vertices, indices, 1e-6 * size);
  const detail::MeshTopology& topology = mesh.topology;
  if (topology.component.empty()) return detail::error("the mesh has no triangle with an area");
  if (topology.open > 0)
    return edge_error("open edges (one triangle only)", topology.open, vertices, topology.open_edge);
  if (topology.unbalanced > 0)
    return edge_error("edges used by more triangles one way than the other", topology.unbalanced, vertices,
                      topology.unbalanced_edge);
  if (topology.against > 0)
    return edge_error("edges whose two triangles are wound against each other", topology.against, vertices,
                      topology.against_edge);

  mesh.points.reserve(vertices.size());
  for (const Vec3d& v : vertices) mesh.points.push_back(v - origin);
  detail::VolumeIntegrals sum;
  for (std::uint32_t t = 0; t < topology.component.size(); ++t) {
    const Vec3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    sum.add_tetrahedron(a, b, c);
    out.area += length(cross(b - a, c - a)) / 2;
  }
  // A surface of this area could enclose area^1.5/√(36π); far less than that is rounding.
  const double noise = 1e-12 * out.area * math::sqrt(out.area);
  if (!(abs(sum.volume) > noise))
    return detail::error("the mesh encloses no volume: %g m³ within %g m²", sum.volume, out.area);
  if (sum.volume < 0)
    return detail::error("the mesh is inside out: its volume is %g m³, its triangles run clockwise seen from outside",
                         sum.volume);
  find_pieces(mesh);
  if (auto s = sort_out_pieces(mesh, origin, out); !s) return s.error();

  out.properties = detail::mass_of(sum, density);
  out.properties.center += origin;
  out.volume = sum.volume;
  out.triangles = int(topology.component.size());
  out.components = int(topology.components);
  out.non_manifold_edges = int(topology.non_manifold);
  return out;
}

}  // namespace carom::geometry
