// Shapes as triangles for the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/host/declaration.h"
#include "apps/host/views.h"

namespace carom::command {

struct Triangle {
  math::Vec3d corner[3];
  math::Vec3d normal[3];
  std::uint32_t color = 0;
  double opacity = 1;
  bool two_sided = false;  ///< lit from the side that is seen
};

/// Adds the shape of a body at its place; `detail` is the number of segments round a circle.
void tessellate(const host::ShapeView& shape, const host::MeshLibrary& meshes, const math::Vec3d& position,
                const math::Quatf& rotation, std::uint32_t color, int detail, std::vector<Triangle>& out);

/// Small balls as octahedra with the normals of balls, and surfaces with normals averaged at their corners.
void tessellate(const host::Points& points, std::vector<Triangle>& out);
void tessellate(const host::Surface& surface, std::vector<Triangle>& out);

}  // namespace carom::command
