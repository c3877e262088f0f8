// The triangulated convex hull of a cloud, by exact arithmetic on a grid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "carom/math/vec.h"

namespace carom::geometry::detail {

/// A point of the grid; coordinates from 0 to grid_size, so that the volumes of tetrahedra fit 64 bits exactly.
struct GridPoint {
  std::int64_t x = 0, y = 0, z = 0;
};
inline constexpr std::int64_t grid_size = std::int64_t(1) << 20;

inline math::Vec3d to_vector(GridPoint p) { return {double(p.x), double(p.y), double(p.z)}; }

/// The vector at right angles to the triangle, as long as twice its area. Exact.
inline GridPoint normal_of(GridPoint a, GridPoint b, GridPoint c) {
  const std::int64_t ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const std::int64_t vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}
/// Six times the volume of the tetrahedron; positive where p lies on the side of the normal n of a triangle at a.
/// With differences up to 2^20 the sum stays under 3·2^61: exact.
inline std::int64_t orient(GridPoint n, GridPoint a, GridPoint p) {
  return n.x * (p.x - a.x) + n.y * (p.y - a.y) + n.z * (p.z - a.z);
}

struct HullTriangle {
  std::array<std::uint32_t, 3> corner{};    // indices of points, counterclockwise from outside
  std::array<std::uint32_t, 3> neighbor{};  // the triangle across the edge from corner i to corner i + 1
};

enum class HullFailure { none, point, line, plane, too_many };

struct TriangulatedHull {
  HullFailure failure = HullFailure::none;
  std::vector<HullTriangle> triangles;
};

/// A cloud thinner than eight tolerances counts as flat: its two faces could not be told apart from one.
/// Adds the farthest point again and again until every point is within `tolerance` (grid units) of the hull, or, where
/// `stop_at_limit`, until it has `limit` corners. Otherwise more than `limit` corners are the failure too_many.
TriangulatedHull triangulate_hull(std::span<const GridPoint> points, double tolerance, std::size_t limit,
                                  bool stop_at_limit);

}  // namespace carom::geometry::detail
