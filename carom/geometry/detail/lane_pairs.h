// Pairs of convex shapes of the plane, a pair in each lane: for kernels of several widths.
#pragma once

#include <cstdint>

#include "carom/geometry/manifold.h"
#include "carom/math/cpu.h"

namespace carom::geometry::detail {

/// As many pairs of a kind as are collided at once, or fewer.
struct LanePairs {
  static constexpr int capacity = 16;
  /// A row of sixteen floats, to which lanes are transposed.
  struct alignas(16) Found {
    Manifold2 manifold;
    float rest[3];
  };
  const Shape2 *a[capacity], *b[capacity];
  alignas(16) float b_in_a[capacity][4];        ///< a Transform2f
  float margin[capacity];                       ///< m
  std::int32_t kind[capacity], edge[capacity];  ///< PairCache::kind and a, before and after
  Found found[capacity];
};
static_assert(sizeof(LanePairs::Found) == 64 && sizeof(Transform2f) == 16);

/// Pairs for which there are kernels: of two polygons with at most four corners, one of them and something round, in
/// either order, two capsules, or two other polygons.
enum class LaneKind : std::uint8_t { quads, quad_capsule, quad_circle, capsules, polygons, none };
inline constexpr int lane_kinds = 5;
inline bool is_quad(const Shape2& s) { return s.type == ShapeType2::polygon && s.polygon.count <= 4; }
inline bool has_line(const Shape2& s) { return s.type == ShapeType2::capsule && s.capsule.half_length > 0; }
inline LaneKind lane_kind(const Shape2& a, const Shape2& b) {
  if (a.type == ShapeType2::polygon && b.type == ShapeType2::polygon)
    return is_quad(a) && is_quad(b) ? LaneKind::quads : LaneKind::polygons;
  const bool first = is_quad(a);
  if (!first && !is_quad(b)) return has_line(a) && has_line(b) ? LaneKind::capsules : LaneKind::none;
  const Shape2& other = first ? b : a;
  if (other.type == ShapeType2::circle) return LaneKind::quad_circle;
  return has_line(other) ? LaneKind::quad_capsule : LaneKind::none;
}

/// What collide() finds for the first `count` pairs, to the bit. Bits by pair: left alone, collide() has to tell.
using CollideLanes = std::uint32_t (*)(LanePairs& pairs, int count);
/// By LaneKind.
struct LaneColliders {
  CollideLanes of[lane_kinds];
};

namespace lane_pairs_baseline {
LaneColliders colliders();
}
#if CAROM_WIDE_UNITS
namespace lane_pairs_avx2 {
LaneColliders colliders();
}
#endif

/// `lanes`: as many as the machine is known to have.
inline LaneColliders lane_colliders(int lanes) {
#if CAROM_WIDE_UNITS
  if (lanes >= 8) return lane_pairs_avx2::colliders();
#endif
  (void)lanes;
  return lane_pairs_baseline::colliders();
}

}  // namespace carom::geometry::detail
