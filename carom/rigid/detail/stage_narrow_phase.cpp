#include <algorithm>

#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int contact_grain = 128;
constexpr int max_manifolds = 8;          ///< of one pair
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
struct Found {
  typename D::Manifold manifold[max_manifolds];
  std::uint32_t child[max_manifolds];
  int count = 0;
};

/// Segments of a chain are children, like the triangles of a mesh.
void collide_all(const geometry::Shape2& a, const geometry::Shape2& b, const Transform2f& b_in_a, float margin,
                 Found<Dim2>& found) {
  const geometry::Bounds2f box = geometry::grow(geometry::bounds(b, b_in_a), margin);
  struct Candidate {
    float depth;
    int segment;
  } best[max_manifolds];
  geometry::Manifold2 manifolds[max_manifolds];
  int count = 0;
  const geometry::Chain& chain = *a.chain;
  for (int i = 0; i < chain.segment_count(); ++i) {
    const Vec2f p = chain.points[std::size_t(i)];
    const Vec2f q = chain.points[std::size_t(i) + 1 < chain.points.size() ? std::size_t(i) + 1 : 0];
    if (!overlaps(geometry::Bounds2f{min(p, q), max(p, q)}, box)) continue;
    geometry::PairCache cache;
    geometry::Manifold2 m;
    geometry::collide(geometry::Shape2(chain.segment(i)), b, b_in_a, margin, cache, m);
    if (m.count == 0) continue;
    float depth = m.points[0].separation;
    for (int k = 1; k < m.count; ++k) depth = min(depth, m.points[k].separation);
    int place = count < max_manifolds ? count++ : max_manifolds;
    while (place > 0 && depth < best[place - 1].depth) {
      if (place < max_manifolds) {
        best[place] = best[place - 1];
        manifolds[place] = manifolds[place - 1];
      }
      --place;
    }
    if (place < max_manifolds) {
      best[place] = {depth, i};
      manifolds[place] = m;
    }
  }
  for (int i = 0; i < count; ++i) {
    found.manifold[i] = manifolds[i];
    found.child[i] = std::uint32_t(best[i].segment);
  }
  found.count = count;
}
void collide_all(const geometry::Shape3& a, const geometry::Shape3& b, const Transform3f& b_in_a, float margin,
                 Found<Dim3>& found) {
  found.count = geometry::collide_many(a, b, b_in_a, margin, found.manifold);
  for (int i = 0; i < found.count; ++i) found.child[i] = found.manifold[i].child;
}

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
  const float turning = spin(a) * world.bodies.motion[std::size_t(c.body[0])].outer_extent +
                        spin(b) * world.bodies.motion[std::size_t(c.body[1])].outer_extent;
  const float way = world.last_dt * (math::length(b.linear_velocity - a.linear_velocity) + min(turning, 100.0f));
  return (c.flags & contact_bouncy) != 0 ? way : min(way, 0.5f * c.inner);
}
/// How far a contact with this normal (in the frame of A's shape) closes in the step by the motion of the centres.
template <class D>
float closing_way(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Vector& normal) {
  const SolverBody<D>&a = world.bodies.solver[std::size_t(c.body[0])], &b = world.bodies.solver[std::size_t(c.body[1])];
  typename D::Vector n = rotate(world.shapes.at(c.shape[0]).local.q, normal);
  n = rotate(world.bodies.pose[std::size_t(c.body[0])].rotation, n);
  const float turning = spin(a) * world.bodies.motion[std::size_t(c.body[0])].outer_extent +
                        spin(b) * world.bodies.motion[std::size_t(c.body[1])].outer_extent;
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
        if (motion(c.base, b_in_a, c.extent) + margin < c.gap) return 0;
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
  world.scheduler->parallel_for(int(count), contact_grain, [&](int begin, int end, int worker) {
    for (int i = begin; i < end; ++i) {
      if (i + 4 < end) __builtin_prefetch(&world.contacts.at(world.contacts.awake[std::size_t(i) + 4]));
      scratch.contact_changes[std::size_t(i)] = update_contact(world, i, scratch.found_manifolds[std::size_t(worker)]);
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
