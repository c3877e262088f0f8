// Triangles of a surface around a place, side by side, and the half-spaces that they leave to a capsule: what a
// character asks again and again of the same few dozen triangles.
#pragma once

#include <span>
#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/triangle_planes.h"

namespace carom::geometry::detail {

/// A ball or capsule near a surface, in the surface's frame.
struct NearbyLine {
  Vec3f center{};
  Vec3f end{};       ///< of its segment, from the centre
  float radius = 0;  ///< m
  float margin = 0;  ///< m: what is farther off does not count
  Bounds3f box{};    ///< nor does a triangle that does not meet this
};

class TriangleBlocks {
 public:
  /// `lanes` as in math::instruction_set_of_width; 0: the widest of this machine. Results are the same in bits.
  explicit TriangleBlocks(int lanes = 0);
  void clear() { blocks_.clear(), count_ = 0; }
  int count() const { return count_; }
  /// Holds the triangles of a mesh or height field that meet `box`, in an order that does not depend on it: what is
  /// asked within a box that was gathered has the same answer whatever else was.
  void gather(const Shape3& surface, const Bounds3f& box);
  /// Fills `out` with the planes of triangles that the line may meet, nearest first, and returns how many. The rule is
  /// that of contacts (`collide_triangle`): a triangle pushes along its own normal or over an edge that stands out.
  int planes(const NearbyLine& line, std::span<SurfacePlane> out) const;

 private:
  std::vector<TriangleBlock> blocks_;
  int count_ = 0;
  bool solid_ = false;
  FindTrianglePlanes find_planes_;
  SetTriangleNormals set_normals_;
};

}  // namespace carom::geometry::detail
