// Contact points while a manifold is being made: clipping, and the choice of at most four.
#pragma once

#include "carom/geometry/detail/convex.h"
#include "carom/geometry/manifold.h"

namespace carom::geometry::detail {

class OffDirections;
class PlacedCorners;

/// Candidates along one normal, in the frame of A.
struct ContactPoints {
  static constexpr int capacity = 64;
  int count = 0;
  RawArray<ManifoldPoint3, capacity> point;
  void add(Vec3f p, float separation, std::uint32_t feature) {
    if (count < capacity) point[count++] = {p, separation, feature};
  }
};

/// Writes at most four of the candidates: the deepest, and those that span the widest support. Ties within a
/// thousandth of the patch go to the earlier one, so that the choice does not flicker.
void write_points(const ContactPoints& points, Vec3f normal, Manifold3& out);

/// Clips `incident` to the prism over the polygon `reference` and adds what lies within `margin` of its face.
/// Separations are along reference.normal. `radius_r`, `radius_i` are swept off. `tag` marks the features' names.
/// Corners up to `widen` m outside the prism count as inside.
void clip_to_face(const Feature& reference, float radius_r, const Feature& incident, float radius_i, float margin,
                  std::uint32_t tag, ContactPoints& out, float widen = 0);

/// The same manifold seen from the other shape: `a_in_b` is the pose of its frame in the other's.
void flip(Manifold3& m, const Transform3f& a_in_b);

/// A round surface that passes over a face's border without dipping below the face by more than this (for a total
/// radius r) is pushed along the face's normal, not the tilted one of the border: so nothing round catches on the joint
/// of two level faces, and the distance stays the true one. Only where the two normals are within 32°: what falls past
/// the border is not held by a face that it is not over; there, while apart, it has no contact yet.
inline float border_tolerance(float r) { return min(0.005f * r, 0.001f); }
inline constexpr float border_cosine = 0.85f;

/// Where edges cross of which one borders a face that looks at the other shape to within 20°, what rocks over an edge
/// comes down on the other ones: the points of the faces along the normal, of which the edges' is the deepest, are all
/// of them. Not where they overlap by more than a fifth of half the length of the shorter shape.
inline constexpr float facing_cosine = 0.94f, shallow_share = 0.2f;

/// The closest parameters of two segments, clamped to them (Ericson 2005, §5.1.9).
void closest_on_segments(Vec3f p1, Vec3f d1, Vec3f p2, Vec3f d2, float& s, float& t);

/// General pairs of convex cores (manifold3_convex.cpp).
void collide_cores(const Convex& a, const Convex& b, const Transform3f& b_in_a, float margin, PairCache& cache,
                   Manifold3& out);
void collide_box_box(const Box& a, const Box& b, const Transform3f& b_in_a, float margin, PairCache& cache,
                     Manifold3& out);
void collide_plane(const Plane& plane, const Convex& b, const Transform3f& b_in_a, float margin, Manifold3& out);
/// One side of a surface's triangle (A): adds to `out` and sets its normal. `edges` are EdgeFlags: contacts that lean
/// over a flat edge are the neighbour's, and nothing that hardly dips below the plane catches on an open one. `solid`:
/// there is matter below, to any depth. False where there is none.
/// `corners` are those of b; where they are known, the caller has seen that the triangle is within reach. What is off
/// as b goes on does not count, and is remembered in `off`. `held`: as ShapeWay's.
bool collide_triangle(const Convex& triangle, std::uint8_t edges, bool solid, const Convex& b,
                      const PlacedCorners& corners, const Transform3f& b_in_a, float margin, Vec3f held,
                      OffDirections& off, ContactPoints& out, Vec3f& normal);

/// How a shape goes past a surface while their contacts hold, in the surface's frame.
struct ShapeWay {
  Vec3f way{};           ///< m, of the origin of the shape's frame
  Vec3f turn{};          ///< rad
  float bend = 0;        ///< m: no point strays farther from where these take it
  float margin = 1e30f;  ///< m: what the shape stays farther from than so does not count
  float worth = 0;       ///< m: to be less far from all is not worth knowing
  Vec3f held{};          ///< m: a mesh stops what has its middle in front of a triangle, moved by this
};
/// `collide_many` of a surface and a convex shape, for triangles that the shape may come near. The cache keeps
/// directions along which the shape was off most of them.
int collide_approaching(const Shape3& surface, const Shape3& b, const Transform3f& b_in_a, float margin,
                        const ShapeWay& approach, PairCache& cache, std::span<Manifold3> out);

/// What a PairCache keeps when it is a direction, in 32 bits (octahedral): exact enough for a first guess.
inline constexpr std::uint8_t cached_direction = 3;
std::uint32_t pack_direction(Vec3f n);
Vec3f unpack_direction(std::uint32_t p);

/// `collide_many` of a surface and a convex shape, without the distance where they do not meet, for the triangles that
/// meet `box` (in A's frame) alone.
int collide_surface(const Shape3& surface, const Shape3& b, const Transform3f& b_in_a, float margin,
                    const Bounds3f& box, std::span<Manifold3> out);

}  // namespace carom::geometry::detail
