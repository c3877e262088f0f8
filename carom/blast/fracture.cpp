#include "carom/blast/fracture.h"

#include <algorithm>

#include "carom/blast/detail/mesh_cut.h"
#include "carom/blast/detail/piece_hulls.h"
#include "carom/blast/detail/solid_sum.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec2f;
using math::Vec3d;
using math::Vec3f;

namespace {

core::Status check(const FractureOptions& o) {
  if (!(o.skin >= 0 && o.skin <= 0.1)) return core::Error{core::refused("skin", o.skin, "0 to 0.1 m")};
  if (!math::is_finite(o.texture_scale)) return core::Error{"texture_scale is not finite"};
  if (!(o.least_solidity >= 0 && o.least_solidity <= 1))
    return core::Error{core::refused("least_solidity", o.least_solidity, "0 to 1")};
  if (o.max_hulls < 1 || o.max_hulls > 32) return core::Error{core::refused("max_hulls", o.max_hulls, "1 to 32")};
  return {};
}

/// Coordinates in the plane of a cut, the same seen from both sides.
struct CutTexture {
  Vec3d u, v;
  explicit CutTexture(Vec3d n) {
    const bool turned = n.x != 0 ? n.x < 0 : (n.y != 0 ? n.y < 0 : n.z < 0);
    if (turned) n = -n;
    u = normalize(perpendicular(n));
    v = cross(n, u);
  }
  Vec2f operator()(Vec3d p, double scale) const { return {float(scale * dot(p, u)), float(scale * dot(p, v))}; }
};

const ConvexCell::Face* face_of(const ConvexCell& cell, int tag) {
  for (const ConvexCell::Face& face : cell.faces())
    if (face.tag == tag) return &face;
  return nullptr;
}

/// A convex polygon in space, clipped by the faces of a cell but one.
void clip_polygon(std::vector<Vec3d>& polygon, const ConvexCell& cell, int without) {
  std::vector<Vec3d> kept;
  for (const ConvexCell::Face& face : cell.faces()) {
    if (face.tag == without) continue;
    kept.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double da = dot(face.normal, a) - face.offset, db = dot(face.normal, b) - face.offset;
      if (da <= 0) kept.push_back(a);
      if ((da <= 0) != (db <= 0)) kept.push_back(a + (da / (da - db)) * (b - a));
    }
    polygon.swap(kept);
    if (polygon.size() < 3) return polygon.clear();
  }
}

struct Patch {
  double area = 0;
  Vec3d moment{};
  void add(Vec3d a, Vec3d b, Vec3d c, Vec3d normal) {
    const double part = 0.5 * dot(cross(b - a, c - a), normal);
    area += part;
    moment += (part / 3) * (a + b + c);
  }
};

void add_bond(std::vector<Bond>& bonds, std::uint32_t a, std::uint32_t b, const Patch& patch, Vec3d normal) {
  if (!(patch.area > 1e-12)) return;
  Bond bond{a, b, patch.area, patch.moment / patch.area, normal};
  if (a > b) bond.a = b, bond.b = a, bond.normal = -normal;
  bonds.push_back(bond);
}

void add_convex_triangles(const ConvexCell& cell, double scale, Piece& piece) {
  piece.vertices.assign(cell.vertices().begin(), cell.vertices().end());
  std::size_t count = 0;
  for (const ConvexCell::Face& face : cell.faces()) count += face.count - 2;
  piece.triangles.reserve(3 * count), piece.sources.reserve(count), piece.texture.reserve(3 * count);
  for (const ConvexCell::Face& face : cell.faces()) {
    const auto loop = cell.loop(face);
    const CutTexture texture(face.normal);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      for (const std::uint16_t v : {loop[0], loop[k], loop[k + 1]}) {
        piece.triangles.push_back(v);
        piece.texture.push_back(texture(piece.vertices[v], scale));
      }
      piece.sources.push_back(-1 - face.tag);
    }
  }
}

/// The texture that the triangle of the solid has at a point in its plane.
Vec2f surface_texture(Vec3d p, Vec3d a, Vec3d b, Vec3d c, const Vec2f* corner) {
  const Vec3d n = cross(b - a, c - a);
  const double whole = length_squared(n);
  if (!(whole > 0)) return corner[0];
  const double wb = dot(cross(p - a, c - a), n) / whole, wc = dot(cross(b - a, p - a), n) / whole;
  return corner[0] + float(wb) * (corner[1] - corner[0]) + float(wc) * (corner[2] - corner[0]);
}

struct MeshPiece {
  detail::CutMesh mesh;
  std::vector<ConvexCell> solids;  // about the centre
};

bool within(const detail::CutMesh& mesh, std::int32_t source, Vec3d p, Vec3d n) {
  for (const auto& t : mesh.triangles) {
    if (t.source != source) continue;
    const Vec3d a = mesh.vertices[t.corner[0]], b = mesh.vertices[t.corner[1]], c = mesh.vertices[t.corner[2]];
    const double whole = dot(cross(b - a, c - a), n), slack = -1e-9 * math::abs(whole);
    if (dot(cross(b - a, p - a), n) >= slack && dot(cross(c - b, p - b), n) >= slack &&
        dot(cross(a - c, p - c), n) >= slack)
      return true;
  }
  return false;
}

