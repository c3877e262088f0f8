// Continuous collision: what moved far in a step stops where it first met something it would otherwise pass.
#include "carom/geometry/compound.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

using Sweep2 = geometry::Sweep2;
using Sweep3 = geometry::Sweep3;
template <class D>
using Sweep = std::conditional_t<D::dimension == 2, Sweep2, Sweep3>;

Rot2f between(const Rot2f& a, const Rot2f& b, float t) {
  return normalize(Rot2f{a.c + t * (b.c - a.c), a.s + t * (b.s - a.s)});
}
Quatf between(const Quatf& a, const Quatf& b, float t) {
  const Quatf c = dot(a, b) < 0 ? -b : b;
  return normalize(a + (c - a) * t);
}

/// The same motion, of a shape that stands at `local` in what moves.
template <class S, class T>
S sweep_of_part(const S& s, const T& local) {
  return {inverse_rotate(local.q, s.local_center - local.p), s.c0, s.c1, s.q0 * local.q, s.q1 * local.q};
}
template <class S>
auto transform_at_end(const S& s) {
  using T = std::conditional_t<std::is_same_v<S, Sweep2>, Transform2f, Transform3f>;
  return T{s.c1 - rotate(s.q1, s.local_center), s.q1};
}

// Time of impact between any two shapes: a moves, b stands in the frame in which both sweeps are given.
geometry::TimeOfImpact impact(const geometry::Shape2& a, const Sweep2& sa, const geometry::Shape2& b,
                              const Sweep2& sb) {
  if (b.type != geometry::ShapeType2::chain) return geometry::time_of_impact(a, sa, b, sb);
  geometry::TimeOfImpact first;
  for (int i = 0; i < b.chain->segment_count(); ++i) {
    const geometry::TimeOfImpact t = geometry::time_of_impact(a, sa, geometry::Shape2(b.chain->segment(i)), sb);
    if (t.state != geometry::ImpactState::separated && t.time < first.time) first = t;
  }
  return first;
}
geometry::TimeOfImpact impact(const geometry::Shape3& a, const Sweep3& sa, const geometry::Shape3& b,
                              const Sweep3& sb) {
  const bool split_a = a.type == geometry::ShapeType3::compound;
  if (!split_a && b.type != geometry::ShapeType3::compound) return geometry::time_of_impact(a, sa, b, sb);
  geometry::TimeOfImpact first;
  for (const geometry::CompoundChild& child : (split_a ? a : b).compound->children) {
    const geometry::TimeOfImpact t = split_a ? impact(child.shape, sweep_of_part(sa, child.local), b, sb)
                                             : impact(a, sa, child.shape, sweep_of_part(sb, child.local));
    if (t.state != geometry::ImpactState::separated && t.time < first.time) first = t;
  }
  return first;
}

/// Does the end of the motion leave a shallow contact that the solver can put right by itself? Then nothing is to be
/// stopped, and a body that slides fast along a floor loses none of its way.
bool shallow_end(const geometry::Shape2& a, const Sweep2& sa, const geometry::Shape2& b, const Sweep2& sb,
                 float depth) {
  const Transform2f a_in_b = inverse(transform_at_end(sb)) * transform_at_end(sa);
  float deepest = 1;
  const auto look = [&](const geometry::Shape2& part) {
    geometry::PairCache cache;
    geometry::Manifold2 m;
    geometry::collide(part, a, a_in_b, depth, cache, m);
    for (int i = 0; i < m.count; ++i) deepest = min(deepest, m.points[i].separation);
  };
  if (b.type != geometry::ShapeType2::chain)
    look(b);
  else
    for (int i = 0; i < b.chain->segment_count(); ++i) look(geometry::Shape2(b.chain->segment(i)));
  return deepest < 1 && deepest > -depth;
}
bool shallow_end(const geometry::Shape3& a, const Sweep3& sa, const geometry::Shape3& b, const Sweep3& sb,
                 float depth) {
  const Transform3f a_in_b = inverse(transform_at_end(sb)) * transform_at_end(sa);
  geometry::Manifold3 m[8];
  int count;
  const auto simple = [](const geometry::Shape3& s) { return is_convex(s) || s.type == geometry::ShapeType3::plane; };
  if (simple(a) && simple(b)) {
    geometry::PairCache cache;
    geometry::collide(b, a, a_in_b, depth, cache, m[0]);
    count = m[0].count > 0 ? 1 : 0;
  } else {
    count = geometry::collide_many(b, a, a_in_b, depth, m);
  }
  float deepest = 1;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < m[i].count; ++k) deepest = min(deepest, m[i].points[k].separation);
  return deepest < 1 && deepest > -depth;
}

geometry::Shape2 core_shape(const Dim2*, float radius) { return geometry::Circle{radius}; }
geometry::Shape3 core_shape(const Dim3*, float radius) { return geometry::Sphere{radius}; }

template <class D>
Sweep<D> sweep_of_body(const WorldImplementation<D>& world, std::int32_t body, const SweepStart<D>& start,
                       const typename D::Position& base) {
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  return {m.local_center, typename D::Vector(start.center - base), typename D::Vector(m.center - base), start.rotation,
          world.bodies.pose[std::size_t(body)].rotation};
}

