// Collision hulls of pieces.
#pragma once

#include "carom/blast/detail/mesh_cut.h"
#include "carom/blast/fracture.h"

namespace carom::blast::detail {

/// The skin, but at most a tenth of the cell's inner radius.
void add_hull(const ConvexCell& solid, math::Vec3d origin, math::Vec3d middle, double skin,
              std::vector<std::shared_ptr<const geometry::Hull>>& hulls);

struct HullRequest {
  const CutMesh* mesh;
  Piece* piece;
};
/// Hulls of all pieces of one cell, inside the cell and apart from each other.
void add_mesh_hulls(std::span<const HullRequest> requests, const ConvexCell& cell, const FractureOptions& options);

}  // namespace carom::blast::detail
