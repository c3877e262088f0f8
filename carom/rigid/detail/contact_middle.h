// Round contacts in the middle of the step. Where something rolls on something round, normal and arms turn while it
// does. A step that keeps those of its start pulls back too late: x and v of what rocks with ω go round by a map of
// determinant 1 + 3/8 (ωΔt)², and the swing grows by 3/16 ω²Δt a second. Those of the middle make it the midpoint rule,
// whose determinant is 1 − 1/8 (ωΔt)² for our substeps: nothing is gained.
#pragma once

#include "carom/geometry/manifold.h"
#include "carom/rigid/detail/contact_block.h"
#include "carom/rigid/detail/contacts.h"

namespace carom::rigid::detail {

/// What changes until then, the points and the normal in A's shape frame as it stands at the start.
template <class D>
struct MiddleOfStep {
  typename D::Vector normal{};
  typename D::Vector point[D::max_points]{};
  typename D::Vector across{};  ///< m, world axes: how B's centre goes past A's
};

inline Rot2f small_rotation(float turn) { return normalize(Rot2f(1, turn)); }
inline Quatf small_rotation(const Vec3f& turn) {
  return normalize(Quatf{1, 0.5f * turn.x, 0.5f * turn.y, 0.5f * turn.z});
}

/// What a turn of the world makes of a vector in a frame, there.
inline Vec2f turned_in(const Rot2f&, const Rot2f& turn, const Vec2f& v) { return rotate(turn, v); }
inline Vec3f turned_in(const Quatf& frame, const Quatf& turn, const Vec3f& v) {
  return inverse_rotate(frame, rotate(turn, rotate(frame, v)));
}

/// Where the shapes of a contact will be, by the velocities that their bodies have now. False for a manifold of an
/// earlier step, which is kept because little has changed.
template <class D>
struct PosesOfMiddle {
  typename D::Rotation turn_a, turn_b;  ///< of the bodies
  typename D::Vector way_a, way_b;      ///< m, of their centres
  typename D::Vector arm_a, arm_b;      ///< m, from those to the shapes, now
  typename D::Rotation frame_a;         ///< of A's shape, now
  typename D::Transform b_in_a;         ///< then