/// The fraction of its way that the body may go.
template <class D>
float free_fraction(const WorldImplementation<D>& world, std::int32_t body, std::size_t place, bool moving_too) {
  const BodyRecord& record = world.bodies.record[std::size_t(body)];
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  const SweepStart<D>& start = world.scratch.swept[place];
  const Sweep<D> sweep = sweep_of_body(world, body, start, start.center);
  float fraction = 1;
  const float core_radius = 0.25f * m.inner_extent;
  const float shallow = min(core_radius, 0.005f + 0.01f * m.inner_extent);
  for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none || (shape.flags & shape_sensor) != 0) continue;
    const Sweep<D> own = shape.at_origin ? sweep : sweep_of_part(sweep, shape.local);
    const double reach = double(m.outer_extent) + 0.01;
    const typename D::Position low = math::min(start.center, m.center), high = math::max(start.center, m.center);
    const typename D::Bounds box = geometry::grow(typename D::Bounds{low, high}, reach);
    const auto visit = [&](std::uint32_t item) {
      const ShapeRecord<D>& other = world.shapes.at(std::int32_t(item));
      if (other.body == body || (other.flags & shape_sensor) != 0 || !may_collide(world, shape, other)) return true;
      if (joints_forbid_collision(world, body, other.body)) return true;
      if (passes_one_way(world, std::int32_t(item), typename D::Vector(m.center - start.center))) return true;
      // Who has no contact may be one that the caller's filter refused.
      if (world.contact_filter && !world.pairs.contains(PairSet::key(s, std::int32_t(item))) &&
          !world.contact_filter(world.shapes.slots.handle_at(s), world.shapes.slots.handle_at(int(item))))
        return true;
      const typename D::Pose& pose = world.bodies.pose[std::size_t(other.body)];
      // One that was stopped stands where it stopped: its way no longer takes the whole step.
      SweepStart<D> other_start{pose.rotation, world.bodies.motion[std::size_t(other.body)].center};
      const std::int32_t other_place = world.bodies.record[std::size_t(other.body)].awake_index;
      if (other_place != none && !world.scratch.swept[std::size_t(other_place)].stopped)
        other_start = world.scratch.swept[std::size_t(other_place)];
      Sweep<D> theirs = sweep_of_body(world, other.body, other_start, start.center);
      if (!other.at_origin) theirs = sweep_of_part(theirs, other.local);
      geometry::TimeOfImpact t = impact(shape.geometry, own, other.geometry, theirs);
      if (t.state == geometry::ImpactState::separated || t.state == geometry::ImpactState::failed) return true;
      if (t.state == geometry::ImpactState::overlapped || t.time <= 0) {
        // It touched from the start, as on the ground: only its core must not pass.
        const Sweep<D> core{{}, sweep.c0, sweep.c1, sweep.q0, sweep.q1};
        t = impact(core_shape(static_cast<const D*>(nullptr), core_radius), core, other.geometry, theirs);
        if (t.state != geometry::ImpactState::hit || t.time <= 0) return true;
      } else if (shallow_end(shape.geometry, own, other.geometry, theirs, shallow)) {
        return true;
      }
      fraction = min(fraction, t.time);
      return true;
    };
    world.shapes.trees[tree_fixed].query(box, visit);
    if (moving_too) {
      world.shapes.trees[tree_kinematic].query(box, visit);
      world.shapes.trees[tree_dynamic].query(box, visit);
    }
  }
  return fraction;
}

template <class D>
void move_to_fraction(WorldImplementation<D>& world, std::int32_t body, std::size_t place, float fraction) {
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  if (fraction < 1) {
    SweepStart<D>& start = world.scratch.swept[place];
    start.stopped = true;
    m.center = start.center + (m.center - start.center) * double(fraction);
    typename D::Pose& pose = world.bodies.pose[std::size_t(body)];
    pose.rotation = between(start.rotation, pose.rotation, fraction);
    pose_from_center(world, body);
  }
  update_world_inertia(world, body);
  if (leave_bounds(world, body)) world.scratch.body_changes[place] = body_outgrew;
}

}  // namespace

template <class D>
void stop_fast_bodies(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  StepScratch<D>& scratch = world.scratch;
  scratch.fast.clear();
  for (std::size_t i = 0; i < world.bodies.awake.size(); ++i)
    if (world.bodies.record[std::size_t(world.bodies.awake[i])].flags & body_fast)
      scratch.fast.push_back(std::int32_t(i));
  if (scratch.fast.empty()) return;
  const auto is_bullet = [&](std::int32_t body) {
    return (world.bodies.record[std::size_t(body)].flags & body_bullet) != 0;
  };
  // Fixed geometry first, each body by itself.
  const auto stop = [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      const std::size_t place = std::size_t(scratch.fast[std::size_t(k)]);
      const std::int32_t body = world.bodies.awake[place];
      if (!is_bullet(body)) move_to_fraction(world, body, place, free_fraction(world, body, place, false));
    }
  };
  if (world.contact_filter)
    stop(0, int(scratch.fast.size()), 0);  // the caller's function is only ever called on the caller's thread
  else
    context.scheduler.parallel_for(int(scratch.fast.size()), 4, stop);
  // Then bullets, one after another, against everything where it now is.
  for (const std::int32_t place : scratch.fast) {
    const std::int32_t body = world.bodies.awake[std::size_t(place)];
    if (is_bullet(body))
      move_to_fraction(world, body, std::size_t(place), free_fraction(world, body, std::size_t(place), true));
  }
}

template void stop_fast_bodies<Dim2>(StepContext<Dim2>&);
template void stop_fast_bodies<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
