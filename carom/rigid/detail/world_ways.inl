// World's members that look at the last step: rays of what flies while bodies move.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/detail/body_way.h"
#include "carom/rigid/detail/world_queries.inl"
#include "carom/rigid/step_ways.h"

namespace carom::rigid {
namespace detail {

/// rad, from one attitude to another the short way.
inline float angle_between(const Rot2f& a, const Rot2f& b) {
  const Rot2f q = b * conjugate(a);
  return math::abs(math::atan2(q.s, q.c));
}
inline float angle_between(const Quatf& a, const Quatf& b) {
  const Quatf q = b * conjugate(a);
  return 2 * math::atan2(math::length(q.vector()), math::abs(q.w));
}

/// A moving body as it stood at a fraction of the step.
template <class D>
typename D::Pose pose_on_way(const WorldImplementation<D>& world, const typename StepWays<D>::Way& way, double time) {
  using Position = typename D::Position;
  const double part = time < double(way.end) ? time / double(way.end) : 1.0;
  const SweepStart<D> start{way.from_rotation, way.from, way.turn, way.end};
  typename D::Pose body;
  body.rotation = part > 0 ? rotation_after(start, way.rotation, float(part)) : way.from_rotation;
  const Position center = part < 1 ? way.from + (way.to - way.from) * part : way.to;
  body.position = center - Position(rotate(body.rotation, world.bodies.motion[std::size_t(way.body)].local_center));
  return body;
}
template <class D>
typename D::Pose pose_on_way(const WorldImplementation<D>& world, const ShapeRecord<D>& shape,
                             const typename StepWays<D>::Way& way, double time) {
  const typename D::Pose body = pose_on_way(world, way, time);
  return shape.at_origin ? body : body * shape.local;
}

/// How far a chord of cast_on_way may stray from the curve of its ray (m).
inline double stray_of_chord(double reach) { return 3e-4 * reach + 1e-6; }
/// The ball about a body in which cast_on_way follows rays (m).
inline double ball_of_chords(double reach) { return 1.001 * reach + 1e-3; }
/// Bodies that reach farther are not followed in a ball.
inline constexpr double most_reach = 1e5;  // m

/// Round all places of a shape on its body's way, so that no ray meets it (cast_on_way) that goes by the box.
template <class D>
typename D::Bounds bounds_on_way(const WorldImplementation<D>& world, const ShapeRecord<D>& shape,
                                 const typename StepWays<D>::Way& way) {
  using Position = typename D::Position;
  const double reach = double(world.bodies.motion[std::size_t(way.body)].outer_extent), angle = double(way.angle);
  if (angle > 0.5 && reach < most_reach)
    return geometry::grow(typename D::Bounds{min(way.from, way.to), max(way.from, way.to)}, ball_of_chords(reach));
  const typename D::Bounds now = world_bounds<D>(shape.geometry, shape_pose<D>(world, shape)),
                           then = world_bounds<D>(shape.geometry, pose_on_way(world, shape, way, 0));
  // An arc strays from its chord by 1 − cos(θ/2) of the arm.
  double slack = 1e-5 + 0.125 * angle * angle * reach;
  if (angle > 0) slack += stray_of_chord(math::min(reach, most_reach));
  // A plane has no end.
  Position far{};
  for (int k = 0; k < D::dimension; ++k) far[k] = 1e15;
  const typename D::Bounds box = geometry::grow(merge(now, then), slack);
  return {max(box.low, -far), min(box.high, far)};
}

template <class D>
struct MetOnWay {
  bool hit = false;
  float fraction = 1;
  typename D::Vector normal{};
  std::uint32_t child = 0;
};
/// The part of a line from `from` to `to` that lies in the ball of radius `reach` about zero; empty where first > last.
struct PartOfLine {
  double first = 0, last = 1;
};
template <class Position>
PartOfLine part_in_ball(const Position& from, const Position& to, double reach) {
  const Position way = to - from;
  const double a = math::dot(way, way), b = math::dot(from, way), c = math::dot(from, from) - reach * reach;
  if (!(a > 0)) return c <= 0 ? PartOfLine{0, 1} : PartOfLine{1, 0};
  const double inside = b * b - a * c;
  if (!(inside >= 0)) return {1, 0};
  const double root = math::sqrt(inside);
  return {math::max(0.0, (-b - root) / a), math::min(1.0, (-b + root) / a)};
}

/// A ray that begins at a fraction of the step and goes on to its end, against a shape that moves meanwhile. In the
/// frame of the shape it is a line where the body does not turn. Where it does, the ray is followed near the body, in
/// chords that stray from its curve by less than a three-thousandth of the body.
template <class D>
MetOnWay<D> cast_on_way(const WorldImplementation<D>& world, const ShapeRecord<D>& shape,
                        const typename StepWays<D>::Way& way, const RayQuery<D>& ray, double begin) {
  using Position = typename D::Position;
  const Position whole(ray.translation);
  const double reach = double(world.bodies.motion[std::size_t(way.body)].outer_extent);
  MetOnWay<D> met;
  const auto look = [&](double from, double to, int pieces) {
    const auto place_at = [&](double u) {
      return local_point(pose_on_way(world, shape, way, begin + u * (1 - begin)), ray.origin + whole * u);
    };
    auto here = place_at(from);
    for (int i = 1; i <= pieces; ++i) {
      const double u = from + (to - from) * (i - 1) / pieces, next = i == pieces ? to : from + (to - from) * i / pieces;
      const auto there = place_at(next);
      const auto hit = geometry::ray_cast(shape.geometry, here, there - here);
      here = there;
      if (!hit.hit) continue;
      const double at = u + double(hit.fraction) * (next - u);
      const auto pose = pose_on_way(world, shape, way, begin + at * (1 - begin));
      met = {true, float(at), rotate(pose.rotation, hit.normal), hit.child};
      return true;
    }
    return false;
  };
  const double left = math::max(1 - begin, 1e-12);
  const double stop = math::clamp((double(way.end) - begin) / left, 0.0, 1.0);  // of the ray: then the body stands
  if (stop > 0) {
    if (way.angle < 1e-5f) {
      if (look(0, stop, 1)) return met;
    } else {
      const Position back = (way.to - way.from) * (math::max(double(way.end) - begin, 0.0) / double(way.end));
      const Position from = ray.origin - (way.to - back), to = ray.origin + whole * stop - way.to;
      const PartOfLine near = reach < most_reach ? part_in_ball(from, to, ball_of_chords(reach)) : PartOfLine{};
      if (near.first <= near.last) {
        const double part = near.last - near.first;
        const double turn = double(way.angle) * part * math::min(1.0, (double(way.end) - begin) / double(way.end));
        const double arm = math::min(reach, most_reach);
        const double curve = turn * (0.25 * math::length(to - from) * part + 0.125 * turn * arm);
        const int pieces = 1 + int(math::min(63.0, math::sqrt(curve / stray_of_chord(arm))));
        if (look(near.first * stop, near.last * stop, pieces)) return met;
      }
    }
  }
  if (stop < 1) look(stop, 1, 1);
  return met;
}

/// What of a world is met where it stands, while the rest is on its ways.
template <class D>
struct Standing {
  const StepWays<D>& ways;
  bool tree(int t) const { return !ways.whole_tree[t]; }
  bool body(std::int32_t slot) const {
    return std::size_t(slot) >= ways.of_body.size() || ways.of_body[std::size_t(slot)] < 0;
  }
};
/// What is on its ways and meets a ray before `best`.
template <class D>
void meet_on_ways(const WorldImplementation<D>& world, const RayQuery<D>& ray, double begin, const StepWays<D>& ways,
                  RayHit<D>& best) {
  const typename D::Position way(ray.translation);
  const SeenFilter filter(world, ray.filter);
  std::int32_t best_slot = best.shape == ShapeId{} ? none : world.shapes.slots.slot(best.shape);
  const auto visit = [&](std::size_t place) {
    const std::int32_t slot = ways.shapes[place];
    const auto& shape = world.shapes.at(slot);
    if (!query_sees<D>(shape, filter)) return best.fraction;
    const auto& body = ways.ways[std::size_t(ways.of_body[std::size_t(shape.body)])];
    const MetOnWay<D> met = cast_on_way(world, shape, body, ray, begin);
    if (!met.hit || !is_nearer(met.fraction, slot, best.fraction, best_slot)) return best.fraction;
    best_slot = slot;
    best = {world.shapes.slots.handle_at(slot),
            ray.origin + way * double(met.fraction),
            met.normal,
            met.fraction,
            met.child,
            material_at(world, slot, geometry::material_of_part(shape.geometry, met.child)).user_id};
    return met.fraction;
  };
  typename D::Position extents{};
  const double slack = 2e-5 + 4e-6 * math::length(way);
  for (int k = 0; k < D::dimension; ++k) extents[k] = slack;
  if (!ways.tree.nodes.empty()) {
    cast(ways.tree, ray.origin, way, extents, best.fraction,
         [&](std::uint32_t place, float) { return visit(std::size_t(place)); });
  } else {
    for (std::size_t i = 0; i < ways.shapes.size(); ++i)
      if (reaches<D>(ray, geometry::grow(ways.boxes[i], slack))) visit(i);
  }
}

}  // namespace detail

template <class D>
void World<D>::find_ways(StepWays<D>& out, double ray_length) const {
  using namespace detail;
  const WorldImplementation<D>& world = *self_;
  out.clear();
  out.dt = world.last_dt;
  const std::size_t count = math::min(world.scratch.swept.size(), world.bodies.awake.size());
  int on_way[3] = {};  // shapes of each tree
  for (std::size_t place = 0; place < count; ++place) {
    const std::int32_t body = world.bodies.awake[place];
    const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
    const SweepStart<D>& start = world.scratch.swept[place];
    const Rotation& rotation = world.bodies.pose[std::size_t(body)].rotation;
    const bool round = !(start.turn == typename D::Angular{});
    if (start.center == m.center && start.rotation == rotation && !round) continue;
    const float angle = round ? size_of_turn(start.turn) : angle_between(start.rotation, rotation);
    if (!(float(math::length(m.center - start.center)) + angle * m.outer_extent > StepWays<D>::shortest)) continue;
    if (out.of_body.size() < world.bodies.record.size()) out.of_body.resize(world.bodies.record.size(), none);
    out.of_body[std::size_t(body)] = std::int32_t(out.ways.size());
    out.ways.push_back({body, start.rotation, rotation, start.center, m.center, start.turn, angle, start.fraction});
    for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
      const ShapeRecord<D>& shape = world.shapes.at(s);
      if (shape.leaf == none) continue;
      ++on_way[shape.tree];
      if ((shape.flags & shape_sensor) != 0) continue;
      out.shapes.push_back(s);
      out.boxes.push_back(bounds_on_way(world, shape, out.ways.back()));
    }
  }
  for (int t = 0; t < 3; ++t) out.whole_tree[t] = on_way[t] == world.shapes.trees[t].size();
  out.cells.fill(out.boxes, ray_length);
  constexpr std::size_t few = 3;
  if (out.boxes.size() <= few) return;
  out.order.clear();
  for (std::size_t i = 0; i < out.boxes.size(); ++i) out.order.push_back({out.boxes[i], std::uint32_t(i)});
  geometry::detail::build_wide_tree<Position>(out.order, 1, out.tree);
}

