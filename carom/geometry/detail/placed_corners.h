// The corners of a box or hull where it stands, four at a time: what is asked of the same shape for many triangles.
#pragma once

#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/detail/triangle_groups.h"
#include "carom/math/mat.h"
#include "carom/math/simd.h"

namespace carom::geometry::detail {

/// Corners of a core in the frame of a surface, seen from the origin of the core's own frame.
class PlacedCorners {
 public:
  using Four = math::WideFloat<4>;

  PlacedCorners(const Convex& core, const Transform3f& x);
  /// False for shapes that have none, or too many.
  bool known() const { return blocks_ > 0; }
  bool has_faces() const { return face_blocks_ > 0; }
  Vec3f origin() const { return origin_; }
  Vec3f middle() const { return middle_; }  ///< deep inside, from the origin
  Vec3f corner(int i) const {
    const float* p = lanes_ + 12 * (i / 4) + i % 4;
    return {p[0], p[4], p[8]};
  }
  /// The least that any corner lies along d (m, times its length), and then, when it has gone on.
  float least(Vec3f d) const { return least_of(lanes_, d); }
  float least_then(Vec3f d) const { return least_of(then_, d); }
  /// What groups of triangles are to know of it; the planes of its faces where they are asked for.
  void tell(PlacedShape& shape) const {
    shape.origin = origin_;
    shape.corners = lanes_, shape.corners_then = then_, shape.corner_blocks = blocks_;
    shape.planes = planes_, shape.face_blocks = 0;
  }
  void tell_faces(PlacedShape& shape) const {
    if (!planes_placed_) place_planes();
    shape.face_blocks = face_blocks_;
  }
  /// The face before whose plane a triangle (seen from the origin) lies farthest.
  struct Before {
    float distance;  ///< m, of its nearest corner
    Vec3f normal;
  };
  Before face_before(Vec3f p, Vec3f q, Vec3f r) const;
  /// Which face looks most along d; its plane, seen from the origin.
  int face_toward(Vec3f d) const;
  FacePlane plane(int face) const {
    const float* lane = planes_ + 16 * (face / 4) + face % 4;
    return {{lane[0], lane[4], lane[8]}, lane[12]};
  }
  /// The edge that comes nearest to the segment from `start` by `way` (seen from the origin). False where the shape has
  /// too many, or no faces.
  struct Edge {
    Vec3f start, way;
    float distance_squared;  ///< m², to rounding
  };
  bool nearest_edge(Vec3f start, Vec3f way, Edge& nearest) const;
  /// Does a segment (seen from the origin) go through the shape?
  bool meets_segment(Vec3f start, Vec3f way) const;
  /// As clip_to_face of a triangle, for the face of this shape that looks against its normal. `radius` is swept off.
  void clip_face(const Vec3f (&triangle)[3], Vec3f normal, float radius, float margin, float widen,
                 ContactPoints& out) const;
  /// Lets the corners go on.
  void go(const ShapeWay& approach);
  /// From the origin.
  Bounds3f bounds() const { return bounds_of(lanes_); }
  Bounds3f bounds_then() const { return bounds_of(then_); }
  /// Which of them lies farthest along d; the first among equals.
  int farthest(Vec3f d) const { return detail::farthest(lanes_, blocks_, d); }

 private:
  float least_of(const float* p, Vec3f d) const {
    const Four x = Four::splat(d.x), y = Four::splat(d.y), z = Four::splat(d.z);
    Four low = Four::load(p) * x + Four::load(p + 4) * y + Four::load(p + 8) * z;
    for (int i = 1; i < blocks_; ++i) {
      p += 12;
      low = min(low, Four::load(p) * x + Four::load(p + 4) * y + Four::load(p + 8) * z);
    }
    return min(min(low[0], low[1]), min(low[2], low[3]));
  }

  Bounds3f bounds_of(const float* lanes) const;
  int face_corners(Vec3f toward, std::uint8_t (&corners)[Feature::capacity]) const;
  void place_planes() const;
  void place_edges() const;

  static constexpr int capacity = 64, most_edges = 32;
  Vec3f origin_, middle_;
  const Hull* hull_ = nullptr;
  Mat3f turn_;
  Vec3f half_{};  ///< of a box
  int blocks_ = 0, face_blocks_ = 0;
  mutable bool planes_placed_ = false;
  mutable int edge_blocks_ = -1;  ///< −1: not placed yet
  mutable float edges_[6 * most_edges];
  mutable float planes_[4 * capacity];
  float lanes_[3 * capacity], then_[3 * capacity];
};

}  // namespace carom::geometry::detail
