// Continuous collision: what moved far in a step stops where it first met something it would otherwise pass.
//
// Fixed and kinematic bodies first, each fast body by itself. Then bullets and all else that moves: every pair whose
// ways come near each other is asked when it meets, and the meetings happen in the order of their times; whose way was
// cut by one is asked again about its others. So two bullets meet at one moment, wherever a third has sent one of them.
#include <algorithm>
#include <optional>

#include "carom/rigid/detail/way_candidates.h"

namespace carom::rigid::detail {
namespace {

template <class D>
bool is_fast_bullet(const WorldImplementation<D>& world, std::int32_t body) {
  constexpr unsigned both = body_bullet | body_fast;
  return (world.bodies.record[std::size_t(body)].flags & both) == both;
}
/// The same, whoever of the two lists it: the bullet first, of two the one in the lower place.
template <class D>
BulletPair pair_of(const WorldImplementation<D>& world, std::int32_t s, std::int32_t o) {
  const std::int32_t body[2] = {world.shapes.at(s).body, world.shapes.at(o).body};
  const std::int32_t place[2] = {world.bodies.record[std::size_t(body[0])].awake_index,
                                 world.bodies.record[std::size_t(body[1])].awake_index};
  const bool first = is_fast_bullet(world, body[0]) && (!is_fast_bullet(world, body[1]) || place[0] < place[1]);
  if (first) return {s, o, {place[0], place[1]}, {none, none}};
  return {o, s, {place[1], place[0]}, {none, none}};
}

/// Is the body let through by a one-way surface, or not held by it where both touch already?
template <class D>
bool one_way(const WorldImplementation<D>& world, std::int32_t shape) {
  const ShapeExtra<D>* extra = world.shapes.extra(shape);
  return extra != nullptr && extra->one_way != typename D::Vector{};
}

/// What moves goes on after a body was stopped at it, and a thin side would be past the body: a mesh, and what goes on
/// by a good part of the thickness of either, takes the body along for the rest of the step.
template <class D>
void carry_on(WorldImplementation<D>& world, std::int32_t own, std::int32_t at, float fraction) {
  using V = typename D::Vector;
  const ShapeRecord<D>&shape = world.shapes.at(own), &other = world.shapes.at(at);
  if (other.tree == tree_fixed) return;
  BodyMotion<D>& m = world.bodies.motion[std::size_t(shape.body)];
  const typename D::Position base = m.center;
  const Sweep<D> way = way_of_body(world, other.body, base, fraction, 1);
  const V rest = way.c1 + rotate(way.q1, inverse_rotate(way.q0, V{} - way.c0));
  const float least = is_surface(other.geometry) ? 0 : 0.5f * min(shape.inner_extent, other.inner_extent);
  if (!(math::length_squared(rest) > least * least)) return;
  m.center = base + typename D::Position(rest);
  pose_from_center(world, shape.body);
}

/// Stops a body at what is not moved by forces; lists what it may meet of the rest.
template <class D>
void go_past_fixed(WorldImplementation<D>& world, std::int32_t body, std::size_t place, bool any_bullets,
                   std::vector<BulletPair>& pairs, std::vector<StrayShape<D>>& strays,
                   std::vector<SensorMeeting>& sensors) {
  const BodyRecord& record = world.bodies.record[std::size_t(body)];
  const bool bullet = (record.flags & body_bullet) != 0;
  const SweepStart<D>& start = world.scratch.swept[place];
  const bool alone = !any_bullets && world.shapes.moving_surfaces == 0;  // what forces move does not stop it
  const BodyMotion<D>& motion = world.bodies.motion[std::size_t(body)];
  const typename D::Bounds whole{math::min(start.center, motion.center), math::max(start.center, motion.center)};
  std::optional<StillNear<D>> still;
  const int list = has_several_shapes(world, body) ? StillNear<D>::capacity : 0;
  if (alone && still.emplace(world, geometry::grow(whole, double(motion.outer_extent)), list).count == 0) return;
  const Sweep<D> sweep = way_of_body(world, body, start.center);
  const typename D::Vector travel = sweep.c1 - sweep.c0;
  const float turn = turned_by(sweep.q0, sweep.q1);
  // No point of the body came farther, unless it turned far.
  const bool turns_far = start.turn != typename D::Angular{};
  const double farthest = 1.1 * double(math::length(travel) + turn * motion.outer_extent);
  float fraction = 1;
  std::int32_t by = none, at = none;  // which of its shapes is stopped first, and at which
  for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none) continue;
    // Most shapes of a long body are far from all of it: their bounds held them where the step began.
    if (list > 0 && alone && !turns_far &&
        still->is_far(geometry::grow(world.shapes.trees[shape.tree].bounds(shape.leaf), farthest)))
      continue;
    const Sweep<D> own = way_of_shape(shape, sweep);
    const float most_slow = bullet ? 0.25f : 0.5f;
    bool slow = false;  // by itself it passes nothing; what is driven may pass it
    if (!turns_far) {
      const MiddleWay<D> middle(shape, own, turn);
      slow = middle.is_slow(shape, most_slow);
      if (slow && world.scratch.driven.empty()) continue;
      if (list > 0 && alone && still->is_free(world, middle.box(start.center))) continue;
    }
    const typename D::Bounds box = bounds_of_way(world, shape, own, start);
    // Bullets look for all that moves where its bounds foresaw its way; what left them looks for bullets, and what of
    // both left them is looked through once more.
    const bool foreseen = geometry::contains(world.shapes.trees[shape.tree].bounds(shape.leaf), box);
    const bool stray = any_bullets && !foreseen && !slow;
    const bool looks = bullet || stray || world.shapes.moving_surfaces > 0;
    if (stray && (shape.flags & shape_sensor) == 0) strays.push_back({box, s});
    const unsigned kinds =
        slow ? unsigned(with_kinematic) : with_fixed | with_kinematic | (looks ? unsigned(with_dynamic) : 0u);
    for_candidates(world, s, box, foreseen, kinds, [&](std::int32_t o) {
      const ShapeRecord<D>& other = world.shapes.at(o);
      if (((shape.flags | other.flags) & shape_sensor) != 0) {
        sensors.push_back({s, o});
        return;
      }
      if (passes_one_way(world, o, travel)) return;
      if (other.tree == tree_dynamic) {
        // Meshes have thin sides: they stop what is no bullet too.
        if (bullet || is_fast_bullet(world, other.body))
          pairs.push_back(pair_of(world, s, o));
        else if (is_surface(other.geometry))
          pairs.push_back(
              {s, o, {std::int32_t(place), world.bodies.record[std::size_t(other.body)].awake_index}, {none, none}});
        return;
      }
      if (other.tree == tree_kinematic && !turns_far &&
          is_slow(shape, own, way_of_body(world, other.body, start.center), most_slow))
        return;
      const float t = meeting_time(world, shape, other, start.center, 0, 1, !one_way(world, o));
      if (t < fraction) fraction = t, by = s, at = o;
    });
  }
  stop_at(world, body, fraction);
  if (at != none) carry_on(world, by, at, fraction);
}

