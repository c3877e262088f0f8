// What becomes of a pair that is looked at: whether it needs new manifolds, what was found of it, and what it waits for
// (part of stage_narrow_phase.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

/// Parts are named by their triangle, cell or child; what they are made of may change (edits).
template <class D>
bool same_patch(const ManifoldRecord<D>& m, std::uint32_t child, const typename D::Manifold& found) {
  return m.manifold.child == child && m.manifold.material == found.material;
}

template <class D>
std::uint8_t update_sensor(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, const typename D::Transform& b_in_a) {
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    return change_apart;
  const bool is = geometry::overlap(a.geometry, b.geometry, b_in_a), was = (c.flags & contact_touching) != 0;
  if (is == was) return 0;
  c.flags ^= contact_touching;
  return is ? change_begin : change_end;
}

/// How far the points of a manifold that was just made close in this step by the velocities that their bodies have
/// there. A turn bends their ways.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Manifold& m) {
  using V = typename D::Vector;
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[0]);
  const typename D::Pose pose = shape_pose(world, shape);
  const V normal = rotate(pose.rotation, m.normal);
  float farthest = -1e30f;
  for (int i = 0; i < m.count; ++i) {
    const typename D::Position point = world_point(pose, m.points[i].point);
    float closing = 0;
    for (int side = 0; side < 2; ++side) {
      const std::size_t body = std::size_t(c.body[side]);
      const SolverBody<D>& s = world.bodies.solver[body];
      const V arm = V(point - world.bodies.motion[body].center);
      const float way = dot(normal, s.linear_velocity + cross(s.angular_velocity, arm)) * world.last_dt;
      closing += (side == 0 ? way : -way) + bend_of(world.bodies.motion[body], s.angular_velocity * world.last_dt, arm);
    }
    farthest = max(farthest, closing - m.points[i].separation);
  }
  return farthest + smallest_separation(m);
}

/// Nearer than the margin, or so near that they may meet in this step?
template <class D>
bool of_interest(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& sweep,
                 const typename D::Manifold& m, float separation) {
  if (separation <= c.margin()) return true;
  if (separation > c.margin() + look_ahead(world, c, sweep, m.normal)) return false;
  return separation <= c.margin() + look_ahead(world, c, m);
}

/// The normal of a manifold as the axis along which the shapes are apart. That of a manifold may be bent (over_border).
template <class D>
void go_on_apart(ContactRecord<D>& c, const ShapeRecord<D>& a, const ShapeRecord<D>& b, const typename D::Manifold& m) {
  if constexpr (D::dimension == 3)
    if (!is_convex(a.geometry) || !is_convex(b.geometry)) return;
  const typename D::Vector back = inverse_rotate(c.base.q, -m.normal);
  const float apart = dot(m.normal, transform_point(c.base, support(b.geometry, back)) - support(a.geometry, m.normal));
  if (!(apart > c.margin())) return;
  c.axis = m.normal;
  c.gap = min(c.gap, apart);
}

/// Two convex shapes, or a plane: one manifold at most, which was found within `reach` (m).
template <class D>
std::uint8_t update_convex(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, float reach, ShapeSweep<D>& sweep, const typename D::Manifold& m,
                           std::vector<FoundManifold<D>>& list) {
  c.gap = reach;
  c.axis = {};
  if (m.count == 0) {
    // Pairs are to be looked at before they leave each other's bounds for good.
    c.gap = max(reach, min(m.points[0].separation, reach + c.inner));
    c.axis = m.normal;
    return part(world, c, a, b);
  }
  const float separation = smallest_separation(m);
  c.gap = min(reach, separation);
  if (!of_interest(world, c, sweep, m, separation)) {
    go_on_apart(c, a, b, m);
    return part(world, c, a, b);
  }
  const std::uint8_t change = touch_change(c, c.gap, pressed_any(world.contacts, c));
  const bool waits = D::dimension == 2 && c.manifold_count == 1;
  if ((c.flags & contact_round) == 0 && ((c.flags & contact_touching) != 0 || waits) && c.gap < c.margin()) {
    c.flags |= contact_recycled;  // in the steps to come, which may not look at it, and why not in this one
    watch_recycled(world, c, c.base, longest_way(world, c), c.gap, m.normal, c.extent);
  }
  if (c.first_manifold == none) {
    list.push_back({c.awake_index, 0, 0, m});
    return std::uint8_t(change | change_manifolds);
  }
  ManifoldRecord<D>& record = world.contacts.manifold(c.first_manifold);
  carry_impulses<D>(record.manifold, m, 0.2f * c.inner, record.impulses);
  record.manifold = m;
  return change;
}

