// Eight triangles of a surface side by side, and what is told of all of them at once: which meet a box, which a box or
// hull may come near, and how far off it keeps. Compiled for several instruction sets; the same bits by all.
#pragma once

#include <cstdint>

#include "carom/math/vec.h"

namespace carom::geometry::detail {

using math::Vec3f;

/// In the frame of their surface.
struct TriangleGroup {
  static constexpr int lanes = 8;
  float corner[3][3][lanes];  ///< by corner and axis
  std::uint32_t index[lanes];
  std::uint8_t edges[lanes], material[lanes];  ///< of a mesh they stand with it
};

/// A shape with corners, seen from its origin; vectors by fours (x x x x y y y y z z z z), as PlacedCorners keeps them.
struct PlacedShape {
  Vec3f origin;
  const float* corners;       ///< m
  const float* corners_then;  ///< m: when it has gone on
  int corner_blocks;
  const float* planes;  ///< of its faces: the fourth row is their offset (m)
  int face_blocks;
  const float* directions;  ///< unit vectors along which it may keep off
  const float* floor;       ///< m: the least that a corner lies along them, now and then
  const float* now;         ///< m: the same for now alone
  int direction_count;      ///< at most 8
  float radius;             ///< m, swept off all of them
  bool solid;               ///< there is matter below the triangles, to any depth
};

struct NearQuestion {
  Vec3f middle;  ///< of the shape, moved by what holds it: triangles that look away from it do not count
  float around;  ///< m: nor what is farther off
  float keeps;   ///< m: nor what is farther off now and then
};
struct NearAnswer {
  int uses[8];  ///< how many each direction kept off
  /// Along which others were off, for the first triangle of which this was found.
  int learned;
  int lane[4];
  Vec3f direction[4];
};
struct FacesAnswer {
  std::uint32_t apart;  ///< lanes of triangles before a face, farther off than `around`
  std::uint32_t ahead;  ///< farther off than `keeps` now
  int face[TriangleGroup::lanes];
};

struct ClearanceQuestion {
  Vec3f axis[3], low, high;  ///< m: the shape's own box along its axes, from its origin
  Vec3f box_low, box_high;   ///< m: and the one in the frame of the surface
};

/// Lanes are told by bits; those not asked for are not in an answer.
struct TriangleKernels {
  /// Fills a group from a mesh, and returns which of `count` (1 to 8) triangles have boxes that meet one.
  std::uint32_t (*load)(const float* vertices, const std::uint32_t* indices, const std::uint32_t* triangles, int count,
                        const Vec3f& low, const Vec3f& high, TriangleGroup& group);
  /// Which may be within reach of the shape, by their planes and sides.
  std::uint32_t (*near)(const TriangleGroup& group, std::uint32_t lanes, const PlacedShape& shape,
                        const NearQuestion& question, NearAnswer& answer);
  /// The face of the shape before which each lies farthest.
  void (*before_faces)(const TriangleGroup& group, std::uint32_t lanes, const PlacedShape& shape,
                       const NearQuestion& question, FacesAnswer& answer);
  /// How far (m) the shape is from each at least. Without corners, by boxes alone.
  void (*clearance)(const TriangleGroup& group, const PlacedShape& shape, const ClearanceQuestion& question,
                    float (&gap)[TriangleGroup::lanes]);
};

namespace triangle_groups_baseline {
extern const TriangleKernels kernels;
}
namespace triangle_groups_avx2 {
extern const TriangleKernels kernels;
}
/// Those of this machine.
const TriangleKernels& triangle_kernels();

}  // namespace carom::geometry::detail
