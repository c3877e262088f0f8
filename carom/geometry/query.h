// Distance, overlap, ray casts, shape casts and time of impact between placed shapes.
#pragma once

#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"

namespace carom::geometry {

struct Distance2 {
  float distance = 0;          ///< m, 0 where the shapes overlap
  Vec2f point_a{}, point_b{};  ///< closest points, in the frame of A
  Vec2f normal{};              ///< unit, from A to B; zero where they overlap
};
struct Distance3 {
  float distance = 0;
  Vec3f point_a{}, point_b{};
  Vec3f normal{};
};
CAROM_API Distance2 distance(const Shape2& a, const Shape2& b, const Transform2f& b_in_a);
/// Any pair in which at least one shape is convex.
CAROM_API Distance3 distance(const Shape3& a, const Shape3& b, const Transform3f& b_in_a);
CAROM_API bool overlap(const Shape2& a, const Shape2& b, const Transform2f& b_in_a);
CAROM_API bool overlap(const Shape3& a, const Shape3& b, const Transform3f& b_in_a);

template <class V>
struct CastHit {
  bool hit = false;
  float fraction = 1;  ///< of the way, 0…1
  V point{};           ///< in the frame of the (first) shape
  V normal{};          ///< outward from the (first) shape; zero where the cast started inside
  std::uint32_t child = 0;
};
using CastHit2 = CastHit<Vec2f>;
using CastHit3 = CastHit<Vec3f>;

/// The ray from `origin` to `origin + translation`, in the shape's frame. A ray that starts inside a solid shape hits
/// at 0.
CAROM_API CastHit2 ray_cast(const Shape2& shape, Vec2f origin, Vec2f translation);
CAROM_API CastHit3 ray_cast(const Shape3& shape, Vec3f origin, Vec3f translation);

/// B moves by `translation` (frame of A) without turning; the first moment at which it touches A.
CAROM_API CastHit2 shape_cast(const Shape2& a, const Shape2& b, const Transform2f& b_in_a, Vec2f translation);
CAROM_API CastHit3 shape_cast(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, Vec3f translation);

/// A motion over one step: the centre of mass moves on a straight line, the attitude turns evenly.
struct Sweep2 {
  Vec2f local_center{};
  Vec2f c0{}, c1{};  ///< centre of mass at time 0 and 1
  Rot2f q0{}, q1{};
};
struct Sweep3 {
  Vec3f local_center{};
  Vec3f c0{}, c1{};
  Quatf q0{}, q1{};
};
enum class ImpactState : std::uint8_t { separated, hit, overlapped, failed };
struct TimeOfImpact {
  ImpactState state = ImpactState::separated;
  float time = 1;  ///< 0…1
};
/// The first time at which two moving convex shapes come within `target` m of each other (rotation included).
/// B may be a mesh or height field. Conservative: it never misses a contact that lasts longer than its tolerance.
CAROM_API TimeOfImpact time_of_impact(const Shape2& a, const Sweep2& sweep_a, const Shape2& b, const Sweep2& sweep_b,
                                      float target = 0.0025f);
CAROM_API TimeOfImpact time_of_impact(const Shape3& a, const Sweep3& sweep_a, const Shape3& b, const Sweep3& sweep_b,
                                      float target = 0.0025f);

}  // namespace carom::geometry
