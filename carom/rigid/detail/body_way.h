// The ways of bodies in a step, for continuous collision.
#pragma once

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/passage.h"
#include "carom/rigid/detail/fly_past.h"
#include "carom/rigid/detail/rotation_step.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {

template <class D>
using Sweep = std::conditional_t<D::dimension == 2, geometry::Sweep2, geometry::Sweep3>;

inline Rot2f between(const Rot2f& a, const Rot2f& b, float t) {
  return normalize(Rot2f{a.c + t * (b.c - a.c), a.s + t * (b.s - a.s)});
}
inline Quatf between(const Quatf& a, const Quatf& b, float t) {
  const Quatf c = dot(a, b) < 0 ? -b : b;
  return normalize(a + (c - a) * t);
}

/// The attitude of a body after a part of its way that ends in `end`.
template <class D>
typename D::Rotation rotation_after(const SweepStart<D>& start, const typename D::Rotation& end, float part) {
  if (part == 1) return end;
  if (start.turn == typename D::Angular{}) return between(start.rotation, end, part);
  return rotation_by(start.turn * part) * start.rotation;
}

/// The way of a body from one fraction of the step to another, seen from `base`. What was stopped stands from then on.
template <class D>
Sweep<D> way_of_body(const WorldImplementation<D>& world, std::int32_t body, const typename D::Position& base,
                     float from = 0, float to = 1) {
  using V = typename D::Vector;
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  const typename D::Rotation& rotation = world.bodies.pose[std::size_t(body)].rotation;
  const std::int32_t place = world.bodies.record[std::size_t(body)].awake_index;
  if (place == none) return {m.local_center, V(m.center - base), V(m.center - base), rotation, rotation};
  const SweepStart<D>& start = world.scratch.swept[std::size_t(place)];
  if (from == 0 && to >= start.fraction)
    return {m.local_center, V(start.center - base), V(m.center - base), start.rotation, rotation};
  Sweep<D> s{m.local_center, {}, {}, {}, {}};
  const auto look = [&](float time, V& center, typename D::Rotation& q) {
    const float f = start.fraction > 0 ? min(time / start.fraction, 1.0f) : 1.0f;
    center = V(start.center + (m.center - start.center) * double(f) - base);
    q = rotation_after(start, rotation, f);
  };
  look(from, s.c0, s.q0);
  look(to, s.c1, s.q1);
  return s;
}
template <class D>
Sweep<D> way_of_shape(const ShapeRecord<D>& shape, const Sweep<D>& body) {
  return shape.at_origin ? body : geometry::detail::sweep_of_part(body, shape.local);
}

/// A body that is set back in its turn has the spin that it had there in its own axes: kept in the world's, it would
/// be about another axis of the body, and that of a rod that spins about its length would gain energy a hundredfold.
inline void set_back_spin(SolverBody<Dim2>&, const Rot2f&, const Rot2f&) {}
inline void set_back_spin(SolverBody<Dim3>& s, const Quatf& from, const Quatf& to) {
  const Quatf back = to * conjugate(from);
  s.angular_velocity = rotate(back, s.angular_velocity);
  s.spin_rest_x = s.spin_rest_y = s.spin_rest_z = 0;
}

/// Stops a body at a fraction of the step.
template <class D>
void stop_at(WorldImplementation<D>& world, std::int32_t body, float fraction) {
  SweepStart<D>& start = world.scratch.swept[std::size_t(world.bodies.record[std::size_t(body)].awake_index)];
  if (fraction >= start.fraction) return;
  const float f = fraction / start.fraction;
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  m.center = start.center + (m.center - start.center) * double(f);
  typename D::Pose& pose = world.bodies.pose[std::size_t(body)];
  const typename D::Rotation end = pose.rotation;
  pose.rotation = rotation_after(start, end, f);
  if (m.gyroscopic || world.bodies.record[std::size_t(body)].joint_count > 0)
    set_back_spin(world.bodies.solver[std::size_t(body)], end, pose.rotation);
  start.turn = start.turn * f;
  pose_from_center(world, body);
  start.fraction = fraction;
}

/// Calls use(part, sweep, inner extent) for the convex parts of a shape.
template <class Use>
void for_parts(const ShapeRecord<Dim2>& shape, const geometry::Sweep2& sweep, Use&& use) {
  use(shape.geometry, sweep, shape.inner_extent);
}
template <class Use>
void for_parts(const ShapeRecord<Dim3>& shape, const geometry::Sweep3& sweep, Use&& use) {
  if (shape.geometry.type != geometry::ShapeType3::compound) return use(shape.geometry, sweep, shape.inner_extent);
  for (const geometry::CompoundChild& child : shape.geometry.compound->children)
    use(child.shape, geometry::detail::sweep_of_part(sweep, child.local), shape.inner_extent);
}