/// Which pieces of the two cells meet along the cut, and where.
void bond_meshes(const Pattern& pattern, const Pattern::Meeting& meeting, std::span<const std::uint32_t> first,
                 std::span<const MeshPiece> meshes, std::vector<Bond>& bonds) {
  const ConvexCell::Face* face = face_of(pattern.cells[meeting.cell_a], meeting.tag_a);
  if (face == nullptr) return;
  const auto with_cut = [&](std::uint32_t cell, std::int32_t source) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t p = first[cell]; p < first[cell + 1]; ++p)
      for (const auto& t : meshes[p].mesh.triangles)
        if (t.source == source) {
          found.push_back(p);
          break;
        }
    return found;
  };
  const std::int32_t source_a = -1 - meeting.tag_a, source_b = -1 - meeting.tag_b;
  const std::vector<std::uint32_t> on_a = with_cut(meeting.cell_a, source_a), on_b = with_cut(meeting.cell_b, source_b);
  if (on_b.empty()) return;
  std::vector<Vec3d> polygon;
  for (const std::uint32_t a : on_a) {
    std::vector<Patch> patches(on_b.size());
    const detail::CutMesh& mesh = meshes[a].mesh;
    for (const auto& t : mesh.triangles) {
      if (t.source != source_a) continue;
      polygon = {mesh.vertices[t.corner[0]], mesh.vertices[t.corner[1]], mesh.vertices[t.corner[2]]};
      if (meeting.partial) clip_polygon(polygon, pattern.cells[meeting.cell_b], meeting.tag_b);
      Patch patch;
      for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
        patch.add(polygon[0], polygon[k], polygon[k + 1], face->normal);
      if (!(patch.area > 0)) continue;
      std::size_t which = 0;
      if (on_b.size() > 1) {
        const Vec3d middle = patch.moment / patch.area;
        while (which < on_b.size() && !within(meshes[on_b[which]].mesh, source_b, middle, -face->normal)) ++which;
        if (which == on_b.size()) continue;
      }
      patches[which].area += patch.area, patches[which].moment += patch.moment;
    }
    for (std::size_t k = 0; k < on_b.size(); ++k) add_bond(bonds, a, on_b[k], patches[k], face->normal);
  }
}

}  // namespace

core::Result<Fracture> fracture_convex(const Pattern& pattern, const FractureOptions& options) {
  if (auto s = check(options); !s) return s.error();
  Fracture fracture;
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> piece_of(pattern.cells.size(), none);
  std::vector<Piece> pieces(pattern.cells.size());
  core::SerialScheduler alone;
  core::TaskScheduler& threads = options.scheduler != nullptr ? *options.scheduler : alone;
  threads.parallel_for(int(pattern.cells.size()), 8, [&](int begin, int end, int) {
    for (std::uint32_t i = std::uint32_t(begin); i < std::uint32_t(end); ++i) {
      const ConvexCell& cell = pattern.cells[i];
      if (cell.empty()) continue;
      Piece& piece = pieces[i];
      piece.cell = i;
      piece.mass = cell.mass_properties(1);
      if (!(piece.mass.mass > 0)) continue;
      if (options.meshes) add_convex_triangles(cell, options.texture_scale, piece);
      if (options.hulls) detail::add_hull(cell, piece.mass.center, piece.mass.center, options.skin, piece.hulls);
    }
  });
  fracture.pieces.reserve(pattern.cells.size());
  for (std::uint32_t i = 0; i < pattern.cells.size(); ++i) {
    if (!(pieces[i].mass.mass > 0)) continue;
    piece_of[i] = std::uint32_t(fracture.pieces.size());
    fracture.pieces.push_back(std::move(pieces[i]));
  }
  std::vector<Vec3d> polygon;
  fracture.bonds.reserve(pattern.meetings.size());
  for (const Pattern::Meeting& m : pattern.meetings) {
    const std::uint32_t a = piece_of[m.cell_a], b = piece_of[m.cell_b];
    if (a == none || b == none) continue;
    const ConvexCell& cell = pattern.cells[m.cell_a];
    const ConvexCell::Face* face = face_of(cell, m.tag_a);
    if (face == nullptr || face_of(pattern.cells[m.cell_b], m.tag_b) == nullptr) continue;
    polygon.clear();
    for (const std::uint16_t v : cell.loop(*face)) polygon.push_back(cell.vertices()[v]);
    if (m.partial) clip_polygon(polygon, pattern.cells[m.cell_b], m.tag_b);
    Patch patch;
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
      patch.add(polygon[0], polygon[k], polygon[k + 1], face->normal);
    add_bond(fracture.bonds, a, b, patch, face->normal);
  }
  return fracture;
}