/// One of the shapes has many parts.
template <class D>
std::uint8_t update_many(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                         const ShapeRecord<D>& b, float reach, ShapeSweep<D>& sweep,
                         std::vector<FoundManifold<D>>& list) {
  ContactStore<D>& store = world.contacts;
  Found<D> found;
  if constexpr (D::dimension == 3)
    collide_all(a.geometry, b.geometry, c.base, reach, approach_of(world, c, reach), c.cache, found);
  else
    collide_all(a.geometry, b.geometry, c.base, reach, found);
  c.gap = found.count == 0 ? found.apart : reach;
  c.axis = {};
  int kept = 0;
  for (int i = 0; i < found.count; ++i) {
    const float s = smallest_separation(found.manifold[i]);
    c.gap = min(c.gap, s);
    if (!of_interest(world, c, sweep, found.manifold[i], s)) continue;
    if (kept != i) {
      found.manifold[kept] = found.manifold[i];
      found.child[kept] = found.child[i];
    }
    ++kept;
  }
  if (kept == 0 && found.count > 0 && found.near > 0) c.gap = min(c.gap, found.near);
  found.count = kept;
  if (found.count == 0) return part(world, c, a, b);
  int matched = 0;
  for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
    for (int i = 0; i < found.count; ++i)
      if (same_patch(store.manifold(m), found.child[i], found.manifold[i])) {
        ++matched;
        break;
      }
  }
  const std::uint8_t change = touch_change(c, c.gap, pressed_any(store, c));
  if (matched == found.count && matched == c.manifold_count) {
    for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
      ManifoldRecord<D>& record = store.manifold(m);
      for (int i = 0; i < found.count; ++i)
        if (same_patch(record, found.child[i], found.manifold[i])) {
          carry_impulses<D>(record.manifold, found.manifold[i], 0.2f * c.inner, record.impulses);
          record.manifold = found.manifold[i];
          break;
        }
    }
    return change;
  }
  for (int i = 0; i < found.count; ++i) list.push_back({c.awake_index, i, found.child[i], found.manifold[i]});
  return std::uint8_t(change | change_manifolds);
}

/// Do two that go far past each other in this step stay apart, by the velocities that their bodies have? Those whose
/// way is shorter than twice the thickness of the thinner have their surfaces asked.
bool goes_past(const WorldImplementation<Dim2>&, const ContactRecord<Dim2>&, const ShapeRecord<Dim2>&,
               const ShapeRecord<Dim2>&) {
  return false;
}
bool goes_past(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c, const ShapeRecord<Dim3>& a,
               const ShapeRecord<Dim3>& b) {
  const std::vector<BodySweep<Dim3>>& sweeps = world.scratch.sweeps;
  const Vec3f way = sweeps[std::size_t(c.body[1])].way - sweeps[std::size_t(c.body[0])].way;
  const float length_squared = math::length_squared(way);
  if (!(length_squared > square(4 * c.inner)) || !has_inside(a.geometry) || !has_inside(b.geometry)) return false;
  const BodyMotion<Dim3>& motion_a = world.bodies.motion[std::size_t(c.body[0])];
  const BodyMotion<Dim3>& motion_b = world.bodies.motion[std::size_t(c.body[1])];
  const Vec3d base = motion_a.center;
  // Most are told by the balls about their bodies.
  const Vec3f start(motion_b.center - base);
  const float f = clamp(-dot(start, way) / length_squared, 0.0f, 1.0f);
  if (math::length_squared(start + way * f) > square(motion_a.outer_extent + motion_b.outer_extent + 2 * c.margin()))
    return true;
  const auto way_of = [&](const ShapeRecord<Dim3>& shape) {
    const BodyMotion<Dim3>& m = world.bodies.motion[std::size_t(shape.body)];
    const SolverBody<Dim3>& s = world.bodies.solver[std::size_t(shape.body)];
    const Dim3::Pose pose = shape_pose(world, shape);
    const ShapeBall<Dim3> ball = ball_about(shape);
    const Vec3d middle = world_point(pose, ball.middle);
    const Vec3f arm = Vec3f(middle - m.center), turn = s.angular_velocity * world.last_dt;
    const float angle = math::length(turn), reach = math::length(arm);
    const Vec3f from(middle - base), along = s.linear_velocity * world.last_dt;
    // What turns far about another point stays in a ball about that.
    if (angle > 1.4f) return BallWay{from - arm, along, pose.rotation, ball.radius + reach, 0, 1e15f};
    return BallWay{from,        along + cross(turn, arm),     pose.rotation,
                   ball.radius, 0.5f * angle * angle * reach, angle * ball.radius};
  };
  return fly_past(a.geometry, b.geometry, way_of(a), way_of(b), 2 * c.margin());
}

