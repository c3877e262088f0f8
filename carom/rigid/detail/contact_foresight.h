// Where bodies will meet. What flies past another a good part of its own size in a step meets it with another normal
// than the one that the two have when the step begins, and with other arms.
#pragma once

#include "carom/geometry/manifold.h"
#include "carom/rigid/detail/contacts.h"

namespace carom::rigid::detail {

/// A manifold as it will be when the surfaces meet, in A's shape frame; each point half of its separation from either
/// surface, the separations (m, along the normal) those of now.
template <class D>
struct Foreseen {
  typename D::Manifold manifold;
  typename D::Vector across{};  ///< m, world axes: how B goes past A until then, without what is along the normal
};

inline float radius_of(const geometry::Shape2& s) {
  return s.type == geometry::ShapeType2::circle ? s.circle.radius : 0;
}
inline float radius_of(const geometry::Shape3& s) {
  return s.type == geometry::ShapeType3::sphere ? s.sphere.radius : 0;
}

/// Two balls, c from A's centre to B's, w the velocity of B against A, r the sum of the radii: they meet when
/// |c + w t| = r, or pass at the least distance. False where they part.
template <class V>
bool meeting_of_balls(const V& c, const V& w, float r, float separation, float dt, float& t) {
  const float a = dot(w, w), b = dot(c, w), far = separation * (2 * r + separation);  // c² − r²
  if (!(b < 0)) return false;
  const float discriminant = b * b - a * far;
  t = min(discriminant > 0 ? far / (math::sqrt(discriminant) - b) : -b / a, dt);
  return true;
}

/// Is it a contact of which to foresee more than its gap? Of balls all that are apart; of other shapes, which keep
/// their manifolds, those of two moving bodies that are not near yet.
template <class D>
inline bool may_foresee(const ContactRecord<D>& c) {
  if ((c.flags & contact_many) != 0) return false;
  return (c.flags & contact_round) != 0 || (c.flags & (contact_dynamic | contact_recycled)) == contact_dynamic;
}
template <class D>
bool may_foresee(const ContactRecord<D>& c, const ManifoldRecord<D>& m) {
  if (!may_foresee(c)) return false;
  const float least = (c.flags & contact_round) != 0 ? 0 : c.margin();
  for (int i = 0; i < m.manifold.count; ++i)
    if (!(m.manifold.points[i].separation > least) || m.impulses.normal[i] > 0) return false;
  return true;
}

/// By the velocities that the bodies have now. False where they part, or go past each other by less than a hundredth
/// of their thickness.
template <class D>
bool foresee(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Manifold& m, float dt,
             Foreseen<D>& out) {
  using V = typename D::Vector;
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  const typename D::Pose pose_a = shape_pose(world, a), pose_b = shape_pose(world, b);
  const float ra = radius_of(a.geometry), rb = radius_of(b.geometry);
  V w{};
  for (int side = 0; side < 2; ++side) {
    const std::size_t body = std::size_t(c.body[side]);
    const SolverBody<D>& s = world.bodies.solver[body];
    // A ball's own turns do not move it, nor its surface; of other shapes only the ways of the bodies count.
    const bool of_b = ra > 0 && rb > 0 ? side == 1 : rb > 0;
    V v = s.linear_velocity;
    if (ra > 0 || rb > 0)
      v += cross(s.angular_velocity, V((of_b ? pose_b : pose_a).position - world.bodies.motion[body].center));
    w = side == 0 ? w - v : w + v;
  }
  const V way = inverse_rotate(pose_a.rotation, w), past = way - m.normal * dot(m.normal, way);
  if (!(math::length_squared(past) * dt * dt > math::square(0.01f * c.inner))) return false;
  typename D::Manifold& then = out.manifold;
  then = m;
  float t = 0;
  if (ra > 0 && rb > 0) {
    const V center = inverse_rotate(pose_a.rotation, V(pose_b.position - pose_a.position));
    if (!meeting_of_balls(center, way, ra + rb, m.points[0].separation, dt, t)) return false;
    const V met = center + way * t;
    const float distance = math::length(met);
    if (!(distance > 0)) return false;
    then.normal = met / distance;
    then.points[0].separation = distance - (ra + rb);
    then.points[0].point = then.normal * (ra + 0.5f * then.points[0].separation);
  } else {
    // Advanced by what the gap lets pass, as often as the normal turns by it.
    for (int i = 0; i < 4; ++i) {
      float left = then.points[0].separation;
      for (int k = 1; k < then.count; ++k) left = min(left, then.points[k].separation);
      const float closing = -dot(then.normal, way);
      const float next = closing > 0 ? min(t + left / closing, dt) : t;
      if (!(next > t)) break;
      t = next;
      geometry::PairCache cache;
      typename D::Transform there = c.base;
      there.p += way * t;
      typename D::Manifold found;
      geometry::collide(a.geometry, b.geometry, there, left + 2 * c.margin(), cache, found);
      if (found.count == 0) return false;
      const bool turned = dot(found.normal, then.normal) < 0.99999f;
      then = found;
      if (!turned) break;
    }
  }
  const float along = t * dot(then.normal, way);
  for (int i = 0; i < then.count; ++i) {
    then.points[i].point -= then.normal * (0.5f * along);
    then.points[i].separation -= along;
    if (!(then.points[i].separation > 0)) return false;
  }
  out.across = w * t - rotate(pose_a.rotation, then.normal) * along;
  return true;
}

}  // namespace carom::rigid::detail