template <class D>
Result<typename D::Pose> World<D>::pose_in_step(BodyId body, double fraction, const StepWays<D>& ways) const {
  const Result<std::int32_t> slot = detail::slot_of(*self_, "pose_in_step", body);
  if (!slot.ok()) return slot.error();
  const auto* way = ways.way_of(body);
  return way == nullptr ? self_->bodies.pose[std::size_t(*slot)] : detail::pose_on_way(*self_, *way, fraction);
}

template <class D>
Status World<D>::cast_rays(std::span<const RayQuery<D>> rays, std::span<const float> begins, std::span<RayHit<D>> hits,
                           const StepWays<D>& ways) const {
  constexpr std::string_view call = "World::cast_rays";
  if (!begins.empty())
    if (const Status s = detail::check_batch(call, rays.size(), "begins", begins.size()); !s.ok()) return s;
  if (ways.shapes.empty()) return cast_rays(rays, hits);
  return detail::cast_in_groups<D>(*self_, rays, hits, detail::Standing<D>{ways}, [&](std::size_t i, RayHit<D>& best) {
    if (!ways.cells.crosses(rays[i].origin, rays[i].translation)) return;
    detail::meet_on_ways<D>(*self_, rays[i], begins.empty() ? 0.0 : double(begins[i]), ways, best);
  });
}

}  // namespace carom::rigid
