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
bool of_interest(const WorldImplementation<D>& world, const ContactRecord<D>& c, const BodySweep<D>& sweep,
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

/// What is known of a contact until its manifolds are computed.
template <class D>
struct Looking {
  std::int32_t awake_index = none;
  float reach = 0;       ///< m
  bool known = false;    ///< the manifolds that it has are of the step before
  BodySweep<D> sweep{};  ///< of B's shape, where bodies turn far
};

/// Two convex shapes, or a plane: one manifold at most, which was found within `reach` (m).
template <class D>
std::uint8_t update_convex(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, float reach, const BodySweep<D>& sweep,
                           const typename D::Manifold& m, std::vector<FoundManifold<D>>& list) {
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
                         const ShapeRecord<D>& b, const Looking<D>& look, std::vector<FoundManifold<D>>& list) {
  ContactStore<D>& store = world.contacts;
  const float reach = look.reach;
  Found<D> found;
  if constexpr (D::dimension == 3)
    collide_all(a.geometry, b.geometry, c.base, reach, approach_of(world, c, reach, look.known), c.cache, found);
  else
    collide_all(a.geometry, b.geometry, store, c, look.known, reach, found);
  c.gap = found.count == 0 ? found.apart : reach;
  c.axis = {};
  int kept = 0;
  for (int i = 0; i < found.count; ++i) {
    const float s = smallest_separation(found.manifold[i]);
    c.gap = min(c.gap, s);
    if (!of_interest(world, c, look.sweep, found.manifold[i], s)) continue;
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

/// Computes manifolds, of the shapes at `base`. Writes only to the contact, its manifolds and the worker's list.
template <class D>
std::uint8_t find_manifolds(WorldImplementation<D>& world, Looking<D>& look, std::vector<FoundManifold<D>>& list) {
  ContactRecord<D>& c = world.contacts.at(world.contacts.awake[std::size_t(look.awake_index)]);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if ((c.flags & contact_many) != 0) return update_many(world, c, a, b, look, list);
  typename D::Manifold m;
  geometry::collide(a.geometry, b.geometry, c.base, look.reach, c.cache, m);
  return update_convex(world, c, a, b, look.reach, look.sweep, m, list);
}

/// Pairs of the plane wait, each kind by itself, until there are enough for all lanes.
template <class D>
struct LaneQueues {
  explicit LaneQueues(int) {}
  bool take(WorldImplementation<D>&, const Looking<D>&, std::vector<FoundManifold<D>>&) { return false; }
  void run_all(WorldImplementation<D>&, std::vector<FoundManifold<D>>&) {}
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

/// What lanes are to know of B's shape.
inline void tell_shape(PairMotions<Dim2>& pairs, int lane, const ContactRecord<Dim2>& c, const ShapeRecord<Dim2>& b) {
  const Vec2f middle = ball_about(b).middle;
  pairs.middle[0][lane] = middle.x, pairs.middle[1][lane] = middle.y;
  pairs.extent[lane] = extent_of(c, b);
}
inline void tell_shape(PairMotions<Dim3>& pairs, int lane, const ContactRecord<Dim3>& c, const ShapeRecord<Dim3>& b) {
  const bool is_hull = b.geometry.type == geometry::ShapeType3::hull;
  const bool is_long = is_hull && c.extent >= 2 * b.inner_extent;
  constexpr float no_box = PairMotions<Dim3>::no_box;
  const Vec3f middle = is_hull ? b.geometry.hull->bounds.center() : Vec3f{};
  const Vec3f box = is_long ? b.geometry.hull->bounds.extents() : Vec3f{no_box, no_box, no_box};
  for (int k = 0; k < 3; ++k) pairs.middle[k][lane] = middle[k], pairs.box[k][lane] = box[k];
  pairs.rounding[lane] = is_long ? b.geometry.hull->radius : 0;
}

/// What is looked at of a sensor's pair, and of one that flies past. False: it is any other.
template <class D>
bool update_alone(WorldImplementation<D>& world, ContactRecord<D>& c, std::uint8_t& change) {
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if ((c.flags & contact_sensor) != 0)
    return change = update_sensor(world, c, a, b, relative(shape_pose(world, a), shape_pose(world, b))), true;
  // Of what is not known this saves all the rest.
  if ((c.flags & contact_known) == 0 && goes_past(world, c, a, b)) return change = pass_by(world, c, a, b), true;
  return false;
}

/// Recomputes contacts: how they have moved is found side by side, as many at a time as there are lanes.
template <class D>
class PairUpdates {
 public:
  PairUpdates(WorldImplementation<D>& world, std::vector<FoundManifold<D>>& list)
      : world_(world), list_(list), queues_(world.kernels.pairs.width) {}

  void add(std::int32_t awake_index) {
    ContactRecord<D>& c = contact(awake_index);
    world_.scratch.watches[std::size_t(awake_index)].body[0] = none;  // an old one knows nothing of what changes now
    if (update_alone(world_, c, world_.scratch.contact_changes[std::size_t(awake_index)])) return;
    awake_index_[count_] = awake_index;
    pairs_.contact[count_] = &c;
    for (int side = 0; side < 2; ++side) pairs_.local[side][count_] = &world_.shapes.at(c.shape[side]).local;
    tell_shape(pairs_, count_, c, world_.shapes.at(c.shape[1]));
    if (++count_ == world_.kernels.pairs.width) run();
  }
  void finish() {
    if (count_ > 0) run();
    queues_.run_all(world_, list_);
  }

 private:
  ContactRecord<D>& contact(std::int32_t awake_index) const {
    return world_.contacts.at(world_.contacts.awake[std::size_t(awake_index)]);
  }
  void run() {
    const KnownApart apart =
        world_.kernels.pairs.pair_motions(pairs_, count_,
                                          {world_.bodies.pose.data(), world_.scratch.sweeps.data(),
                                           world_.bodies.solver.data(), world_.bodies.motion.data()},
                                          world_.last_dt);
    for (int lane = 0; lane < count_; ++lane) update(lane, apart);
    count_ = 0;
  }
  void update(int lane, const KnownApart& apart) {
    ContactRecord<D>& c = contact(awake_index_[lane]);
    typename D::Transform now;
    __builtin_memcpy(&now, pairs_.b_in_a[lane], sizeof now);
    Moved<D> moved{.turn = pairs_.turn[lane], .extent = pairs_.extent[lane]};
    for (int k = 0; k < D::dimension; ++k) moved.way[k] = pairs_.way[k][lane];
    std::uint8_t& change = world_.scratch.contact_changes[std::size_t(awake_index_[lane])];
    if ((apart.stays >> lane & 1u) != 0) return watch_apart(world_, c, now, moved);
    if ((apart.slides >> lane & 1u) != 0 && slide_on(world_, c, moved, now)) return;
    if (may_recycle(c) && recycle(world_, c, moved, now, change)) return;
    const ShapeRecord<D>&a = world_.shapes.at(c.shape[0]), &b = world_.shapes.at(c.shape[1]);
    if ((c.flags & contact_known) != 0 && goes_past(world_, c, a, b)) {
      change = pass_by(world_, c, a, b);
      return;
    }
    Looking<D> look{.awake_index = awake_index_[lane],
                    .reach = 2 * c.margin() + pairs_.ahead[lane],
                    .known = (c.flags & contact_known) != 0};
    c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
    c.base = now;
    for (int k = 0; k < D::dimension; ++k) look.sweep.way[k] = pairs_.sweep_way[k][lane];
    look.sweep.turning = pairs_.sweep_turn[lane];
    if (!queues_.take(world_, look, list_)) change = find_manifolds(world_, look, list_);
  }

  WorldImplementation<D>& world_;
  std::vector<FoundManifold<D>>& list_;
  LaneQueues<D> queues_;
  PairMotions<D> pairs_{};
  std::int32_t awake_index_[PairMotions<D>::capacity];
  int count_ = 0;
};

}  // namespace
}  // namespace carom::rigid::detail