/// The fraction of its way that a shape may go past another, both in one frame.
template <class D>
float free_fraction(const ShapeRecord<D>& shape, const Sweep<D>& own, const ShapeRecord<D>& other,
                    const Sweep<D>& theirs, bool guarded) {
  float limit = 1;
  for_parts(shape, own, [&](const typename D::Shape& part, const Sweep<D>& way, float inner) {
    for_parts(other, theirs, [&](const typename D::Shape& other_part, const Sweep<D>& other_way, float) {
      limit = geometry::detail::free_fraction({part, way, inner, guarded}, other_part, other_way, limit);
    });
  });
  return limit;
}

/// Is it worth while to ask when the balls about such shapes touch?
inline bool is_solid(const geometry::Shape2&) { return false; }
inline bool is_solid(const geometry::Shape3& s) { return has_inside(s); }

inline float size_of_turn(float turn) { return math::abs(turn); }
inline float size_of_turn(const Vec3f& turn) { return math::length(turn); }

/// Do the balls about two bodies come near each other on their ways?
template <class D>
bool come_near(const WorldImplementation<D>& world, std::int32_t a, std::int32_t b, const Sweep<D>& way_a,
               const Sweep<D>& way_b) {
  using V = typename D::Vector;
  const BodyMotion<D>&ma = world.bodies.motion[std::size_t(a)], &mb = world.bodies.motion[std::size_t(b)];
  const V start = way_b.c0 - way_a.c0, way = way_b.c1 - way_a.c1 - start;
  const float length_squared = dot(way, way);
  const float f = length_squared > 0 ? clamp(-dot(start, way) / length_squared, 0.0f, 1.0f) : 0.0f;
  return math::length(start + way * f) <= ma.outer_extent + mb.outer_extent + 0.01f;
}

/// Do the balls about two bodies that nothing has stopped yet stay apart? Most do, which is told without their turns.
template <class D>
bool stay_far(const WorldImplementation<D>& world, const BulletPair& pair) {
  using V = typename D::Vector;
  typename D::Position from[2], to[2];
  float reach = 0.01f;
  const std::int32_t shapes[2] = {pair.own, pair.other};
  for (int side = 0; side < 2; ++side) {
    const std::int32_t place = pair.place[side];
    const BodyMotion<D>& m = world.bodies.motion[std::size_t(place == none ? world.shapes.at(shapes[side]).body
                                                                           : world.bodies.awake[std::size_t(place)])];
    from[side] = to[side] = m.center;
    reach += m.outer_extent;
    if (place == none) continue;
    const SweepStart<D>& start = world.scratch.swept[std::size_t(place)];
    if (start.fraction < 1) return false;
    from[side] = start.center;
  }
  const V start(from[1] - from[0]), way = V(to[1] - to[0]) - start;
  const float length_squared = dot(way, way);
  const float f = length_squared > 0 ? clamp(-dot(start, way) / length_squared, 0.0f, 1.0f) : 0.0f;
  return math::length_squared(start + way * f) > reach * reach;
}

/// Do two shapes stay apart on their ways, seen at a glance?
inline bool goes_past(const ShapeRecord<Dim2>&, const Sweep<Dim2>&, const ShapeRecord<Dim2>&, const Sweep<Dim2>&) {
  return false;
}
inline bool goes_past(const ShapeRecord<Dim3>& shape, const Sweep<Dim3>& own, const ShapeRecord<Dim3>& other,
                      const Sweep<Dim3>& theirs) {
  const auto way_of = [](const ShapeRecord<Dim3>& s, const Sweep<Dim3>& way) {
    const ShapeBall<Dim3> ball = ball_about(s);
    const Vec3f arm = ball.middle - way.local_center, from = way.c0 + rotate(way.q0, arm);
    // The arc of a point strays from its chord by 1 − cos(θ/2) of its arm; rounding apart.
    const float bend = 1 - min(math::abs(dot(way.q0, way.q1)), 1.0f) + 1e-6f;
    const float turned = way.q0 == way.q1 ? 0 : 2 * min(length(way.q1 - way.q0), length(way.q1 + way.q0)) + 1e-6f;
    return BallWay{from,        way.c1 + rotate(way.q1, arm) - from, way.q0,
                   ball.radius, 1.001f * bend * math::length(arm),   1.001f * turned * ball.radius};
  };
  return fly_past(shape.geometry, other.geometry, way_of(shape, own), way_of(other, theirs), 0.005f);
}

