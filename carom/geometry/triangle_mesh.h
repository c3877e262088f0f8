// Triangle meshes: collision surfaces with a bounding-volume tree.
#pragma once

#include "carom/geometry/shape3.h"
#include "carom/geometry/static_tree.h"

namespace carom::geometry {

/// What the shape of the surface is along a triangle's edge, so that flat and concave edges never push sideways.
enum EdgeFlags : std::uint8_t {
  edge0_flat = 1,
  edge1_flat = 2,
  edge2_flat = 4,  ///< flat or concave: no edge contact
  edge0_open = 8,
  edge1_open = 16,
  edge2_open = 32
};

/// Triangles are one-sided: counterclockwise seen from free space.
struct TriangleMesh {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;    ///< three a triangle
  std::vector<std::uint8_t> edge_flags;  ///< one a triangle; edge i runs from corner i to corner i + 1
  std::vector<std::uint8_t> materials;   ///< one a triangle, as the user numbers them; empty: all 0
  StaticTree tree;                       ///< over the triangles
  Bounds3f bounds;
  int triangle_count() const { return int(indices.size() / 3); }
};

/// `materials`: none, or one a triangle (rigid: ShapeDef::surfaces says what they are).
/// Errors: not finite, an index out of range, another number of materials, no triangle left after degenerate ones were
/// dropped.
CAROM_API core::Result<std::shared_ptr<const TriangleMesh>> make_triangle_mesh(
    std::vector<Vec3f> vertices, std::vector<std::uint32_t> indices, std::vector<std::uint8_t> materials = {});

}  // namespace carom::geometry
