// Round contacts in the middle of the step. Where something rolls on something round, normal and arms turn while it
// does. A step that keeps those of its start pulls back too late: x and v of what rocks with ω go round by a map of
// determinant 1 + 3/8 (ωΔt)², and the swing grows by 3/16 ω²Δt a second. Those of the middle make it the midpoint rule,
// whose determinant is 1 − 1/8 (ωΔt)² for our substeps: nothing is gained.
#pragma once

#include "carom/geometry/manifold.h"
#include "carom/rigid/detail/contacts.h"

namespace carom::rigid::detail {

/// What changes until then, the points and the normal in A's shape frame as it stands at the start.
template <class D>
struct MiddleOfStep {
  typename D::Vector normal{};
  typename D::Vector point[D::max_points]{};
  typename D::Vector across{};  ///< m, world axes: how B's centre goes past A's
};

inline float size_of(float turn) { return math::abs(turn); }
inline float size_of(const Vec3f& turn) { return math::length(turn); }
inline Rot2f small_rotation(float turn) { return normalize(Rot2f(1, turn)); }
inline Quatf small_rotation(const Vec3f& turn) {
  return normalize(Quatf{1, 0.5f * turn.x, 0.5f * turn.y, 0.5f * turn.z});
}

/// May its normal turn, and does it carry a load?
template <class D>
bool may_turn(const ContactRecord<D>& c, const ManifoldRecord<D>& m) {
  if (!c.rolls || (c.flags & contact_many) != 0) return false;
  for (int i = 0; i < m.manifold.count; ++i)
    if (m.impulses.normal[i] > 0) return true;
  return false;
}

/// By the velocities that the bodies have now. False where they hardly move past each other, or so far that a blow is
/// more likely than rolling, or other features will meet then.
template <class D>
bool middle_of_step(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Manifold& m,
                    float dt, MiddleOfStep<D>& out) {
  using V = typename D::Vector;
  const float still = still_way(world, dt);
  if (!(still > 0)) return false;  // without gravity nothing rocks, and arms of the start are those of most blows
  const float half = 0.5f * dt, least = max(1e-3f * c.inner, 0.5f * still);
  const SolverBody<D>& sa = world.bodies.solver[std::size_t(c.body[0])];
  const SolverBody<D>& sb = world.bodies.solver[std::size_t(c.body[1])];
  const V way_a = half * sa.linear_velocity, way_b = half * sb.linear_velocity;
  const auto turn_a = half * sa.angular_velocity, turn_b = half * sb.angular_velocity;
  const V between =
      V(world.bodies.motion[std::size_t(c.body[1])].center - world.bodies.motion[std::size_t(c.body[0])].center);
  const V seen = way_b - way_a - cross(turn_a, between);
  const float turned = size_of(turn_b - turn_a) * c.extent;
  const float moved = math::length_squared(seen) + turned * turned, most = 0.03f * c.extent;
  if (!(moved > least * least && moved < most * most)) return false;

  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  const typename D::Pose now_a = shape_pose(world, a);
  const V arm_a = V(now_a.position - world.bodies.motion[std::size_t(c.body[0])].center);
  const auto rotation = small_rotation(turn_a);
  typename D::Pose then_a = now_a, then_b = shape_pose(world, b);
  const V arm_b = V(then_b.position - world.bodies.motion[std::size_t(c.body[1])].center);
  const auto rotation_b = small_rotation(turn_b);
  // A manifold of an earlier step is kept because little has changed.
  if (!(relative(now_a, then_b) == c.base)) return false;
  using P = typename D::Position;
  then_a.position = now_a.position + P(way_a + (rotate(rotation, arm_a) - arm_a));
  then_a.rotation = rotation * now_a.rotation;
  then_b.position = then_b.position + P(way_b + (rotate(rotation_b, arm_b) - arm_b));
  then_b.rotation = rotation_b * then_b.rotation;
  geometry::PairCache cache = c.cache;
  typename D::Manifold found;
  geometry::collide(a.geometry, b.geometry, relative(then_a, then_b), 2 * c.margin() + math::length(seen), cache,
                    found);
  if (found.count != m.count || !(dot(found.normal, m.normal) > 0.9f)) return false;
  for (int i = 0; i < m.count; ++i)
    if (found.points[i].feature != m.points[i].feature) return false;
  const auto to_now = [&](const V& v) {
    return inverse_rotate(now_a.rotation, rotate(rotation, rotate(now_a.rotation, v)));
  };
  out.normal = to_now(found.normal);
  const V carried = inverse_rotate(now_a.rotation, rotate(rotation, arm_a) - arm_a);
  for (int i = 0; i < m.count; ++i) out.point[i] = to_now(found.points[i].point) + carried;
  out.across = way_b - way_a;
  return true;
}

}  // namespace carom::rigid::detail
