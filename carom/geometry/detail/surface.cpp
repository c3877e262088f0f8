#include "carom/geometry/detail/surface.h"

namespace carom::geometry::detail {

using VisitTriangle = core::FunctionRef<bool(const SurfaceTriangle&)>;

/// Triangles of a mesh lie anywhere in memory: some are called for before the first of them is met.
static void visit_mesh(const TriangleMesh& mesh, const Bounds3f& box, VisitTriangle visit) {
  constexpr int room = 32;
  std::uint32_t list[room];
  int count = 0;
  bool more = true;
  const auto meet = [&] {
    for (int k = 0; k < count; ++k)
      for (std::uint32_t corner = 0; corner < 3; ++corner)
        __builtin_prefetch(&mesh.vertices[mesh.indices[3 * list[k] + corner]]);
    for (int k = 0; k < count && more; ++k) {
      const SurfaceTriangle t = triangle_of(mesh, list[k]);
      const Bounds3f b{min(t.corner[0], min(t.corner[1], t.corner[2])),
                       max(t.corner[0], max(t.corner[1], t.corner[2]))};
      if (boxes_meet(b, box)) more = visit(t);
    }
    count = 0;
    return more;
  };
  query(mesh.tree, box, [&](std::uint32_t i) {
    __builtin_prefetch(&mesh.indices[3 * i]);
    __builtin_prefetch(&mesh.edge_flags[i]);
    list[count++] = i;
    return count < room || meet();
  });
  if (more) meet();
}

void visit_triangles(const Shape3& surface, const Bounds3f& box, bool with_edges, VisitTriangle visit) {
  if (surface.type == ShapeType3::mesh) return visit_mesh(*surface.mesh, box, visit);
  if (surface.type == ShapeType3::voxels) {
    visit_voxel_faces(*surface.voxels, box, [&](const VoxelFace& face) {
      for (int k = 0; k < 2; ++k)
        if (!visit(triangle_of(face, k))) return false;
      return true;
    });
    return;
  }
  const HeightFieldCells cells{*surface.height_field};
  const HeightField& f = cells.field;
  if (box.low.y > f.high) return;
  const auto cell_at = [](float x, float size, int count) {
    return int(clamp(x / size, -1.0f, float(count)) + 1) - 1;  // rounds down, from −1 to count
  };
  const int i0 = max(cell_at(box.low.x, f.cell.x, cells.columns()), 0);
  const int i1 = min(cell_at(box.high.x, f.cell.x, cells.columns()), cells.columns() - 1);
  const int j0 = max(cell_at(box.low.z, f.cell.y, cells.rows()), 0);
  const int j1 = min(cell_at(box.high.z, f.cell.y, cells.rows()), cells.rows() - 1);
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      if (!cells.exists(i, j)) continue;
      for (int k = 0; k < 2; ++k) {
        const SurfaceTriangle t = cells.triangle(i, j, k, false);
        if (min(t.corner[0].y, min(t.corner[1].y, t.corner[2].y)) > box.high.y ||
            max(t.corner[0].y, max(t.corner[1].y, t.corner[2].y)) < box.low.y)
          continue;
        if (!visit(with_edges ? cells.triangle(i, j, k, true) : t)) return;
      }
    }
}

}  // namespace carom::geometry::detail
