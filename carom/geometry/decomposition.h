// Concave closed meshes as a few convex parts, for bodies that move.
#pragma once

#include "carom/geometry/hull.h"

namespace carom::geometry {

struct DecompositionOptions {
  int max_parts = 16;       ///< 1 to 256
  int resolution = 32;      ///< cells along the longest side, 4 to 128: parts follow the mesh to about half a cell
  float concavity = 0.02f;  ///< of the mesh's volume, 0 to 1: a part whose hull adds less is not cut any more
  int max_vertices = 64;    ///< of a part, 8 to 255
};

/// Fills the mesh with cubic cells and cuts them along planes of the grid, the part with the most air in its hull
/// first, each at the plane that leaves the least; the parts' hulls come back, largest first. (The idea of a
/// volumetric, hierarchical decomposition is Mamou's, "Volumetric hierarchical approximate convex decomposition",
/// 2016.) The same on every machine. Triangles are counterclockwise seen from outside.
/// Errors: what mesh_mass_properties refuses (numbers not finite, indices out of range, open edges), no cell inside.
CAROM_API core::Result<std::vector<std::shared_ptr<const Hull>>> decompose_convex(
    std::span<const Vec3f> vertices, std::span<const std::uint32_t> indices, const DecompositionOptions& options = {});

}  // namespace carom::geometry
