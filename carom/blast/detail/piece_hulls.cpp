#include "carom/blast/detail/piece_hulls.h"

#include "carom/geometry/decomposition.h"
#include "carom/math/elementary.h"

namespace carom::blast::detail {

using math::Vec3d;
using math::Vec3f;

void add_hull(const ConvexCell& solid, Vec3d origin, Vec3d middle, double skin,
              std::vector<std::shared_ptr<const geometry::Hull>>& hulls) {
  if (solid.empty()) return;
  double inner = 1e300;
  for (const ConvexCell::Face& face : solid.faces()) inner = math::min(inner, face.offset - dot(face.normal, middle));
  if (auto hull = make_cell_hull(solid, origin, math::min(skin, 0.1 * math::max(inner, 0.0))))
    hulls.push_back(std::move(hull));
}

namespace {

/// Convex solids about the piece's centre that stand for it.
std::vector<ConvexCell> solids_of(const HullRequest& request, const FractureOptions& options) {
  std::vector<ConvexCell> solids;
  const Vec3d center = request.piece->mass.center;
  std::vector<Vec3f> points;
  for (const Vec3d& v : request.mesh->vertices) points.push_back(Vec3f(v - center));
  geometry::HullOptions hull_options;
  hull_options.simplify = true;
  hull_options.max_vertices = 48;
  const auto hull = geometry::make_hull(points, hull_options);
  if (!hull.ok()) return solids;
  if (request.piece->mass.mass < options.least_solidity * double((*hull)->volume) && options.max_hulls > 1) {
    std::vector<std::uint32_t> indices;
    for (const CutMesh::Triangle& t : request.mesh->triangles)
      indices.insert(indices.end(), {t.corner[0], t.corner[1], t.corner[2]});
    geometry::DecompositionOptions decomposition;
    decomposition.max_parts = options.max_hulls;
    decomposition.resolution = 12;
    decomposition.concavity = 0.05f;
    decomposition.max_vertices = 24;
    const auto parts = geometry::decompose_convex(points, indices, decomposition);
    if (parts.ok())
      for (const auto& part : *parts) solids.emplace_back(*part);
  }
  if (solids.empty()) solids.emplace_back(**hull);
  return solids;
}

}  // namespace

void add_mesh_hulls(std::span<const HullRequest> requests, const ConvexCell& cell, const FractureOptions& options) {
  std::vector<std::vector<ConvexCell>> solids;
  ConvexCell::Scratch scratch;
  for (const HullRequest& request : requests) {
    solids.push_back(solids_of(request, options));
    // What a decomposition or a float let out goes back inside.
    for (ConvexCell& solid : solids.back())
      for (const ConvexCell::Face& face : cell.faces())
        if (face.tag >= 0 && !solid.empty())
          solid.clip({face.normal, face.offset - dot(face.normal, request.piece->mass.center), face.tag}, scratch);
  }
  // Pieces of one cell (two walls of a vase) have no cut between them: a plane keeps their hulls apart.
  for (std::size_t i = 0; i < requests.size(); ++i)
    for (std::size_t j = i + 1; j < requests.size(); ++j) {
      const Vec3d a = requests[i].piece->mass.center, b = requests[j].piece->mass.center;
      const Vec3d n = normalize(b - a);
      double end = -1e300, begin = 1e300;
      for (const ConvexCell& s : solids[i])
        for (const Vec3d& v : s.vertices()) end = math::max(end, dot(n, v + a));
      for (const ConvexCell& s : solids[j])
        for (const Vec3d& v : s.vertices()) begin = math::min(begin, dot(n, v + b));
      if (!(end > begin)) continue;
      const double middle = 0.5 * (end + begin);
      for (ConvexCell& s : solids[i])
        if (!s.empty()) s.clip({n, middle - dot(n, a), 0}, scratch);
      for (ConvexCell& s : solids[j])
        if (!s.empty()) s.clip({-n, -middle + dot(n, b), 0}, scratch);
    }
  for (std::size_t i = 0; i < requests.size(); ++i)
    for (const ConvexCell& s : solids[i])
      add_hull(s, {}, s.mass_properties(1).center, options.skin, requests[i].piece->hulls);
}

}  // namespace carom::blast::detail
