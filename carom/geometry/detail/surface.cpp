#include "carom/geometry/detail/surface.h"

namespace carom::geometry::detail {

using VisitTriangle = core::FunctionRef<bool(const SurfaceTriangle&)>;

namespace {

/// In three of four lanes.
Four lanes_of(Vec3f p) { return {Four::Vector{p.x, p.y, p.z, 0}}; }

/// Triangles of a mesh lie anywhere in memory: some are called for before the first of them is met.
class MeshVisit {
 public:
  MeshVisit(const TriangleMesh& mesh, const Bounds3f& box, VisitTriangle visit)
      : mesh_(mesh), low_(lanes_of(box.low)), high_(lanes_of(box.high)), visit_(visit) {}

  bool add(const std::uint32_t* items, int count) {
    for (int i = 0; i < count; ++i) {
      __builtin_prefetch(&mesh_.indices[3 * items[i]]);
      __builtin_prefetch(&mesh_.edge_flags[items[i]]);
      list_[count_++] = items[i];
    }
    return count_ <= room - 4 || meet();
  }
  bool meet() {
    for (int k = 0; k < count_; ++k)
      for (std::uint32_t corner = 0; corner < 3; ++corner) __builtin_prefetch(&vertex(list_[k], corner));
    const int count = count_;
    count_ = 0;
    for (int k = 0; k < count; ++k) {
      const Four p = lanes_of(vertex(list_[k], 0)), q = lanes_of(vertex(list_[k], 1)),
                 r = lanes_of(vertex(list_[k], 2));
      const auto meets = (min(p, min(q, r)) <= high_) & (max(p, max(q, r)) >= low_);
      if (bitmask(meets) == 0xf && !visit_(triangle_of(mesh_, list_[k]))) return false;
    }
    return true;
  }

 private:
  static constexpr int room = 64;
  const Vec3f& vertex(std::uint32_t triangle, std::uint32_t corner) const {
    return mesh_.vertices[mesh_.indices[3 * triangle + corner]];
  }
  const TriangleMesh& mesh_;
  Four low_, high_;
  VisitTriangle visit_;
  int count_ = 0;
  std::uint32_t list_[room];
};

void visit_mesh(const TriangleMesh& mesh, const Bounds3f& box, VisitTriangle visit) {
  MeshVisit all(mesh, box, visit);
  const auto add = [&](const std::uint32_t* items, int count) { return all.add(items, count); };
  std::uint32_t leaves[64];
  const int count = list_leaves(mesh.tree, box, leaves);
  bool more = true;
  if (count < 0) query_leaves(mesh.tree, box, [&](const std::uint32_t* items, int n) { return more = add(items, n); });
  for (int i = 0; i < count && more; ++i) more = look_at_leaf(mesh.tree, leaves[i], add);
  if (more) all.meet();
}

}  // namespace

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
