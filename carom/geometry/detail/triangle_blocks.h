// Triangles of a surface around a place, four side by side, and the half-spaces that they leave to a capsule: what a
// character asks again and again of the same few dozen triangles.
#pragma once

#include <span>
#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/geometry/detail/surface.h"

namespace carom::geometry::detail {

/// A ball or capsule near a surface, in the surface's frame.
struct NearbyLine {
  Vec3f center{};
  Vec3f end{};       ///< of its segment, from the centre
  float radius = 0;  ///< m
  float margin = 0;  ///< m: what is farther off does not count
  Bounds3f box{};    ///< nor does a triangle that does not meet this
};

/// What a nearly coplanar patch of triangles leaves to it.
struct SurfacePlane {
  Vec3f normal{};        ///< out of the surface
  float separation = 0;  ///< m, along the way to the nearest point
  Vec3f point{};         ///< of the surface
};

class TriangleBlocks {
 public:
  void clear() { blocks_.clear(), count_ = 0; }
  /// Adds the triangles of a mesh or height field that meet `box`; corners are kept as seen from its middle.
  void gather(const Shape3& surface, const Bounds3f& box);
  /// Fills `out` with the planes of triangles that the line may meet, nearest first, and returns how many. The rule is
  /// that of contacts (`collide_triangle`): a triangle pushes along its own normal or over an edge that stands out.
  int planes(const NearbyLine& line, std::span<SurfacePlane> out) const;

 private:
  struct Block {
    float corner[3][3][4];
    float normal[3][4];
    std::int32_t edges[4];
  };
  std::vector<Block> blocks_;
  Vec3f origin_{};
  int count_ = 0;
  bool solid_ = false;
};

}  // namespace carom::geometry::detail
