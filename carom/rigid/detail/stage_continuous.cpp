// Continuous collision: what moved far in a step stops where it first met something it would otherwise pass.
#include <algorithm>

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/hull.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr float stop_distance = 0.0025f;  ///< m before the surface

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
using TransformOf = std::conditional_t<std::is_same_v<S, Sweep2>, Transform2f, Transform3f>;
template <class S>
TransformOf<S> transform_at_start(const S& s) {
  return {s.c0 - rotate(s.q0, s.local_center), s.q0};
}
template <class S>
TransformOf<S> transform_at_end(const S& s) {
  return {s.c1 - rotate(s.q1, s.local_center), s.q1};
}

// Time of impact between any two shapes: a moves, b stands in the frame in which both sweeps are given.
geometry::TimeOfImpact impact(const geometry::Shape2& a, const Sweep2& sa, const geometry::Shape2& b, const Sweep2& sb,
                              float target) {
  return geometry::time_of_impact(a, sa, b, sb, target);
}
geometry::TimeOfImpact impact(const geometry::Shape3& a, const Sweep3& sa, const geometry::Shape3& b, const Sweep3& sb,
                              float target) {
  const bool split_a = a.type == geometry::ShapeType3::compound;
  if (!split_a && b.type != geometry::ShapeType3::compound) return geometry::time_of_impact(a, sa, b, sb, target);
  geometry::TimeOfImpact first;
  for (const geometry::CompoundChild& child : (split_a ? a : b).compound->children) {
    const geometry::TimeOfImpact t = split_a ? impact(child.shape, sweep_of_part(sa, child.local), b, sb, target)
                                             : impact(a, sa, child.shape, sweep_of_part(sb, child.local), target);
    if (t.state != geometry::ImpactState::separated && t.time < first.time) first = t;
  }
  return first;
}

/// The contacts at the end of the motion, in the frame of b.
template <class Use>
void end_contacts(const geometry::Shape2& a, const geometry::Shape2& b, const Transform2f& a_in_b, float depth,
                  Use&& use) {
  const auto look = [&](const geometry::Shape2& part) {
    geometry::PairCache cache;
    geometry::Manifold2 m;
    geometry::collide(part, a, a_in_b, depth, cache, m);
    use(m);
  };
  if (b.type != geometry::ShapeType2::chain)
    look(b);
  else
    geometry::detail::visit_segments(*b.chain, geometry::grow(geometry::bounds(a, a_in_b), depth), [&](int i) {
      look(geometry::Shape2(b.chain->segment(i)));
      return true;
    });
}
template <class Use>
void end_contacts(const geometry::Shape3& a, const geometry::Shape3& b, const Transform3f& a_in_b, float depth,
                  Use&& use) {
  geometry::Manifold3 m[8];
  int count;
  const auto simple = [](const geometry::Shape3& s) { return is_convex(s) || s.type == geometry::ShapeType3::plane; };
  if (simple(a) && simple(b)) {
    geometry::PairCache cache;
    geometry::collide(b, a, a_in_b, depth, cache, m[0]);
    count = 1;
  } else {
    count = geometry::collide_many(b, a, a_in_b, depth, m);
  }
  for (int i = 0; i < count; ++i) use(m[i]);
}

/// Does the end of the motion leave a shallow contact that the solver can put right by itself? Then nothing is to be
/// stopped, and a body that slides fast along a floor loses none of its way. What moved farther than `way` along the
/// contact's normal came out on the other side.
template <class Shape, class S>
bool shallow_end(const Shape& a, const S& sa, const Shape& b, const S& sb, float depth, float way) {
  const auto end = inverse(transform_at_end(sb)) * transform_at_end(sa);
  const auto start = inverse(transform_at_start(sb)) * transform_at_start(sa);
  float deepest = 1;
  bool through = false;
  end_contacts(a, b, end, depth, [&](const auto& m) {
    for (int k = 0; k < m.count; ++k) {
      const auto before = transform_point(start, inverse_transform_point(end, m.points[k].point));
      through = through || dot(m.normal, m.points[k].point - before) > way;
      deepest = min(deepest, m.points[k].separation);
    }
  });
  return !through && deepest < 1 && deepest > -depth;
}

