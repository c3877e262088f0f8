// The triangles of a mesh, height field or voxel grid near a box, each with what its edges are.
#pragma once

#include "carom/core/function_ref.h"
#include "carom/geometry/detail/tree_build.h"
#include "carom/geometry/detail/triangle_groups.h"
#include "carom/geometry/detail/voxel_faces.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/tree_walk.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::geometry::detail {

struct SurfaceTriangle {
  Vec3f corner[3];
  std::uint8_t edges = 0;     ///< EdgeFlags
  std::uint8_t material = 0;  ///< as its maker numbered it
  std::uint32_t index = 0;
};

inline SurfaceTriangle triangle_of(const TriangleMesh& mesh, std::uint32_t i) {
  SurfaceTriangle t;
  for (std::uint32_t k = 0; k < 3; ++k) t.corner[k] = mesh.vertices[mesh.indices[3 * i + k]];
  t.edges = mesh.edge_flags[i];
  if (!mesh.materials.empty()) t.material = mesh.materials[i];
  t.index = i;
  return t;
}

/// Triangle 2·cell is (i, j), (i + 1, j + 1), (i + 1, j); triangle 2·cell + 1 is (i, j), (i, j + 1), (i + 1, j + 1).
struct HeightFieldCells {
  const HeightField& field;

  int columns() const { return field.columns - 1; }
  int rows() const { return field.rows - 1; }
  bool exists(int i, int j) const {
    return i >= 0 && j >= 0 && i < columns() && j < rows() &&
           (field.holes.empty() || field.holes[std::size_t(j) * std::size_t(columns()) + std::size_t(i)] == 0);
  }
  Vec3f vertex(int i, int j) const {
    return {float(i) * field.cell.x, field.heights[std::size_t(j) * std::size_t(field.columns) + std::size_t(i)],
            float(j) * field.cell.y};
  }
  SurfaceTriangle triangle(int i, int j, int k, bool with_edges) const {
    SurfaceTriangle t;
    t.index = 2 * (std::uint32_t(j) * std::uint32_t(columns()) + std::uint32_t(i)) + std::uint32_t(k);
    t.corner[0] = vertex(i, j);
    t.corner[1] = k == 0 ? vertex(i + 1, j + 1) : vertex(i, j + 1);
    t.corner[2] = k == 0 ? vertex(i + 1, j) : vertex(i + 1, j + 1);
    if (!with_edges) return t;
    if (!field.materials.empty()) t.material = field.materials[t.index / 2];
    const Vec3f n = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
    // The far corners of the three neighbours, and the cells in which they lie.
    const int far[2][3][2] = {{{i, j + 1}, {i + 2, j + 1}, {i, j - 1}}, {{i - 1, j}, {i + 1, j + 2}, {i + 1, j}}};
    const int cell[2][3][2] = {{{i, j}, {i + 1, j}, {i, j - 1}}, {{i - 1, j}, {i, j + 1}, {i, j}}};
    for (int e = 0; e < 3; ++e) {
      if (!exists(cell[k][e][0], cell[k][e][1])) {
        t.edges = std::uint8_t(t.edges | edge0_open << e);
        continue;
      }
      const Vec3f d = vertex(far[k][e][0], far[k][e][1]) - t.corner[e];
      // Not below the plane by more than 1° of its distance.
      if (dot(d, n) >= -0.0174524f * length(d) * length(n)) t.edges = std::uint8_t(t.edges | edge0_flat << e);
    }
    return t;
  }
};

/// One half of a face of a cell: its diagonal stands out nowhere.
inline SurfaceTriangle triangle_of(const VoxelFace& face, int k) {
  SurfaceTriangle t;
  t.corner[0] = face.corner[0], t.corner[1] = face.corner[k == 0 ? 1 : 2], t.corner[2] = face.corner[k == 0 ? 2 : 3];
  const bool flat[3] = {k == 0 ? face.flat[0] : true, face.flat[k == 0 ? 1 : 2], k == 0 ? true : face.flat[3]};
  for (int e = 0; e < 3; ++e)
    if (flat[e]) t.edges = std::uint8_t(t.edges | edge0_flat << e);
  t.material = face.material;
  t.index = face.name + std::uint32_t(k);
  return t;
}

/// Calls visit (false: stop) for the triangles whose boxes meet `box`, with what their edges are if it is asked for.
void visit_triangles(const Shape3& surface, const Bounds3f& box, bool with_edges,
                     core::FunctionRef<bool(const SurfaceTriangle&)> visit);
/// The same by eight: visit (false: stop) is told which lanes' triangles meet `box`.
void visit_groups(const Shape3& surface, const Bounds3f& box, bool with_edges,
                  core::FunctionRef<bool(const TriangleGroup&, std::uint32_t lanes)> visit);
inline std::uint8_t edges_of(const Shape3& surface, const TriangleGroup& group, int lane) {
  return surface.type == ShapeType3::mesh ? surface.mesh->edge_flags[group.index[lane]] : group.edges[lane];
}
SurfaceTriangle triangle_of(const Shape3& surface, const TriangleGroup& group, int lane);

}  // namespace carom::geometry::detail
