#include "carom/geometry/detail/surface.h"

namespace carom::geometry::detail {

namespace {

using VisitGroup = core::FunctionRef<bool(const TriangleGroup&, std::uint32_t)>;

/// Triangles of a mesh lie anywhere in memory: some are called for before the first of them is met.
class MeshVisit {
 public:
  MeshVisit(const TriangleMesh& mesh, const Bounds3f& box, VisitGroup visit)
      : mesh_(mesh), box_(box), visit_(visit), load_(triangle_kernels().load) {}

  bool add(const std::uint32_t* items, int count) {
    for (int i = 0; i < count; ++i) {
      __builtin_prefetch(&mesh_.indices[3 * items[i]]);
      list_[count_++] = items[i];
    }
    return count_ <= room - 4 || meet();
  }
  bool meet() {
    const int count = count_;
    count_ = 0;
    TriangleGroup group;
    for (int k = 0; k < count; k += TriangleGroup::lanes) {
      const std::uint32_t lanes = load_(&mesh_.vertices[0].x, mesh_.indices.data(), list_ + k,
                                        min(count - k, TriangleGroup::lanes), box_.low, box_.high, group);
      if (lanes != 0 && !visit_(group, lanes)) return false;
    }
    return true;
  }

 private:
  static constexpr int room = 64;
  const TriangleMesh& mesh_;
  Bounds3f box_;
  VisitGroup visit_;
  decltype(TriangleKernels::load) load_;
  int count_ = 0;
  std::uint32_t list_[room];
};

void visit_mesh(const TriangleMesh& mesh, const Bounds3f& box, VisitGroup visit) {
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

void visit_groups(const Shape3& surface, const Bounds3f& box, bool with_edges, VisitGroup visit) {
  if (surface.type == ShapeType3::mesh) return visit_mesh(*surface.mesh, box, visit);
  TriangleGroup group;
  int count = 0;
  bool more = true;
  const auto meet = [&] {
    const int lanes = count;
    for (; count < TriangleGroup::lanes; ++count)
      for (auto& corner : group.corner)
        for (auto& row : corner) row[count] = row[lanes - 1];
    count = 0;
    return more = visit(group, (1u << lanes) - 1);
  };
  visit_triangles(surface, box, with_edges, [&](const SurfaceTriangle& t) {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) group.corner[c][k][count] = t.corner[c][k];
    group.index[count] = t.index, group.edges[count] = t.edges, group.material[count] = t.material;
    return ++count < TriangleGroup::lanes || meet();
  });
  if (more && count > 0) meet();
}

SurfaceTriangle triangle_of(const Shape3& surface, const TriangleGroup& group, int lane) {
  if (surface.type == ShapeType3::mesh) return triangle_of(*surface.mesh, group.index[lane]);
  SurfaceTriangle t;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) t.corner[c][k] = group.corner[c][k][lane];
  t.edges = group.edges[lane], t.material = group.material[lane], t.index = group.index[lane];
  return t;
}

void visit_triangles(const Shape3& surface, const Bounds3f& box, bool with_edges,
                     core::FunctionRef<bool(const SurfaceTriangle&)> visit) {
  if (surface.type == ShapeType3::mesh)
    return visit_mesh(*surface.mesh, box, [&](const TriangleGroup& group, std::uint32_t lanes) {
      for (; lanes != 0; lanes &= lanes - 1)
        if (!visit(triangle_of(*surface.mesh, group.index[__builtin_ctz(lanes)]))) return false;
      return true;
    });
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