/// What must not pass of a shape that touches already: the shape less 3/4 of its half thickness, or what stands for
/// that.
template <class D>
struct Core {
  typename D::Shape shape;
  typename D::Transform local{};  ///< in the frame of what it is the core of
};
/// The line between the farthest corner from the centre and the one opposite, drawn in by `by`.
template <class V>
bool longest_line(std::span<const V> corners, V center, float by, V& from, V& to) {
  from = to = center;
  float most = 0;
  for (const V& v : corners)
    if (const float d = math::distance_squared(v, center); d > most) most = d, from = v;
  most = 0;
  for (const V& v : corners)
    if (const float d = dot(v - center, center - from); d > most) most = d, to = v;
  const V way = to - from;
  const float length = math::length(way);
  if (!(length > 2.5f * by)) return false;
  from += way * (by / length), to -= way * (by / length);
  return true;
}
Core<Dim2> skeleton(const geometry::Shape2& s, float inner, Vec2f center) {
  const float by = 0.75f * inner, radius = 0.25f * inner;
  if (s.type == geometry::ShapeType2::capsule) return {geometry::Capsule2{s.capsule.half_length, radius}, {}};
  Vec2f a, b;
  if (s.type == geometry::ShapeType2::polygon &&
      longest_line<Vec2f>({s.polygon.vertices, std::size_t(s.polygon.count)}, s.polygon.centroid, by, a, b)) {
    const Vec2f way = b - a;
    const float length = math::length(way);
    return {geometry::Capsule2{0.5f * length, 0.5f * radius},
            {(a + b) * 0.5f, normalize(Rot2f{way.y / length, -way.x / length})}};
  }
  return {geometry::Circle{radius}, {center, {}}};
}
Core<Dim3> skeleton(const geometry::Shape3& s, float inner, Vec3f center) {
  const float by = 0.75f * inner, radius = 0.25f * inner;
  switch (s.type) {
    case geometry::ShapeType3::capsule:
      return {geometry::Capsule3{s.capsule.half_length, radius}, {}};
    case geometry::ShapeType3::box: {
      const float least = s.box.radius - by;
      return {geometry::Box{s.box.half_extents + Vec3f{least, least, least}}, {}};
    }
    case geometry::ShapeType3::cylinder:
      return {geometry::Cylinder{s.cylinder.half_height - by, s.cylinder.radius - by}, {}};
    case geometry::ShapeType3::hull: {
      Vec3f a, b;
      if (!longest_line<Vec3f>(s.hull->vertices, s.hull->centroid, by, a, b)) break;
      const Vec3f way = b - a;
      const float length = math::length(way);
      // From local y to the line.
      const Quatf turn = way.y > -0.999f * length
                             ? normalize(Quatf{1 + way.y / length, cross(Vec3f{0, 1, 0}, way / length)})
                             : Quatf{0, {1, 0, 0}};
      return {geometry::Capsule3{0.5f * length, 0.5f * radius}, {(a + b) * 0.5f, turn}};
    }
    default:
      break;
  }
  return {geometry::Sphere{radius}, {center, {}}};
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

/// The fraction of its way after which a body that touches `other` already would pass it: with its core, with a ball
/// about the centre of mass, or with that centre itself. 1 where none does.
template <class D>
float core_fraction(const ShapeRecord<D>& shape, const Sweep<D>& own, const ShapeRecord<D>& other,
                    const Sweep<D>& theirs, float core_radius) {
  float fraction = 1;
  for (int level = 0; level < 2; ++level) {
    const Core<D> core = level == 0
                             ? skeleton(shape.geometry, shape.inner_extent, own.local_center)
                             : Core<D>{core_shape(static_cast<const D*>(nullptr), core_radius), {own.local_center, {}}};
    const geometry::TimeOfImpact t =
        impact(core.shape, sweep_of_part(own, core.local), other.geometry, theirs, stop_distance);
    if (t.state == geometry::ImpactState::hit && t.time > 0) fraction = min(fraction, t.time);
  }
  const auto from = inverse_transform_point(transform_at_start(theirs), own.c0);
  const auto way = inverse_transform_point(transform_at_end(theirs), own.c1) - from;
  const auto hit = geometry::ray_cast(other.geometry, from, way);
  if (!hit.hit || hit.normal == decltype(hit.normal){}) return fraction;
  constexpr float before = 0.001f;  // m
  const float length = math::length(way);
  return min(fraction, max(0.0f, hit.fraction - before / max(length, before)));
}

/// The fraction of its way that the body may go.
template <class D>
float free_fraction(const WorldImplementation<D>& world, std::int32_t body, std::size_t place, bool moving_too,
                    std::vector<SensorMeeting>& met) {
  const BodyRecord& record = world.bodies.record[std::size_t(body)];
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  const SweepStart<D>& start = world.scratch.swept[place];
  const Sweep<D> sweep = sweep_of_body(world, body, start, start.center);
  float fraction = 1;
  const float core_radius = 0.25f * m.inner_extent;
  const float shallow = min(core_radius, 0.005f + 0.01f * m.inner_extent);
  for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none) continue;
    const bool sensor = (shape.flags & shape_sensor) != 0;
    const Sweep<D> own = shape.at_origin ? sweep : sweep_of_part(sweep, shape.local);
    const double reach = double(m.outer_extent) + 0.01;
    const typename D::Position low = math::min(start.center, m.center), high = math::max(start.center, m.center);
    const typename D::Bounds box = geometry::grow(typename D::Bounds{low, high}, reach);
    const auto visit = [&](std::uint32_t item) {
      const ShapeRecord<D>& other = world.shapes.at(std::int32_t(item));
      if (other.body == body || !may_collide(world, shape, other)) return true;
      if (joints_forbid_collision(world, body, other.body)) return true;
      if (passes_one_way(world, std::int32_t(item), typename D::Vector(m.center - start.center))) return true;
      // Who has no contact may be one that the caller's filter refused.
      if (world.contact_filter && !world.pairs.contains(PairSet::key(s, std::int32_t(item))) &&
          !world.contact_filter(world.shapes.slots.handle_at(s), world.shapes.slots.handle_at(int(item))))
        return true;
      const bool crosses_sensor = sensor || (other.flags & shape_sensor) != 0;
      const typename D::Pose& pose = world.bodies.pose[std::size_t(other.body)];
      // One that was stopped stands where it stopped: its way no longer takes the whole step.
      SweepStart<D> other_start{pose.rotation, world.bodies.motion[std::size_t(other.body)].center};
      const std::int32_t other_place = world.bodies.record[std::size_t(other.body)].awake_index;
      if (other_place != none && !world.scratch.swept[std::size_t(other_place)].stopped)
        other_start = world.scratch.swept[std::size_t(other_place)];
      Sweep<D> theirs = sweep_of_body(world, other.body, other_start, start.center);
      if (!other.at_origin) theirs = sweep_of_part(theirs, other.local);
      geometry::TimeOfImpact t =
          impact(shape.geometry, own, other.geometry, theirs, crosses_sensor ? 1e-4f : stop_distance);
      if (crosses_sensor) {
        if (t.state == geometry::ImpactState::hit && t.time > 0) met.push_back({s, std::int32_t(item), t.time});
        return true;
      }
      if (t.state == geometry::ImpactState::separated || t.state == geometry::ImpactState::failed) return true;
      if (t.state == geometry::ImpactState::overlapped || t.time <= 0) {
        // It touched from the start, as on the ground: only its core must not pass.
        // Whom a one-way surface lets through from aside it does not hold by the core either.
        const ShapeExtra<D>* extra = world.shapes.extra(std::int32_t(item));
        if (extra != nullptr && extra->one_way != typename D::Vector{}) return true;
        t.time = core_fraction(shape, own, other, theirs, core_radius);
        if (t.time >= 1) return true;
      } else if (shallow_end(shape.geometry, own, other.geometry, theirs, shallow, core_radius)) {
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

/// Of what a body met on its way since `first`, keeps the sensors that it flew through from one side to the other: it
/// met them before its way was cut, and at its end is in none. What it still is in, the next step sees anyway.
template <class D>
void keep_crossed(const WorldImplementation<D>& world, float fraction, std::size_t first,
                  std::vector<SensorMeeting>& met) {
  std::size_t kept = first;
  for (std::size_t i = first; i < met.size(); ++i) {
    const ShapeRecord<D>&a = world.shapes.at(met[i].own), &b = world.shapes.at(met[i].other);
    if (met[i].time > fraction) continue;
    if (geometry::overlap(a.geometry, b.geometry, relative(shape_pose(world, a), shape_pose(world, b)))) continue;
    met[kept++] = met[i];
  }
  met.resize(kept);
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

/// A begin and an end for every sensor that was flown through, in the order of the shapes.
template <class D>
void report_crossed(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  std::vector<SensorMeeting>& all = scratch.met_sensors[0];
  for (std::size_t w = 1; w < scratch.met_sensors.size(); ++w)
    all.insert(all.end(), scratch.met_sensors[w].begin(), scratch.met_sensors[w].end());
  for (SensorMeeting& m : all)
    if ((world.shapes.at(m.own).flags & shape_sensor) != 0) std::swap(m.own, m.other);
  std::sort(all.begin(), all.end(), [](const SensorMeeting& l, const SensorMeeting& r) {
    return l.other != r.other ? l.other < r.other : l.own < r.own;
  });
  const auto same = [](const SensorMeeting& l, const SensorMeeting& r) { return l.other == r.other && l.own == r.own; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  for (const SensorMeeting& m : all) {
    const SensorEvent event{world.shapes.slots.handle_at(m.other), world.shapes.slots.handle_at(m.own)};
    scratch.sensor_begin.push_back(event);
    scratch.sensor_end.push_back(event);
  }
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
  for (std::vector<SensorMeeting>& list : scratch.met_sensors) list.clear();
  const auto go = [&](std::int32_t body, std::size_t place, bool moving_too, int worker) {
    std::vector<SensorMeeting>& met = scratch.met_sensors[std::size_t(worker)];
    const std::size_t first = met.size();
    const float fraction = free_fraction(world, body, place, moving_too, met);
    move_to_fraction(world, body, place, fraction);
    keep_crossed(world, fraction, first, met);
  };
  // Fixed geometry first, each body by itself.
  const auto stop = [&](int begin, int end, int worker) {
    for (int k = begin; k < end; ++k) {
      const std::size_t place = std::size_t(scratch.fast[std::size_t(k)]);
      const std::int32_t body = world.bodies.awake[place];
      if (!is_bullet(body)) go(body, place, false, worker);
    }
  };
  if (world.contact_filter)
    stop(0, int(scratch.fast.size()), 0);  // the caller's function is only ever called on the caller's thread
  else
    context.scheduler.parallel_for(int(scratch.fast.size()), 4, stop);
  // Then bullets, one after another, against everything where it now is.
  for (const std::int32_t place : scratch.fast) {
    const std::int32_t body = world.bodies.awake[std::size_t(place)];
    if (is_bullet(body)) go(body, std::size_t(place), true, 0);
  }
  report_crossed(world);
}

template void stop_fast_bodies<Dim2>(StepContext<Dim2>&);
template void stop_fast_bodies<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