/// From when to when (0…1 of their ways) may the balls about two shapes touch, each drawn about the centre that its
/// body turns about? False: never.
inline bool time_near(const ShapeRecord<Dim2>&, const Sweep<Dim2>&, const ShapeRecord<Dim2>&, const Sweep<Dim2>&,
                      float&, float&) {
  return true;
}
inline bool time_near(const ShapeRecord<Dim3>& shape, const Sweep<Dim3>& own, const ShapeRecord<Dim3>& other,
                      const Sweep<Dim3>& theirs, float& begin, float& end) {
  const auto reach_of = [](const ShapeRecord<Dim3>& s, const Sweep<Dim3>& way) {
    const ShapeBall<Dim3> ball = ball_about(s);
    const Vec3f middle = s.at_origin ? ball.middle : transform_point(s.local, ball.middle);
    return ball.radius + math::length(middle - way.local_center);
  };
  const float reach = 1.001f * (reach_of(shape, own) + reach_of(other, theirs)) + 0.01f;
  const Vec3f start = theirs.c0 - own.c0, way = theirs.c1 - own.c1 - start;
  const float a = dot(way, way), b = dot(start, way), c = dot(start, start) - reach * reach;
  if (c <= 0 && dot(start + way, start + way) <= reach * reach) return true;
  if (!(a > 0)) return c <= 0;
  // In double: of a long way c is a small difference.
  const double discriminant = double(b) * double(b) - double(a) * double(c);
  if (discriminant < 0) return false;
  const double root = math::sqrt(discriminant);
  const float first = float((-double(b) - root) / double(a)), last = float((-double(b) + root) / double(a));
  if (first > 1 || last < 0) return false;
  begin = max(first, 0.0f), end = min(last, 1.0f);
  return true;
}

/// The first fraction of the step, between two, at which a shape must stop at another, seen from `base`; 2: none. A
/// body that turns far goes in arcs of one radian and a half at most.
template <class D>
float meeting_time(const WorldImplementation<D>& world, const ShapeRecord<D>& shape, const ShapeRecord<D>& other,
                   const typename D::Position& base, float from, float to, bool guarded) {
  Sweep<D> body_own = way_of_body(world, shape.body, base, from, to),
           body_theirs = way_of_body(world, other.body, base, from, to);
  if (other.tree != tree_fixed) {
    if (!come_near(world, shape.body, other.body, body_own, body_theirs)) return 2;
    // Only while they are near each other.
    if (is_solid(shape.geometry) && is_solid(other.geometry)) {
      float begin = 0, end = 1;
      if (!time_near(shape, body_own, other, body_theirs, begin, end)) return 2;
      if (begin > 0 || end < 1) {
        const float length = to - from;
        to = end < 1 ? from + length * end : to;
        from += length * begin;
        body_own = way_of_body(world, shape.body, base, from, to);
        body_theirs = way_of_body(world, other.body, base, from, to);
      }
    }
  }
  float turn = 0;  // rad from one to the other
  for (const std::int32_t body : {shape.body, other.body})
    if (const std::int32_t place = world.bodies.record[std::size_t(body)].awake_index; place != none) {
      const SweepStart<D>& start = world.scratch.swept[std::size_t(place)];
      if (start.turn == typename D::Angular{} || !(start.fraction > from)) continue;
      turn = max(turn, size_of_turn(start.turn) * ((min(to, start.fraction) - from) / start.fraction));
    }
  const int arcs = turn == 0 ? 1 : int(turn / 1.5f) + 1;
  for (int i = 0; i < arcs; ++i) {
    const float begin = from + (to - from) * (float(i) / float(arcs));
    const float end = i + 1 == arcs ? to : from + (to - from) * (float(i + 1) / float(arcs));
    if (arcs > 1) {
      body_own = way_of_body(world, shape.body, base, begin, end);
      body_theirs = way_of_body(world, other.body, base, begin, end);
      // Two that fly past each other are near for one or two arcs of many.
      if (other.tree != tree_fixed && !come_near(world, shape.body, other.body, body_own, body_theirs)) continue;
    }
    const Sweep<D> own = way_of_shape(shape, body_own), theirs = way_of_shape(other, body_theirs);
    if (goes_past(shape, own, other, theirs)) continue;
    const float f = free_fraction(shape, own, other, theirs, guarded);
    if (f < 1) return begin + (end - begin) * f;
  }
  return 2;
}

}  // namespace carom::rigid::detail
