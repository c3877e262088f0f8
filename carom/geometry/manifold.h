// Contact manifolds between two shapes, computed in the frame of the first one, in float.
#pragma once

#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"

namespace carom::geometry {

struct ManifoldPoint2 {
  Vec2f point{};              ///< m, midway between the two surfaces, in the frame of A
  float separation = 0;       ///< m, negative where the shapes overlap
  std::uint32_t feature = 0;  ///< names the pair of features, so that impulses carry over to the next step
};
struct Manifold2 {
  Vec2f normal{};  ///< unit, from A to B, in the frame of A
  int count = 0;
  std::uint32_t child = 0;     ///< which segment of a chain this belongs to
  std::uint32_t material = 0;  ///< of that segment, as its maker numbered it
  ManifoldPoint2 points[2];
};
struct ManifoldPoint3 {
  Vec3f point{};
  float separation = 0;
  std::uint32_t feature = 0;
};
struct Manifold3 {
  Vec3f normal{};
  int count = 0;
  std::uint32_t child = 0;     ///< which triangle, cell or compound child of A or B this belongs to
  std::uint32_t material = 0;  ///< of those triangles or cells, as their maker numbered it
  ManifoldPoint3 points[4];
};

/// What a pair remembers from step to step (the axis or features that separated it last). Zero it for a new pair.
/// It only makes the answer faster, never different by more than rounding, but for segments of chains (`met_front`),
/// and it is part of the world's state.
struct PairCache {
  std::uint8_t kind = 0;
  std::uint8_t a = 0, b = 0, c = 0;
  std::uint32_t d = 0;
};
/// `PairCache::kind` with a segment of a chain, which stops only what comes from its front: the shape did, so that it
/// is held even where something presses its middle through the line.
inline constexpr std::uint8_t met_front = 3;

/// Contacts of A and B with separation ≤ margin. Returns nothing (count 0) where they are farther apart: if
/// points[0].separation exceeds the margin then, the shapes are known to be at least that far (m) from each other; and
/// if normal is not zero then, they are that far along it. b_in_a is B's pose seen from A. Any pair of convex shapes,
/// and convex against chain segments, in either order.
CAROM_API void collide(const Shape2& a, const Shape2& b, const Transform2f& b_in_a, float margin, PairCache& cache,
                       Manifold2& out);
/// Both convex (sphere … hull), or one of them a plane.
CAROM_API void collide(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, float margin, PairCache& cache,
                       Manifold3& out);
/// One of the shapes may be a mesh, height field or compound, a mesh may meet a plane: one manifold a patch of coplanar
/// triangles or a child, deepest first, at most out.size(). Returns how many; where a convex shape meets nothing of a
/// surface, out[0].points[0].separation (m) is how far they are from each other at least, as far as that was looked
/// for.
CAROM_API int collide_many(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, float margin,
                           std::span<Manifold3> out);

}  // namespace carom::geometry