/// Lists pairs of shapes that both left their bounds and whose ways come near each other: along x, in order.
template <class D>
void pair_strays(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  std::vector<StrayShape<D>>& strays = scratch.strays;
  strays.clear();
  for (const std::vector<StrayShape<D>>& list : scratch.found_strays)
    strays.insert(strays.end(), list.begin(), list.end());
  std::sort(strays.begin(), strays.end(), [](const StrayShape<D>& l, const StrayShape<D>& r) {
    return l.box.low.x != r.box.low.x ? l.box.low.x < r.box.low.x : l.shape < r.shape;
  });
  for (std::size_t i = 0; i < strays.size(); ++i)
    for (std::size_t k = i + 1; k < strays.size() && strays[k].box.low.x <= strays[i].box.high.x; ++k) {
      const std::int32_t s = strays[i].shape, o = strays[k].shape;
      if (!overlaps(strays[i].box, strays[k].box)) continue;
      if (!is_fast_bullet(world, world.shapes.at(s).body) && !is_fast_bullet(world, world.shapes.at(o).body)) continue;
      if (may_meet(world, s, o)) scratch.bullet_pairs.push_back(pair_of(world, s, o));
    }
}

/// The fraction of the step at which a pair meets, as far as both ways are known; above 1: it does not. Until `after`
/// it is known not to.
template <class D>
float meeting_time(const WorldImplementation<D>& world, const BulletPair& pair, float after) {
  if (stay_far(world, pair)) return 2;
  const ShapeRecord<D>&own = world.shapes.at(pair.own), &other = world.shapes.at(pair.other);
  const auto fraction = [&](int side) {
    return pair.place[side] == none ? 0.0f : world.scratch.swept[std::size_t(pair.place[side])].fraction;
  };
  const float a = fraction(0), b = fraction(1), ends[2] = {min(a, b), max(a, b)};
  const typename D::Position base = world.scratch.swept[std::size_t(pair.place[0])].center;
  const bool guarded = !one_way(world, pair.other);
  float from = after;
  for (const float to : ends) {  // first both move, then the one that was not stopped
    if (to <= from) continue;
    if (const float t = meeting_time(world, own, other, base, from, to, guarded); t < 1) return t;
    from = to;
  }
  return 2;
}