  bool find(const WorldImplementation<D>& world, const ContactRecord<D>& c, float dt) {
    using V = typename D::Vector;
    const float half = 0.5f * dt;
    const SolverBody<D>& sa = world.bodies.solver[std::size_t(c.body[0])];
    const SolverBody<D>& sb = world.bodies.solver[std::size_t(c.body[1])];
    const typename D::Pose a = shape_pose(world, world.shapes.at(c.shape[0]));
    const typename D::Pose b = shape_pose(world, world.shapes.at(c.shape[1]));
    if (!(relative(a, b) == c.base)) return false;
    way_a = half * sa.linear_velocity, way_b = half * sb.linear_velocity;
    turn_a = small_rotation(half * sa.angular_velocity), turn_b = small_rotation(half * sb.angular_velocity);
    arm_a = V(a.position - world.bodies.motion[std::size_t(c.body[0])].center);
    arm_b = V(b.position - world.bodies.motion[std::size_t(c.body[1])].center);
    frame_a = a.rotation;
    const V between = rotate(a.rotation, c.base.p) + (way_b - way_a) + (rotate(turn_b, arm_b) - arm_b) -
                      (rotate(turn_a, arm_a) - arm_a);
    const auto then_a = turn_a * a.rotation;
    b_in_a = {inverse_rotate(then_a, between), conjugate(then_a) * (turn_b * b.rotation)};
    return true;
  }
};

/// The features that meet in a point of a contact: of either shape a point, about which it is round, or an edge.
struct RoundFeatures {
  Vec2f a, b;                ///< m, in the frame of either
  float radius_a, radius_b;  ///< m, about those
  bool edge_a, edge_b;       ///< normal to the contact's normal
};
inline float rounding_of(const geometry::Shape2& s) {
  if (s.type == geometry::ShapeType2::circle) return s.circle.radius;
  return s.type == geometry::ShapeType2::capsule ? s.capsule.radius : s.polygon.radius;
}
/// Has it an edge that faces there? A unit vector in its frame.
inline bool has_edge(const geometry::Shape2& s, const Vec2f& outward) {
  constexpr float rounding = 1e-5f;
  if (s.type == geometry::ShapeType2::circle) return false;
  if (s.type == geometry::ShapeType2::capsule) return s.capsule.half_length > 0 && math::abs(outward.y) < rounding;
  for (int i = 0; i < s.polygon.count; ++i)
    if (dot(s.polygon.normals[i], outward) > 0 && math::abs(cross(s.polygon.normals[i], outward)) < rounding)
      return true;
  return false;
}
inline RoundFeatures features_of(const geometry::Shape2& a, const geometry::Shape2& b, const Transform2f& b_in_a,
                                 const geometry::Manifold2& m) {
  const geometry::ManifoldPoint2& p = m.points[0];
  RoundFeatures f;
  f.radius_a = rounding_of(a), f.radius_b = rounding_of(b);
  f.a = p.point - m.normal * (0.5f * p.separation + f.radius_a);
  f.b = inverse_transform_point(b_in_a, p.point + m.normal * (0.5f * p.separation + f.radius_b));
  f.edge_a = has_edge(a, m.normal);
  f.edge_b = !f.edge_a && has_edge(b, inverse_rotate(b_in_a.q, -m.normal));
  return f;
}

/// The normal and the point of a manifold of one point once B stands at `then`, in A's frame. False where it has no
/// normal there. In closed form: the normal is that of the edge, wherever it turns, or from point to point; features
/// that have hardly moved are not searched for again.
inline bool meet_then(const geometry::Shape2& a, const geometry::Shape2& b, const ContactRecord<Dim2>& c,
                      const geometry::Manifold2& m, const Transform2f& then, geometry::Manifold2& found) {
  const RoundFeatures f = features_of(a, b, c.base, m);
  const Vec2f on_b = transform_point(then, f.b), between = on_b - f.a;
  found = m;
  if (f.edge_b) {
    found.normal = rotate(then.q, inverse_rotate(c.base.q, m.normal));
  } else if (!f.edge_a) {
    const float distance = math::length(between);
    if (!(distance > 1e-6f)) return false;
    found.normal = between * (1 / distance);
  }
  const float half_gap = 0.5f * (dot(between, found.normal) - f.radius_a - f.radius_b);
  found.points[0].point =
      f.edge_a ? on_b - found.normal * (f.radius_b + half_gap) : f.a + found.normal * (f.radius_a + half_gap);
  return true;
}
/// The same in space, of any manifold, by a search. False where other features meet then.
inline bool meet_then(const geometry::Shape3& a, const geometry::Shape3& b, const ContactRecord<Dim3>& c,
                      const geometry::Manifold3& m, const Transform3f& then, geometry::Manifold3& found) {
  geometry::PairCache cache = c.cache;
  const float reach = 2 * c.margin() + math::length(then.p - c.base.p);
  geometry::collide(a, b, then, reach, cache, found);
  bool same = found.count == m.count;
  for (int i = 0; same && i < m.count; ++i) same = found.points[i].feature == m.points[i].feature;
  return same;
}

/// Of a contact that turns.
template <class D>
bool middle_of_step(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Manifold& m,
                    float dt, MiddleOfStep<D>& out) {
  using V = typename D::Vector;
  PosesOfMiddle<D> then;
  typename D::Manifold found;
  if (!then.find(world, c, dt)) return false;
  const typename D::Shape &a = world.shapes.at(c.shape[0]).geometry, &b = world.shapes.at(c.shape[1]).geometry;
  if (!meet_then(a, b, c, m, then.b_in_a, found)) return false;
  if (!(dot(found.normal, m.normal) > 0.9f)) return false;
  const auto to_now = [&](const V& v) { return turned_in(then.frame_a, then.turn_a, v); };
  out.normal = to_now(found.normal);
  const V carried = inverse_rotate(then.frame_a, rotate(then.turn_a, then.arm_a) - then.arm_a);
  for (int i = 0; i < m.count; ++i) out.point[i] = to_now(found.points[i].point) + carried;
  out.across = then.way_b - then.way_a;
  return true;
}

}  // namespace carom::rigid::detail
