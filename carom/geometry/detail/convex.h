// Convex shapes as a core and a radius, and what the general algorithms ask of them: support points and features.
#pragma once

#include "carom/geometry/detail/raw_array.h"
#include "carom/geometry/hull.h"

namespace carom::geometry::detail {

enum class CoreKind : std::uint8_t { point, segment, box, cylinder, cone, ellipsoid, hull, triangle };

/// A convex core, in its own frame, swept by a sphere of `radius`.
struct Convex {
  CoreKind kind = CoreKind::point;
  float radius = 0;
  Vec3f half{};  ///< box, ellipsoid: half extents; segment: y; cylinder and cone: x = z = radius, y = half height
  const Hull* hull = nullptr;
  Vec3f corner[3]{};  ///< triangle, counterclockwise seen from free space
  Vec3f normal{};     ///< triangle
};

/// The core of a convex shape (sphere … hull).
Convex convex_of(const Shape3& shape);
Convex convex_of_triangle(Vec3f a, Vec3f b, Vec3f c);

/// Half the smallest extent: what "small" means against this shape. 0 for a point and a triangle.
float inner_size(const Convex& c);
/// The farthest distance of the core from its frame's origin.
float outer_size(const Convex& c);
/// A point deep inside the core.
Vec3f inner_point(const Convex& c);
bool is_round(const Convex& c);       ///< cylinder or cone
bool is_polyhedron(const Convex& c);  ///< box, hull or triangle

Vec3d support(const Convex& c, Vec3d direction);
/// Which of the vectors of Hull::vertex_lanes or normal_lanes lies farthest along d; the first among equals.
int farthest(const float* lanes, int blocks, Vec3f d);
inline int farthest(const std::vector<float>& lanes, Vec3f d) {
  return farthest(lanes.data(), int(lanes.size() / 12), d);
}

/// Faces that are flat and bounded: candidates for a reference face.
int face_count(const Convex& c);
struct FacePlane {
  Vec3f normal;
  float offset;
};
FacePlane face_plane(const Convex& c, int face);

/// The part of a core that faces a direction: a point, a line or a convex polygon.
struct Feature {
  static constexpr int capacity = 24;
  int count = 0;
  RawArray<Vec3f, capacity> point;
  RawArray<std::uint8_t, capacity> id;
  Vec3f normal{};  ///< of the polygon, outward
  void add(Vec3f p, int name) {
    if (count < capacity) point[count] = p, id[count] = std::uint8_t(name), ++count;
  }
};
/// The feature most aligned with the unit `direction`. At most 20 corners are kept of a face with more.
void feature(const Convex& c, Vec3f direction, Feature& out);
/// The flat face `face` as a polygon, counterclockwise seen from outside.
void face_feature(const Convex& c, int face, Vec3f toward, Feature& out);
/// A straight line of the surface that stands out along `direction` and is level across it: a side of a cylinder, an
/// edge of a box or a hull, a segment itself.
bool side_line(const Convex& c, Vec3f direction, Vec3f line[2]);

}  // namespace carom::geometry::detail