/// What flies past meets nothing in this step.
template <class D>
std::uint8_t pass_by(const WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                     const ShapeRecord<D>& b) {
  c.flags = std::uint16_t(c.flags & ~(contact_recycled | contact_known));
  c.gap = 0;
  c.axis = {};
  std::uint8_t change = 0;
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    change = change_apart;
  else if (c.first_manifold != none)
    change = change_empty;
  return std::uint8_t(change | touch_change(c, 1e30f, false));
}

/// What is known of a contact until its manifolds are computed.
template <class D>
struct Looking {
  std::int32_t awake_index = none;
  float reach = 0;  ///< m
  ShapeSweep<D> sweep;
};

/// Looks whether a contact needs new manifolds, of its shapes at `base`. False: `change` tells all.
template <class D>
bool needs_manifolds(WorldImplementation<D>& world, Looking<D>& look, std::uint8_t& change) {
  const std::int32_t awake_index = look.awake_index;
  ContactRecord<D>& c = world.contacts.at(world.contacts.awake[std::size_t(awake_index)]);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  world.scratch.watches[std::size_t(awake_index)].body[0] = none;  // an old one knows nothing of what changes now
  // What is known and stays comes first, as watches ask for nothing else; of what is not known, this saves all the
  // rest.
  const bool known = (c.flags & contact_known) != 0, sensor = (c.flags & contact_sensor) != 0;
  if (!known && !sensor && goes_past(world, c, a, b)) return change = pass_by(world, c, a, b), false;
  typename D::Transform b_in_a;
  if (c.flags & contact_at_origin)
    b_in_a = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    b_in_a = relative(shape_pose(world, a), shape_pose(world, b));
  if (sensor) return change = update_sensor(world, c, a, b, b_in_a), false;

  const float ahead = look_ahead(world, c, look.sweep);
  if (stays(world, c, b_in_a, ahead, look.sweep, change)) return false;
  if (known && goes_past(world, c, a, b)) return change = pass_by(world, c, a, b), false;
  c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
  c.base = b_in_a;
  look.reach = 2 * c.margin() + ahead;
  return true;
}

/// Computes them. As needs_manifolds, writes only to the contact, its manifolds and the worker's list.
template <class D>
std::uint8_t find_manifolds(WorldImplementation<D>& world, Looking<D>& look, std::vector<FoundManifold<D>>& list) {
  ContactRecord<D>& c = world.contacts.at(world.contacts.awake[std::size_t(look.awake_index)]);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if ((c.flags & contact_many) != 0) return update_many(world, c, a, b, look.reach, look.sweep, list);
  typename D::Manifold m;
  geometry::collide(a.geometry, b.geometry, c.base, look.reach, c.cache, m);
  return update_convex(world, c, a, b, look.reach, look.sweep, m, list);
}

/// Pairs of the plane wait, each kind by itself, until there are enough for all lanes.
template <class D>
struct LaneQueues {
  explicit LaneQueues(int) {}
};
template <>
class LaneQueues<Dim2> {
 public:
  explicit LaneQueues(int width) : colliders_(geometry::detail::lane_colliders(width)) {}

  /// False where there are no lanes for it.
  bool take(WorldImplementation<Dim2>& world, const Looking<Dim2>& look, std::vector<FoundManifold<Dim2>>& list) {
    const ContactRecord<Dim2>& c = world.contacts.at(world.contacts.awake[std::size_t(look.awake_index)]);
    const geometry::Shape2& a = world.shapes.at(c.shape[0]).geometry;
    const geometry::Shape2& b = world.shapes.at(c.shape[1]).geometry;
    const geometry::detail::LaneKind kind = geometry::detail::lane_kind(a, b);
    if (kind == geometry::detail::LaneKind::none) return false;
    Queue& queue = queues_[int(kind)];
    const int i = queue.count++;
    queue.pairs.a[i] = &a, queue.pairs.b[i] = &b;
    __builtin_memcpy(queue.pairs.b_in_a[i], &c.base, sizeof queue.pairs.b_in_a[i]);
    queue.pairs.margin[i] = look.reach;
    queue.pairs.kind[i] = c.cache.kind, queue.pairs.edge[i] = c.cache.a;
    queue.look[i] = look;
    if (queue.count == geometry::detail::LanePairs::capacity) run(world, int(kind), list);
    return true;
  }
  void run_all(WorldImplementation<Dim2>& world, std::vector<FoundManifold<Dim2>>& list) {
    for (int kind = 0; kind < geometry::detail::lane_kinds; ++kind)
      if (queues_[kind].count > 0) run(world, kind, list);
  }