/// Lets bullets meet what moves, in the order of time.
template <class D>
void meet_in_order(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  StepScratch<D>& scratch = world.scratch;
  std::vector<BulletPair>& pairs = scratch.bullet_pairs;
  std::vector<BulletMeeting>& heap = scratch.bullet_meetings;
  const auto later = [](const BulletMeeting& l, const BulletMeeting& r) { return r < l; };
  const auto name = [](const BulletPair& p) { return std::uint64_t(p.own) << 32 | std::uint32_t(p.other); };
  std::sort(pairs.begin(), pairs.end(), [&](const BulletPair& l, const BulletPair& r) { return name(l) < name(r); });
  pairs.erase(std::unique(pairs.begin(), pairs.end(),
                          [&](const BulletPair& l, const BulletPair& r) { return name(l) == name(r); }),
              pairs.end());
  scratch.first_bullet_pair.assign(world.bodies.awake.size(), none);
  heap.clear();
  // Nobody has been stopped yet: when each pair meets by itself is asked side by side.
  scratch.pair_meetings.resize(pairs.size());
  context.scheduler.parallel_for(int(pairs.size()), 32, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      scratch.pair_meetings[std::size_t(i)] = meeting_time(world, pairs[std::size_t(i)], 0);
  });
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int side = 0; side < 2; ++side) {
      if (pairs[i].place[side] == none) continue;
      std::int32_t& first = scratch.first_bullet_pair[std::size_t(pairs[i].place[side])];
      pairs[i].next[side] = first;
      first = 2 * std::int32_t(i) + side;
    }
    if (const float t = scratch.pair_meetings[i]; t < 1) heap.push_back({t, std::int32_t(i)});
  }
  std::make_heap(heap.begin(), heap.end(), later);
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), later);
    const BulletMeeting meeting = heap.back();
    heap.pop_back();
    const BulletPair& pair = pairs[std::size_t(meeting.pair)];
    if (scratch.pair_meetings[std::size_t(meeting.pair)] != meeting.time) continue;  // another one came first
    // Both are stopped before one is taken along: bullets that meet stay where they do.
    bool stopped[2] = {};
    for (int side = 0; side < 2; ++side) {
      if (pair.place[side] == none) continue;
      const std::int32_t body = world.bodies.awake[std::size_t(pair.place[side])];
      const std::int32_t facing = side == 0 ? pair.other : pair.own;
      const bool held = (world.bodies.record[std::size_t(body)].flags & body_bullet) != 0 ||
                        is_surface(world.shapes.at(facing).geometry);
      stopped[side] = held && scratch.swept[std::size_t(pair.place[side])].fraction > meeting.time;
      if (stopped[side]) stop_at(world, body, meeting.time);
    }
    if (stopped[0]) carry_on(world, pair.own, pair.other, meeting.time);
    if (stopped[1]) carry_on(world, pair.other, pair.own, meeting.time);
    for (int side = 0; side < 2; ++side) {
      if (!stopped[side]) continue;
      for (std::int32_t key = scratch.first_bullet_pair[std::size_t(pair.place[side])]; key != none;) {
        const BulletPair& changed = pairs[std::size_t(key >> 1)];
        // What it would have met before now has come up before now.
        float& t = scratch.pair_meetings[std::size_t(key >> 1)];
        t = meeting_time(world, changed, meeting.time);
        if (t < 1) {
          heap.push_back({t, key >> 1});
          std::push_heap(heap.begin(), heap.end(), later);
        }
        key = changed.next[key & 1];
      }
    }
  }
}

