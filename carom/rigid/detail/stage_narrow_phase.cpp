#include <algorithm>

#include "carom/rigid/detail/found_contacts.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int contact_grain = 128;
constexpr float touch_distance = 0.005f;  ///< m: surfaces nearer than this touch, for events
constexpr float recycle_share = 0.02f;    ///< of the smaller half thickness: manifolds stay while the pair slid less

enum ContactChange : std::uint8_t {
  change_apart = 1,      ///< fat bounds no longer overlap
  change_manifolds = 2,  ///< new manifolds wait in the found list; the old ones go
  change_empty = 4,      ///< manifolds go, none come
  change_begin = 8,
  change_end = 16,
};

template <class D>
float smallest_separation(const typename D::Manifold& m) {
  float s = m.points[0].separation;
  for (int i = 1; i < m.count; ++i) s = min(s, m.points[i].separation);
  return s;
}

/// An upper bound of how far any point of B moved, seen from A, from `base` to `now`.
float motion(const Transform2f& base, const Transform2f& now, float extent) {
  // |sin| and |1 − cos| of the turn between them bound its chord.
  const float s = base.q.c * now.q.s - base.q.s * now.q.c, c = base.q.c * now.q.c + base.q.s * now.q.s;
  const Vec2f chord{1 - c, s};
  return math::length(now.p - base.p) + math::length(chord) * extent;
}
float motion(const Transform3f& base, const Transform3f& now, float extent) {
  const Quatf turn = conjugate(base.q) * now.q;
  return math::length(now.p - base.p) + 2 * math::length(turn.vector()) * extent;
}

/// The same without what is along the normal: approach and parting change separations only.
template <class T, class V>
float slid(const T& base, const T& now, float extent, const V& normal) {
  T straight = now;
  straight.p = now.p - normal * dot(normal, now.p - base.p);
  return motion(base, straight, extent);
}

float spin(const SolverBody<Dim2>& s) { return math::abs(s.angular_velocity); }
float spin(const SolverBody<Dim3>& s) { return math::length(s.angular_velocity); }

/// How far the surfaces of the pair may come nearer in this step. Contacts are foreseen that far, so that impacts
/// happen at the surface, with the energy a body has there; those that do not bounce look no farther than half their
/// thickness.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const SolverBody<D>&a = world.bodies.solver[std::size_t(c.body[0])], &b = world.bodies.solver[std::size_t(c.body[1])];
  const float turning =
      world.scratch.paths[std::size_t(c.body[0])].turning + world.scratch.paths[std::size_t(c.body[1])].turning;
  const float way = world.last_dt * (math::length(b.linear_velocity - a.linear_velocity) + min(turning, 100.0f));
  return (c.flags & contact_bouncy) != 0 ? way : min(way, 0.5f * c.inner);
}
/// How far a contact with this normal (in the frame of A's shape) closes in the step by the motion of the centres.
template <class D>
float closing_way(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Vector& normal) {
  const SolverBody<D>&a = world.bodies.solver[std::size_t(c.body[0])], &b = world.bodies.solver[std::size_t(c.body[1])];
  typename D::Vector n = rotate(world.shapes.at(c.shape[0]).local.q, normal);
  n = rotate(world.bodies.pose[std::size_t(c.body[0])].rotation, n);
  const float turning =
      world.scratch.paths[std::size_t(c.body[0])].turning + world.scratch.paths[std::size_t(c.body[1])].turning;
  return world.last_dt * max(0.0f, dot(n, a.linear_velocity - b.linear_velocity) + min(turning, 100.0f));
}

/// The touch flag, with hysteresis: begins within the touch distance, ends when the manifolds are gone or beyond twice
/// it.
template <class D>
std::uint8_t touch_change(ContactRecord<D>& c, float separation, bool pressed) {
  const bool was = (c.flags & contact_touching) != 0;
  const bool is = separation < (was ? 2 * touch_distance : touch_distance) || pressed;
  if (is == was) return 0;
  c.flags ^= contact_touching;
  return is ? change_begin : change_end;
}

template <class D>
bool pressed(const ManifoldRecord<D>& m) {
  for (int i = 0; i < D::max_points; ++i)
    if (m.impulses.normal[i] > 0) return true;
  return false;
}

template <class D>
bool pressed_any(const ContactStore<D>& store, const ContactRecord<D>& c) {
  for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next)
    if (pressed(store.manifold(m))) return true;
  return false;
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