 private:
  struct Queue {
    geometry::detail::LanePairs pairs;
    Looking<Dim2> look[geometry::detail::LanePairs::capacity];
    int count = 0;
  };

  void run(WorldImplementation<Dim2>& world, int kind, std::vector<FoundManifold<Dim2>>& list) {
    Queue& queue = queues_[kind];
    const std::uint32_t left_alone = colliders_.of[kind](queue.pairs, queue.count);
    for (int i = 0; i < queue.count; ++i) {
      Looking<Dim2>& look = queue.look[i];
      std::uint8_t& change = world.scratch.contact_changes[std::size_t(look.awake_index)];
      if ((left_alone >> i & 1u) != 0) {
        change = find_manifolds(world, look, list);
        continue;
      }
      ContactRecord<Dim2>& c = world.contacts.at(world.contacts.awake[std::size_t(look.awake_index)]);
      c.cache.kind = std::uint8_t(queue.pairs.kind[i]), c.cache.a = std::uint8_t(queue.pairs.edge[i]);
      change = update_convex(world, c, world.shapes.at(c.shape[0]), world.shapes.at(c.shape[1]), look.reach, look.sweep,
                             queue.pairs.found[i].manifold, list);
    }
    queue.count = 0;
  }

  geometry::detail::LaneColliders colliders_;
  Queue queues_[geometry::detail::lane_kinds];
};

/// Recomputes one contact.
template <class D>
void update_contact(WorldImplementation<D>& world, std::int32_t awake_index, std::vector<FoundManifold<D>>& list) {
  Looking<D> look;
  look.awake_index = awake_index;
  std::uint8_t change = 0;
  if (needs_manifolds(world, look, change)) change = find_manifolds(world, look, list);
  world.scratch.contact_changes[std::size_t(awake_index)] = change;
}

/// Recomputes contacts of the plane, at most as many as there are lanes: how they have moved is found side by side, but
/// for sensors and what has many parts.
inline void update_lanes(WorldImplementation<Dim2>& world, std::span<const std::int32_t> due, PairMotions& pairs,
                         LaneQueues<Dim2>& queues, std::vector<FoundManifold<Dim2>>& list) {
  std::int32_t awake_index[PairMotions::capacity];
  int count = 0;
  for (const std::int32_t i : due) {
    const ContactRecord<Dim2>& c = world.contacts.at(world.contacts.awake[std::size_t(i)]);
    if ((c.flags & (contact_sensor | contact_many)) != 0) {
      update_contact(world, i, list);
      continue;
    }
    awake_index[count] = i;
    pairs.contact[count] = &c;
    for (int side = 0; side < 2; ++side) pairs.local[side][count] = &world.shapes.at(c.shape[side]).local;
    const ShapeRecord<Dim2>& b = world.shapes.at(c.shape[1]);
    const Vec2f middle = ball_about(b).middle;
    pairs.middle[0][count] = middle.x, pairs.middle[1][count] = middle.y;
    pairs.extent[count] = Moved<Dim2>(c, b).extent;
    ++count;
  }
  if (count == 0) return;
  const KnownApart apart = world.kernels.pair_motions(
      pairs, count,
      {world.bodies.pose.data(), world.scratch.sweeps.data(), world.bodies.solver.data(), world.bodies.motion.data()},
      world.last_dt);
  for (int lane = 0; lane < count; ++lane) {
    const std::size_t i = std::size_t(awake_index[lane]);
    ContactRecord<Dim2>& c = world.contacts.at(world.contacts.awake[i]);
    world.scratch.watches[i].body[0] = none;  // as needs_manifolds
    Transform2f now;
    __builtin_memcpy(&now, pairs.b_in_a[lane], sizeof now);
    const Moved<Dim2> moved({pairs.way[0][lane], pairs.way[1][lane]}, pairs.turn[lane], pairs.extent[lane]);
    std::uint8_t& change = world.scratch.contact_changes[i];
    if ((apart.stays >> lane & 1u) != 0) {
      watch_apart(world, c, now, moved);
      continue;
    }
    if ((apart.slides >> lane & 1u) != 0 && slide_on(world, c, moved, now)) continue;
    if (c.first_manifold != none && may_stay(c) && recycle(world, c, moved, now, change)) continue;
    c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
    c.base = now;
    Looking<Dim2> look;
    look.awake_index = awake_index[lane];
    look.reach = 2 * c.margin() + pairs.ahead[lane];
    if (pairs.swept)
      look.sweep = {{{pairs.sweep_way[0][lane], pairs.sweep_way[1][lane]}, pairs.sweep_turn[lane]}, true};
    if (!queues.take(world, look, list)) change = find_manifolds(world, look, list);
  }
}

}  // namespace
}  // namespace carom::rigid::detail