/// What turns so fast that it strikes again at once, step after step, would never come free: it grinds, and loses half
/// of its spin in a step that let it go nowhere.
template <class D>
void slow_what_jams(WorldImplementation<D>& world, std::int32_t body, const SweepStart<D>& start, float dt) {
  SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
  if (start.fraction < 0.005f && size_of_turn(s.angular_velocity) * dt > 0.25f) s.angular_velocity *= 0.5f;
}

/// What fell freely until it was stopped has not gained what the rest of its way would have given.
template <class D>
void take_back_gravity(WorldImplementation<D>& world, std::int32_t body, const SweepStart<D>& start, float dt) {
  if (start.fraction >= 1) return;
  std::int32_t held = world.bodies.record[std::size_t(body)].constraint_count;
  if (held != 0)
    for_each_joint(world, body, [&](std::int32_t joint, int, std::int32_t) {
      const bool holds = world.joints.headers[std::size_t(joint)].place.color >= 0;
      if (holds && is_welded(world.joints.at(joint))) --held;
    });
  if (held != 0) return;
  const float pace = world.bodies.pace(body);
  const float gained = world.bodies.motion[std::size_t(body)].gravity_scale * (1 - start.fraction) * dt * pace * pace;
  world.bodies.solver[std::size_t(body)].linear_velocity -= world.definition.gravity * gained;
}

/// A begin and an end for every sensor that was flown through from one side to the other, in the order of the shapes.
/// What a body still is in at the end of its way, the next step sees anyway.
template <class D>
void report_crossed(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  std::vector<SensorMeeting>& all = scratch.met_sensors[0];
  for (std::size_t w = 1; w < scratch.met_sensors.size(); ++w)
    all.insert(all.end(), scratch.met_sensors[w].begin(), scratch.met_sensors[w].end());
  std::erase_if(all, [&](const SensorMeeting& m) {
    const ShapeRecord<D>&a = world.shapes.at(m.own), &b = world.shapes.at(m.other);
    const typename D::Position base = world.bodies.motion[std::size_t(a.body)].center;
    const Sweep<D> own = way_of_shape(a, way_of_body(world, a.body, base)),
                   theirs = way_of_shape(b, way_of_body(world, b.body, base));
    const geometry::TimeOfImpact t = geometry::time_of_impact(a.geometry, own, b.geometry, theirs, 1e-4f);
    return t.state != geometry::ImpactState::hit || t.time <= 0 ||
           geometry::overlap(a.geometry, b.geometry, relative(shape_pose(world, a), shape_pose(world, b)));
  });
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

/// For some of all kinds, so that the first bullet of a warm world allocates nothing.
template <class D>
void make_room(StepScratch<D>& scratch, std::size_t bodies) {
  constexpr std::size_t some = 64;
  const auto room = [](auto& list) {
    if (list.capacity() < some) list.reserve(some);
  };
  for (auto& list : scratch.met_sensors) room(list);
  for (auto& list : scratch.found_bullet_pairs) room(list);
  for (auto& list : scratch.found_strays) room(list);
  room(scratch.strays);
  room(scratch.driven);
  room(scratch.driven_over);
  room(scratch.tied);
  room(scratch.bullet_pairs);
  room(scratch.bullet_meetings);
  room(scratch.pair_meetings);
  if (scratch.first_bullet_pair.capacity() < bodies) scratch.first_bullet_pair.reserve(bodies);
}

/// What is in the way of a wall that is driven fast is looked at like what is fast itself, however slow; who sleeps
/// there wakes.
template <class D>
void add_who_is_driven_over(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.driven.empty()) return;
  std::vector<std::int32_t>& bodies = scratch.driven_over;
  bodies.clear();
  for (const StrayShape<D>& wall : scratch.driven)
    for_candidates(world, wall.shape, wall.box, false, with_dynamic, [&](std::int32_t s) {
      const std::int32_t body = world.shapes.at(s).body;
      if ((world.bodies.record[std::size_t(body)].flags & body_fast) == 0) bodies.push_back(body);
    });
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  for (const std::int32_t body : bodies) rouse_body(world, body);
  enter_graph_in_order(world);
  for (std::size_t place = scratch.swept.size(); place < world.bodies.awake.size(); ++place) {
    const std::size_t body = std::size_t(world.bodies.awake[place]);
    scratch.swept.push_back({world.bodies.pose[body].rotation, world.bodies.motion[body].center, {}, 1});
    scratch.body_changes.push_back(0);
  }
  for (const std::int32_t body : bodies) {
    world.bodies.record[std::size_t(body)].flags |= body_fast;
    look_at_bounds(world.bodies.motion[std::size_t(body)]);
    scratch.fast.push_back(world.bodies.record[std::size_t(body)].awake_index);
  }
  std::sort(scratch.fast.begin(), scratch.fast.end());
}

}  // namespace

