// Closed triangle meshes cut by planes. A vertex is on one side or the other, never on the plane, so that what is left
// is closed and manifold whenever the mesh was, whatever the rounding; the cut is closed by loops of new vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/blast/convex_cell.h"
#include "carom/core/result.h"

namespace carom::blast::detail {

struct CutMesh {
  struct Triangle {
    std::uint32_t corner[3];
    std::int32_t source;  ///< ≥ 0: triangle of the mesh; −1 − tag: the cut along the face with that tag
  };
  std::vector<math::Vec3d> vertices;
  std::vector<Triangle> triangles;
};

/// Vertices in one place become one, triangles without area go. Errors: what mesh_mass_properties refuses (open edges
/// and the like), edges where more than two triangles meet.
core::Result<CutMesh> closed_mesh(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices);

struct CutScratch {
  struct Crossing {
    std::uint32_t inside, outside;
    std::uint32_t vertex;
  };
  std::vector<double> distances;
  std::vector<Crossing> crossings;
  std::vector<std::uint32_t> next, remap;
  std::vector<CutMesh::Triangle> triangles;
};
/// Keeps what lies within the half-space (tag ≥ 0).
void cut_mesh(CutMesh& mesh, const HalfSpace& half_space, CutScratch& scratch);

/// Triangles of the polygons that loops of corners bound in the plane with the unit normal: outer loops run
/// counterclockwise seen against it, holes clockwise; adds them with their source.
void triangulate_loops(const std::vector<math::Vec3d>& vertices, std::vector<std::vector<std::uint32_t>>& loops,
                       math::Vec3d normal, std::int32_t source, std::vector<CutMesh::Triangle>& out);

/// Parts connected by corners; a part inside out (a cavity) goes with the one round it. Each with its own vertices.
std::vector<CutMesh> connected_parts(const CutMesh& mesh);

double volume_of(const CutMesh& mesh);

}  // namespace carom::blast::detail
