// Convex polyhedra as half-edge meshes, built from points.
#pragma once

#include "carom/geometry/shape3.h"

namespace carom::geometry {

struct HullEdge {
  std::uint16_t origin;  ///< vertex where this half-edge starts
  std::uint16_t twin;    ///< the half-edge of the neighbouring face along the same edge
  std::uint16_t next;    ///< the next half-edge counterclockwise round the same face
  std::uint16_t face;
};
struct HullFace {
  std::uint16_t first_edge;
  std::uint16_t edge_count;
};
/// {x : normal·x = offset}, with the normal outward.
struct HullPlane {
  Vec3f normal;
  float offset;
};

/// A convex polyhedron swept by a sphere of `radius` (0: sharp). Immutable once built; share it between shapes.
struct Hull {
  std::vector<Vec3f> vertices;
  std::vector<HullPlane> planes;  ///< one a face
  std::vector<HullFace> faces;
  std::vector<HullEdge> edges;  ///< half-edges; a half-edge and its twin stand beside each other (2k, 2k + 1)
  Bounds3f bounds;              ///< of the vertices, without the radius
  Vec3f centroid;
  float volume = 0;
  float inner_radius = 0;  ///< radius of the largest sphere about the centroid inside the polyhedron
  float radius = 0;
  /// Vertices and face normals once more, four at a time (x x x x y y y y z z z z, the last repeated), for searches.
  std::vector<float> vertex_lanes, normal_lanes;
};

/// The convex hull of at least four points that are not in one plane, with coplanar triangles merged into faces.
/// Points are taken in the order in which they stand out, until all are inside; the combinatorics is exact (integer
/// arithmetic on a grid of 2^20 cells over the cloud), so the answer is always a closed convex polyhedron. Its faces
/// are planar to four times hull_tolerance, and all points are inside to eight times. Errors: not finite, flat, more
/// than `max_vertices` corners (4 to 255; where `simplify` is set the least important corners are left out instead and
/// points may stand outside).
struct HullOptions {
  float radius = 0;  ///< m, ≥ 0
  int max_vertices = 128;
  bool simplify = false;
};
CAROM_API core::Result<std::shared_ptr<const Hull>> make_hull(std::span<const Vec3f> points, const HullOptions& = {});
/// The distance (m) that make_hull takes for zero: 4·2^−20 of the cloud's largest extent, or four units in the last
/// place of its farthest coordinate.
CAROM_API double hull_tolerance(std::span<const Vec3f> points);

/// Checks everything that users of a Hull rely on: a closed consistent half-edge structure, Euler's formula, planar
/// faces, convexity, and that `points` are inside, all to `tolerance` metres. The error names the first fault.
CAROM_API core::Status validate_hull(const Hull& hull, std::span<const Vec3f> points, double tolerance);

}  // namespace carom::geometry