template <class D>
void stop_fast_bodies(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  StepScratch<D>& scratch = world.scratch;
  scratch.fast.clear();
  bool any_bullets = false;
  for (std::size_t i = 0; i < world.bodies.awake.size(); ++i) {
    if (scratch.body_changes[i] != body_flew) continue;
    scratch.body_changes[i] = 0;
    scratch.fast.push_back(std::int32_t(i));
    const std::uint16_t flags = world.bodies.record[std::size_t(world.bodies.awake[i])].flags;
    any_bullets = any_bullets || (flags & body_bullet) != 0;
  }
  if (!scratch.fast.empty() || world.shapes.trees[tree_kinematic].size() > 0)
    make_room(scratch, world.bodies.awake.capacity());
  if (world.definition.continuous) find_driven(world), add_who_is_driven_over(world);
  if (scratch.fast.empty()) return;
  for (std::vector<SensorMeeting>& list : scratch.met_sensors) list.clear();
  for (std::vector<BulletPair>& list : scratch.found_bullet_pairs) list.clear();
  for (std::vector<StrayShape<D>>& list : scratch.found_strays) list.clear();
  const auto go = [&](int begin, int end, int worker) {
    const auto look_at_soon = [&](int k) __attribute__((always_inline)) {  // as prefetch_lines
      const std::size_t place = std::size_t(scratch.fast[std::size_t(k)]);
      const std::int32_t body = world.bodies.awake[place];
      const BodyRecord& soon = world.bodies.record[std::size_t(body)];
      __builtin_prefetch(&scratch.swept[place]);
      prefetch_lines(&world.bodies.motion[std::size_t(body)], 128);
      if (soon.first_shape != none) prefetch_lines(&world.shapes.at(soon.first_shape), 192);
      if (soon.first_contact != none) prefetch_lines(&world.contacts.at(soon.first_contact >> 1), 128);
    };
    for (int k = begin; k < end; ++k) {
      const std::size_t place = std::size_t(scratch.fast[std::size_t(k)]);
      if (k + 3 < end) look_at_soon(k + 3);
      go_past_fixed(world, world.bodies.awake[place], place, any_bullets,
                    scratch.found_bullet_pairs[std::size_t(worker)], scratch.found_strays[std::size_t(worker)],
                    scratch.met_sensors[std::size_t(worker)]);
    }
  };
  if (world.contact_filter)
    go(0, int(scratch.fast.size()), 0);  // the caller's function is only ever called on the caller's thread
  else
    context.scheduler.parallel_for(int(scratch.fast.size()), 16, go);
  level_room(scratch.met_sensors);
  level_room(scratch.found_bullet_pairs);
  level_room(scratch.found_strays);
  scratch.bullet_pairs.clear();
  for (const std::vector<BulletPair>& list : scratch.found_bullet_pairs)
    scratch.bullet_pairs.insert(scratch.bullet_pairs.end(), list.begin(), list.end());
  pair_strays(world);
  if (!scratch.bullet_pairs.empty()) meet_in_order(context);
  stop_what_is_tied(context);
  context.scheduler.parallel_for(int(scratch.fast.size()), 64, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      const std::size_t place = std::size_t(scratch.fast[std::size_t(k)]);
      const std::int32_t body = world.bodies.awake[place];
      slow_what_jams(world, body, scratch.swept[place], context.dt);
      take_back_gravity(world, body, scratch.swept[place], context.dt);
      const bool stopped = scratch.swept[place].fraction < 1;
      if (D::dimension == 3 && stopped) update_world_inertia(world, body);
      if ((stopped || may_leave_bounds(world.bodies.motion[std::size_t(body)])) && leave_bounds(world, body))
        scratch.body_changes[place] = body_outgrew;
    }
  });
  report_crossed(world);
}

template void stop_fast_bodies<Dim2>(StepContext<Dim2>&);
template void stop_fast_bodies<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
