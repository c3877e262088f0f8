// Triangles side by side and the half-spaces that each of them leaves to a capsule: for kernels of several widths.
#pragma once

#include <cstdint>

#include "carom/math/vec.h"

namespace carom::geometry::detail {

using math::Vec3f;

/// What a nearly coplanar patch of triangles leaves to a capsule.
struct SurfacePlane {
  Vec3f normal{};        ///< out of the surface
  float separation = 0;  ///< m, along the way to the nearest point
  Vec3f point{};         ///< of the surface
};

/// Eight triangles, whichever width looks at them.
struct TriangleBlock {
  static constexpr int lanes = 8;
  float corner[3][3][lanes];
  float normal[3][lanes];
  std::int32_t edges[lanes];  ///< EdgeFlags
};

/// What is asked of them, in the frame of their corners.
struct TriangleQuestion {
  Vec3f low, high;     ///< m: a triangle that does not meet this box does not count
  Vec3f center, end;   ///< m, of the capsule's line: its middle, and one end from there
  float radius;        ///< m
  float margin;        ///< m: what is farther off does not count
  float border;        ///< m, border_tolerance
  float border_level;  ///< border_cosine
  float behind;        ///< m, ≤ 0: what lies farther behind a triangle is not pushed by it
};

/// A SurfacePlane, the point seen from the middle of the capsule.
struct MetPlane {
  float normal[3], separation, point[3];
};

/// The planes of the triangles that the line may meet, in their order; `out` has room for all. Returns how many.
using FindTrianglePlanes = int (*)(const TriangleBlock* blocks, int count, const TriangleQuestion& q, MetPlane* out);
using SetTriangleNormals = void (*)(TriangleBlock* blocks, int count);

namespace triangle_planes_baseline {
int find_planes(const TriangleBlock* blocks, int count, const TriangleQuestion& q, MetPlane* out);
void set_normals(TriangleBlock* blocks, int count);
}  // namespace triangle_planes_baseline

namespace triangle_planes_avx2 {
int find_planes(const TriangleBlock* blocks, int count, const TriangleQuestion& q, MetPlane* out);
void set_normals(TriangleBlock* blocks, int count);
}  // namespace triangle_planes_avx2

}  // namespace carom::geometry::detail