/// B in A is now at `x`, `moved` m by `motion` from the place where the gap was measured.
template <class D>
void watch_contact(WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Transform& x,
                   float moved) {
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  const float apart = math::length(x.p), slack = c.gap - c.margin - moved;
  // Seen from A, the origin of B moves by what both origins do, and by A's turn at its distance.
  const float lever[2] = {apart + c.extent + math::length(a.local.p), c.extent + math::length(b.local.p)};
  ContactWatch& w = world.scratch.watches[std::size_t(c.awake_index)];
  w.limit = -1;
  for (int side = 0; side < 2; ++side)
    if (lever[side] > path_lever * world.bodies.motion[std::size_t(c.body[side])].outer_extent &&
        !world.bodies.is_fixed(c.body[side]))
      return;
  w.body[0] = c.body[0], w.body[1] = c.body[1];
  w.cap = (c.flags & contact_bouncy) != 0 ? 3.4e38f : 0.5f * c.inner;
  w.limit = world.scratch.paths[std::size_t(c.body[0])].way + world.scratch.paths[std::size_t(c.body[1])].way +
            double(min(slack, most_slack)) - double(1e-4f + 1e-6f * apart);
}

/// Follows the bodies' ways. Fixed ones have none: set_pose forgets all watches.
template <class D>
void follow_paths(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.watches.size() != world.contacts.awake.size()) scratch.watches.assign(world.contacts.awake.size(), {});
  if (world.contacts.awake.empty()) return;
  scratch.paths.resize(world.bodies.pose.size());
  scratch.path_ends.resize(world.bodies.pose.size());
  for (const std::int32_t body : scratch.followed)
    scratch.paths[std::size_t(body)].reach = scratch.paths[std::size_t(body)].turning = 0;
  scratch.followed.assign(world.bodies.awake.begin(), world.bodies.awake.end());
  world.scheduler->parallel_for(int(world.bodies.awake.size()), 512, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const std::size_t body = std::size_t(world.bodies.awake[std::size_t(i)]);
      BodyPath& path = scratch.paths[body];
      PathEnd<D>& last = scratch.path_ends[body];
      const typename D::Pose& pose = world.bodies.pose[body];
      const SolverBody<D>& s = world.bodies.solver[body];
      const float outer = world.bodies.motion[body].outer_extent;
      if (last.known)
        path.way += double(math::length(typename D::Vector(pose.position - last.pose.position)) +
                           path_lever * outer * chord(last.pose.rotation, pose.rotation));
      if (outer < last.outer_extent) path.way += 2 * double(most_slack);  // turns counted for more until now
      last = {pose, outer, true};
      path.turning = spin(s) * outer;
      path.reach = 1.0001f * world.last_dt * (math::length(s.linear_velocity) + min(path.turning, 100.0f));
    }
  });
}