core::Result<Fracture> fracture_mesh(std::span<const Vec3d> vertices, std::span<const std::uint32_t> triangles,
                                     const Pattern& pattern, const FractureOptions& options,
                                     std::span<const Vec2f> texture) {
  if (auto s = check(options); !s) return s.error();
  if (!texture.empty() && texture.size() != triangles.size())
    return core::Error{core::text("fracture_mesh: ", texture.size(), " texture coordinates, expected ",
                                  triangles.size(), " (one a corner) or none")};
  const core::Result<detail::CutMesh> solid = detail::closed_mesh(vertices, triangles);
  if (!solid.ok()) return solid.error();
  std::vector<MeshPiece> meshes;
  std::vector<std::uint32_t> first(pattern.cells.size() + 1, 0);
  Fracture fracture;
  detail::CutScratch scratch;
  for (std::uint32_t i = 0; i < pattern.cells.size(); ++i) {
    detail::CutMesh mesh = *solid;
    if (pattern.cells[i].empty()) mesh.triangles.clear();
    for (const ConvexCell::Face& face : pattern.cells[i].faces())
      if (face.tag >= 0) detail::cut_mesh(mesh, {face.normal, face.offset, face.tag}, scratch);
    for (detail::CutMesh& part : detail::connected_parts(mesh)) {
      Piece piece;
      piece.cell = i;
      detail::SolidSum sum(part.vertices[0]);
      for (const auto& t : part.triangles)
        sum.add(part.vertices[t.corner[0]], part.vertices[t.corner[1]], part.vertices[t.corner[2]]);
      piece.mass = sum.properties(1);
      if (!(piece.mass.mass > 0)) continue;
      fracture.pieces.push_back(std::move(piece));
      meshes.push_back({std::move(part), {}});
    }
    first[i + 1] = std::uint32_t(meshes.size());
  }
  if (options.hulls)
    for (std::uint32_t i = 0; i < pattern.cells.size(); ++i) {
      std::vector<detail::HullRequest> requests;
      for (std::uint32_t p = first[i]; p < first[i + 1]; ++p)
        requests.push_back({&meshes[p].mesh, &fracture.pieces[p]});
      detail::add_mesh_hulls(requests, pattern.cells[i], options);
    }
  for (const Pattern::Meeting& m : pattern.meetings) bond_meshes(pattern, m, first, meshes, fracture.bonds);
  for (std::size_t p = 0; p < meshes.size() && options.meshes; ++p) {
    Piece& piece = fracture.pieces[p];
    piece.vertices = std::move(meshes[p].mesh.vertices);
    for (const auto& t : meshes[p].mesh.triangles) {
      piece.sources.push_back(t.source);
      const Vec3d a = piece.vertices[t.corner[0]], b = piece.vertices[t.corner[1]], c = piece.vertices[t.corner[2]];
      const ConvexCell::Face* face = t.source < 0 ? face_of(pattern.cells[piece.cell], -1 - t.source) : nullptr;
      const CutTexture cut(face != nullptr ? face->normal : normalize(cross(b - a, c - a)));
      for (const std::uint32_t v : t.corner) {
        piece.triangles.push_back(v);
        const std::size_t s = 3 * std::size_t(math::max(t.source, 0));
        piece.texture.push_back(t.source < 0 || texture.empty()
                                    ? cut(piece.vertices[v], options.texture_scale)
                                    : surface_texture(piece.vertices[v], vertices[triangles[s]],
                                                      vertices[triangles[s + 1]], vertices[triangles[s + 2]],
                                                      texture.data() + s));
      }
    }
  }
  return fracture;
}

ConvexCell container_of(std::span<const Vec3d> vertices) {
  if (vertices.empty()) return {};
  geometry::Bounds3d b{vertices[0], vertices[0]};
  for (const Vec3d& v : vertices) b = {min(b.low, v), max(b.high, v)};
  const Vec3d size = b.high - b.low;
  const double margin = 1e-3 * math::max(size.x, math::max(size.y, size.z));
  const Vec3d grown{margin, margin, margin};
  return ConvexCell(geometry::Bounds3d{b.low - grown, b.high + grown});
}

namespace {
std::vector<std::uint64_t> sides_of(const Piece& piece) {
  std::vector<std::uint64_t> sides;
  for (std::size_t t = 0; t + 2 < piece.triangles.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back(std::uint64_t(piece.triangles[t + k]) << 32 | piece.triangles[t + (k + 1) % 3]);
  std::sort(sides.begin(), sides.end());
  return sides;
}
}  // namespace

int euler_characteristic(const Piece& piece) {
  return int(piece.vertices.size()) - int(piece.triangles.size() / 2) + int(piece.triangles.size() / 3);
}

bool is_watertight(const Piece& piece) {
  const std::vector<std::uint64_t> sides = sides_of(piece);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i > 0 && sides[i] == sides[i - 1]) return false;
    if (!std::binary_search(sides.begin(), sides.end(), sides[i] << 32 | sides[i] >> 32)) return false;
  }
  return !sides.empty();
}

}  // namespace carom::blast
