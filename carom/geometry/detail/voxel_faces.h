// The faces between filled and empty cells as triangles, each with what its edges are.
#pragma once

#include "carom/geometry/triangle_mesh.h"
#include "carom/geometry/voxels.h"

namespace carom::geometry::detail {

/// Face 2·axis + (0: outward along +axis, 1: along −axis) of a cell; a triangle is named (12·cell + 2·face + k).
struct VoxelFace {
  int axis, sign;
  Vec3f corner[4];     ///< counterclockwise seen from outside
  bool flat[4];        ///< edge i, from corner i: the surface goes on level or rises: nothing stands out
  std::uint32_t name;  ///< of its first triangle
  std::uint8_t material;
};

/// Which cells along an axis meet the range: [first, last], within the grid.
inline void cells_between(float low, float high, float cell, int count, int& first, int& last) {
  first = int(clamp(low / cell, 0.0f, float(count)));
  last = min(int(clamp(high / cell, -1.0f, float(count))), count - 1);
  if (high < 0) last = -1;
}

inline void make_voxel_face(const VoxelGrid& grid, const int (&c)[3], int axis, int sign, VoxelFace& face) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int beyond[3] = {c[0], c[1], c[2]};
  beyond[axis] += sign;
  const auto corner = [&](int du, int dv) {
    Vec3f p;
    p[axis] = float(c[axis] + (sign > 0 ? 1 : 0)) * grid.cell;
    p[u] = float(c[u] + du) * grid.cell;
    p[v] = float(c[v] + dv) * grid.cell;
    return p;
  };
  // The surface goes on beside the face (a filled cell there), or rises from it (one before that).
  const auto level = [&](int along, int step) {
    int beside[3] = {c[0], c[1], c[2]}, above[3] = {beyond[0], beyond[1], beyond[2]};
    beside[along] += step, above[along] += step;
    return grid.at(beside[0], beside[1], beside[2]) != 0 || grid.at(above[0], above[1], above[2]) != 0;
  };
  face.axis = axis, face.sign = sign;
  face.corner[0] = corner(0, 0), face.corner[2] = corner(1, 1);
  if (sign > 0) {
    face.corner[1] = corner(1, 0), face.corner[3] = corner(0, 1);
    face.flat[0] = level(v, -1), face.flat[1] = level(u, 1), face.flat[2] = level(v, 1), face.flat[3] = level(u, -1);
  } else {
    face.corner[1] = corner(0, 1), face.corner[3] = corner(1, 0);
    face.flat[0] = level(u, -1), face.flat[1] = level(v, 1), face.flat[2] = level(u, 1), face.flat[3] = level(v, -1);
  }
  const std::size_t cell = grid.index(c[0], c[1], c[2]);
  face.name = std::uint32_t(cell) * 12 + std::uint32_t(2 * (2 * axis + (sign > 0 ? 0 : 1)));
  face.material = std::uint8_t(grid.cells[cell] - 1);
}

/// Calls visit(face) → bool (false: stop) for the faces that meet `box`, in the order of the cells.
template <class Visit>
void visit_voxel_faces(const VoxelGrid& grid, const Bounds3f& box, Visit&& visit) {
  int first[3], last[3];
  const int count[3] = {grid.columns, grid.layers, grid.rows};
  // A face at the very border of the box belongs to a cell beyond it.
  const float pad = 1e-3f * grid.cell;
  for (int k = 0; k < 3; ++k)
    cells_between(box.low[k] - pad, box.high[k] + pad, grid.cell, count[k], first[k], last[k]);
  VoxelFace face;
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) {
        if (grid.cells[grid.index(x, y, z)] == 0) continue;
        const int c[3] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis)
          for (const int sign : {1, -1}) {
            int beyond[3] = {x, y, z};
            beyond[axis] += sign;
            if (grid.at(beyond[0], beyond[1], beyond[2]) != 0) continue;
            const float level = float(c[axis] + (sign > 0 ? 1 : 0)) * grid.cell;
            if (level < box.low[axis] || level > box.high[axis]) continue;
            make_voxel_face(grid, c, axis, sign, face);
            if (!visit(static_cast<const VoxelFace&>(face))) return;
          }
      }
}

/// Is the point in a filled cell?
inline bool inside_voxels(const VoxelGrid& grid, Vec3f p, int (&c)[3]) {
  for (int k = 0; k < 3; ++k) {
    const float x = p[k] / grid.cell;
    if (!(x >= 0 && x < 1024)) return false;
    c[k] = int(x);
  }
  return grid.at(c[0], c[1], c[2]) != 0;
}

}  // namespace carom::geometry::detail