/// Recomputes one contact. Writes only to the contact, its manifolds and the worker's list.
template <class D>
std::uint8_t update_contact(WorldImplementation<D>& world, std::int32_t awake_index,
                            std::vector<FoundManifold<D>>& list) {
  ContactStore<D>& store = world.contacts;
  ContactRecord<D>& c = store.at(store.awake[std::size_t(awake_index)]);
  typename D::Transform b_in_a;
  if (c.flags & contact_at_origin)
    b_in_a = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    b_in_a = relative(shape_pose(world, world.shapes.at(c.shape[0])), shape_pose(world, world.shapes.at(c.shape[1])));

  const bool many = (c.flags & contact_many) != 0;
  float reach = 0, ahead = 0;
  if ((c.flags & contact_sensor) == 0) {
    ahead = look_ahead(world, c);
    const float margin = c.margin + ahead;
    // Contact recycling, after Box2D 3.1 and Box3D: while a pair hardly moves, its manifolds are kept and only their
    // separations follow. What moves along the normal changes nothing else; the bound is on sliding and turning, and
    // far below the size of features, so that nothing sticks to a stale edge.
    if (c.flags & contact_known) {
      if (c.first_manifold == none) {
        const float moved = motion(c.base, b_in_a, c.extent);
        if (moved + margin < c.gap) {
          watch_contact(world, c, b_in_a, moved);
          return 0;
        }
      } else if ((c.flags & contact_round) == 0) {
        const typename D::Vector normal = store.manifold(c.first_manifold).manifold.normal;
        const float separation = c.gap + dot(normal, b_in_a.p - c.base.p);
        if (separation < c.margin && slid(c.base, b_in_a, c.extent, normal) < recycle_share * c.inner) {
          c.flags |= contact_recycled;
          return touch_change(c, separation, pressed_any(store, c));
        }
      }
    }
    reach = 2 * c.margin + ahead;
  }
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if (c.flags & contact_sensor) return update_sensor(world, c, a, b, b_in_a);

  world.scratch.watches[std::size_t(awake_index)].limit = -1;
  c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
  c.base = b_in_a;
  Found<D> found;
  if (many) {
    collide_all(a.geometry, b.geometry, b_in_a, reach, found);
  } else {
    geometry::collide(a.geometry, b.geometry, b_in_a, reach, c.cache, found.manifold[0]);
    found.child[0] = 0;
    found.count = found.manifold[0].count > 0 ? 1 : 0;
  }
  float separation = reach;
  if (found.count == 0) {
    // Pairs are to be looked at before they leave each other's bounds for good; of a large surface nobody does.
    if (!many) found.apart = min(found.manifold[0].points[0].separation, reach + 0.25f * c.inner);
    separation = max(reach, found.apart);
  }
  int kept = 0;
  for (int i = 0; i < found.count; ++i) {
    const float s = smallest_separation<D>(found.manifold[i]);
    separation = min(separation, s);
    if (s > c.margin && s > c.margin + min(ahead, closing_way(world, c, found.manifold[i].normal))) continue;
    if (kept != i) {
      found.manifold[kept] = found.manifold[i];
      found.child[kept] = found.child[i];
    }
    ++kept;
  }
  found.count = kept;
  c.gap = separation;

  std::uint8_t change = 0;
  if (found.count == 0) {
    if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
      change = change_apart;
    else if (c.first_manifold != none)
      change = change_empty;
    else
      watch_contact(world, c, b_in_a, 0.0f);
    return std::uint8_t(change | touch_change(c, separation, false));
  }
  int matched = 0;
  for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
    for (int i = 0; i < found.count; ++i)
      if (found.child[i] == store.manifold(m).child) {
        ++matched;
        break;
      }
  }
  change = touch_change(c, separation, pressed_any(store, c));
  if (matched == found.count && matched == c.manifold_count) {
    for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
      ManifoldRecord<D>& record = store.manifold(m);
      for (int i = 0; i < found.count; ++i)
        if (found.child[i] == record.child) {
          carry_impulses<D>(record.manifold, found.manifold[i], 0.2f * c.inner, record.impulses);
          record.manifold = found.manifold[i];
          break;
        }
    }
    return change;
  }
  for (int i = 0; i < found.count; ++i) list.push_back({awake_index, i, found.child[i], found.manifold[i]});
  return std::uint8_t(change | change_manifolds);
}

/// Replaces the manifolds of a contact by those found; children that stay keep their impulses and place.
template <class D>
void replace_manifolds(WorldImplementation<D>& world, std::int32_t contact, std::span<const FoundManifold<D>> found) {
  ContactStore<D>& store = world.contacts;
  for (std::int32_t m = store.at(contact).first_manifold; m != none;) {
    const std::int32_t next = store.manifold(m).next;
    bool stays = false;
    for (const FoundManifold<D>& f : found) stays = stays || f.child == store.manifold(m).child;
    if (!stays) remove_manifold(world, m);
    m = next;
  }
  for (const FoundManifold<D>& f : found) {
    std::int32_t m = store.at(contact).first_manifold;
    while (m != none && store.manifold(m).child != f.child) m = store.manifold(m).next;
    if (m == none) {
      add_manifold(world, contact, f.manifold, f.child);
    } else {
      ManifoldRecord<D>& record = store.manifold(m);
      carry_impulses<D>(record.manifold, f.manifold, 0.2f * store.at(contact).inner, record.impulses);
      record.manifold = f.manifold;
    }
  }
}

template <class D>
void send_touch_event(WorldImplementation<D>& world, const ContactRecord<D>& c, bool begin) {
  const ShapeId a = world.shapes.slots.handle_at(c.shape[0]), b = world.shapes.slots.handle_at(c.shape[1]);
  StepScratch<D>& scratch = world.scratch;
  if (c.flags & contact_sensor) {
    const bool first = (world.shapes.at(c.shape[0]).flags & shape_sensor) != 0;
    (begin ? scratch.sensor_begin : scratch.sensor_end).push_back(first ? SensorEvent{a, b} : SensorEvent{b, a});
  } else if (c.flags & contact_events) {
    if (begin)
      scratch.contact_begin.push_back({a, b});
    else
      scratch.contact_end.push_back({a, b});
  }
}

template <class D>
void apply_change(WorldImplementation<D>& world, std::size_t i, std::size_t& next_found) {
  StepScratch<D>& scratch = world.scratch;
  const std::uint8_t change = scratch.contact_changes[i];
  const std::int32_t contact = world.contacts.awake[i];
  if (change & change_begin) {
    send_touch_event(world, world.contacts.at(contact), true);
    scratch.new_touches.push_back(contact);  // who fell asleep close by, but apart, has a manifold already
  }
  if (change & change_end) send_touch_event(world, world.contacts.at(contact), false);
  if (change & change_apart) {
    scratch.doomed_contacts.push_back(contact);
  } else if (change & change_empty) {
    replace_manifolds<D>(world, contact, {});
  } else if (change & change_manifolds) {
    const std::size_t first = next_found;
    while (next_found < scratch.manifolds.size() && scratch.manifolds[next_found].awake_index == std::int32_t(i))
      ++next_found;
    const bool was_empty = world.contacts.at(contact).first_manifold == none;
    replace_manifolds<D>(world, contact, std::span(scratch.manifolds).subspan(first, next_found - first));
    if (was_empty) scratch.new_touches.push_back(contact);
  }
}

}  // namespace

template <class D>
void update_contacts(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  const std::size_t count = world.contacts.awake.size();
  scratch.contact_changes.resize((count + 7) / 8 * 8);
  std::fill(scratch.contact_changes.begin(), scratch.contact_changes.end(), std::uint8_t(0));
  for (std::vector<FoundManifold<D>>& list : scratch.found_manifolds) list.clear();
  follow_paths(world);
  world.scheduler->parallel_for(int(count), contact_grain, [&](int begin, int end, int worker) {
    std::int32_t due[contact_grain];
    while (begin < end) {
      const int stop = min(begin + contact_grain, end);
      int number = 0;
      for (; begin < stop; ++begin)
        if (!still_apart(scratch.paths, scratch.watches[std::size_t(begin)])) due[number++] = begin;
      for (int k = 0; k < number; ++k) {
        if (k + 6 < number) __builtin_prefetch(&world.contacts.at(world.contacts.awake[std::size_t(due[k + 6])]));
        if (k + 3 < number) {
          const ContactRecord<D>& soon = world.contacts.at(world.contacts.awake[std::size_t(due[k + 3])]);
          for (const std::int32_t body : soon.body) {
            __builtin_prefetch(&world.bodies.pose[std::size_t(body)]);
            __builtin_prefetch(&world.bodies.solver[std::size_t(body)]);
          }
        }
        scratch.contact_changes[std::size_t(due[k])] =
            update_contact(world, due[k], scratch.found_manifolds[std::size_t(worker)]);
      }
    }
  });
  level_room(scratch.found_manifolds);
  scratch.manifolds.clear();
  for (const std::vector<FoundManifold<D>>& list : scratch.found_manifolds)
    scratch.manifolds.insert(scratch.manifolds.end(), list.begin(), list.end());
  // Workers take chunks as they come.
  if (scratch.found_manifolds.size() > 1)
    std::sort(scratch.manifolds.begin(), scratch.manifolds.end(), [](const auto& l, const auto& r) {
      return l.awake_index != r.awake_index ? l.awake_index < r.awake_index : l.ordinal < r.ordinal;
    });

  scratch.doomed_contacts.clear();
  scratch.new_touches.clear();
  std::size_t next_found = 0;
  for (std::size_t block = 0; block < count; block += 8) {
    std::uint64_t any;
    __builtin_memcpy(&any, &scratch.contact_changes[block], 8);
    if (any == 0) continue;
    for (std::size_t i = block; i < min(block + 8, count); ++i)
      if (scratch.contact_changes[i] != 0) apply_change(world, i, next_found);
  }
  for (const std::int32_t contact : scratch.doomed_contacts) destroy_contact(world, contact, false);
  // A new contact wakes whoever slept.
  for (const std::int32_t contact : scratch.new_touches) {
    const ContactRecord<D>& c = world.contacts.at(contact);
    if (c.first_manifold == none) continue;
    const std::int32_t a = c.body[0], b = c.body[1];
    for (const std::int32_t body : {a, b})
      if (world.bodies.record[std::size_t(body)].awake_index == none && !world.bodies.is_fixed(body))
        wake_body(world, body);
  }
}

template void update_contacts<Dim2>(WorldImplementation<Dim2>&);
template void update_contacts<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
