#include <algorithm>
#include <bit>

#include "carom/rigid/detail/coarse.h"
#include "carom/rigid/detail/fly_past.h"
#include "carom/rigid/detail/found_contacts.h"
#include "carom/rigid/detail/shape_manifolds.h"
#include "carom/rigid/detail/stages.h"
// Parts of this file:
#include "carom/rigid/detail/pair_motion.inl"
#include "carom/rigid/detail/pair_watch.inl"

namespace carom::rigid::detail {
namespace {

constexpr int contact_grain = 128;

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

/// Two convex shapes, or a plane: one manifold at most.
template <class D>
std::uint8_t update_convex(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, float reach, ShapeSweep<D>& sweep,
                           std::vector<FoundManifold<D>>& list) {
  typename D::Manifold m;
  geometry::collide(a.geometry, b.geometry, c.base, reach, c.cache, m);
  c.gap = reach;
  c.axis = {};
  if (m.count == 0) {
    // Pairs are to be looked at before they leave each other's bounds for good.
    c.gap = max(reach, min(m.points[0].separation, reach + 0.25f * c.inner));
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
    watch_recycled(world, c, longest_way(world, c), c.gap, m.normal, c.extent);
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

/// Contacts of one kind take the same ways through the code.
template <class D>
constexpr int contact_kinds = D::dimension == 2 ? 16 : 2;
template <class D>
int kind_of(const ContactRecord<D>& c) {
  const int touched = c.first_manifold != none ? 1 : 0;
  if constexpr (D::dimension == 3)
    return touched;
  else
    return c.small * 4 + ((c.flags & contact_round) != 0 ? 2 : 0) + touched;
}
/// Puts those of a kind side by side, which the processor foresees better.
template <class D>
void sort_by_kind(std::int32_t* due, int number, const ContactRecord<D>* contacts, const std::int32_t* awake) {
  std::int32_t sorted[contact_grain];
  std::uint8_t kind[contact_grain];
  int ends[contact_kinds<D>] = {};
  for (int k = 0; k < number; ++k) ++ends[kind[k] = std::uint8_t(kind_of(contacts[awake[due[k]]]))];
  for (int i = 1; i < contact_kinds<D>; ++i) ends[i] += ends[i - 1];
  for (int k = number; k-- > 0;) sorted[--ends[kind[k]]] = due[k];
  std::copy(sorted, sorted + number, due);
}

/// Recomputes one contact. Writes only to the contact, its manifolds and the worker's list.
template <class D>
std::uint8_t update_contact(WorldImplementation<D>& world, std::int32_t awake_index,
                            std::vector<FoundManifold<D>>& list) {
  ContactRecord<D>& c = world.contacts.at(world.contacts.awake[std::size_t(awake_index)]);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  world.scratch.watches[std::size_t(awake_index)].body[0] = none;  // an old one knows nothing of what changes now
  // What is known and stays comes first, as watches ask for nothing else; of what is not known, this saves all the
  // rest.
  const bool known = (c.flags & contact_known) != 0, sensor = (c.flags & contact_sensor) != 0;
  if (!known && !sensor && goes_past(world, c, a, b)) return pass_by(world, c, a, b);
  typename D::Transform b_in_a;
  if (c.flags & contact_at_origin)
    b_in_a = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    b_in_a = relative(shape_pose(world, a), shape_pose(world, b));
  if (sensor) return update_sensor(world, c, a, b, b_in_a);

  ShapeSweep<D> sweep;
  // What has a manifold in the plane is told that more may be near than the sweep of its shape would say: it is asked
  // how near its points are anyway.
  const bool touched = D::dimension == 2 && c.first_manifold != none && (c.flags & contact_many) == 0;
  const float ahead = touched ? way_of_bodies(world, c) : look_ahead(world, c, sweep), reach = 2 * c.margin() + ahead;
  std::uint8_t change = 0;
  if (stays(world, c, b_in_a, ahead, sweep, change)) return change;
  if (known && goes_past(world, c, a, b)) return pass_by(world, c, a, b);
  c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
  c.base = b_in_a;
  return (c.flags & contact_many) != 0 ? update_many(world, c, a, b, reach, sweep, list)
                                       : update_convex(world, c, a, b, reach, sweep, list);
}

/// Replaces the manifolds of a contact by those found; children that stay keep their impulses and place.
template <class D>
void replace_manifolds(WorldImplementation<D>& world, std::int32_t contact, std::span<const FoundManifold<D>> found) {
  ContactStore<D>& store = world.contacts;
  for (std::int32_t m = store.at(contact).first_manifold; m != none;) {
    const std::int32_t next = store.manifold(m).next;
    bool stays = false;
    for (const FoundManifold<D>& f : found) stays = stays || same_patch(store.manifold(m), f.child, f.manifold);
    if (!stays) remove_manifold(world, m);
    m = next;
  }
  for (const FoundManifold<D>& f : found) {
    std::int32_t m = store.at(contact).first_manifold;
    while (m != none && !same_patch(store.manifold(m), f.child, f.manifold)) m = store.manifold(m).next;
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
    if (begin) {
      std::uint32_t part = 0;
      float deepest = 1e30f;
      for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
        const typename D::Manifold& manifold = world.contacts.manifold(m).manifold;
        const float depth = smallest_separation(manifold);
        if (depth < deepest) deepest = depth, part = manifold.material;
      }
      scratch.contact_begin.push_back(
          {a, b, material_at(world, c.shape[0], part).user_id, material_at(world, c.shape[1], part).user_id});
    } else {
      scratch.contact_end.push_back({a, b});
    }
  }
}

template <class D>
void apply_change(WorldImplementation<D>& world, std::size_t i, std::size_t& next_found) {
  StepScratch<D>& scratch = world.scratch;
  const std::uint8_t change = scratch.contact_changes[i];
  const std::int32_t contact = world.contacts.awake[i];
  if (change & change_begin) {
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
  if (change & change_begin) send_touch_event(world, world.contacts.at(contact), true);
}

/// Calls for the memory that apply_change will need for eight contacts. Inlined always, as prefetch_lines.
template <class D>
[[gnu::always_inline]] inline void call_for_changes(const WorldImplementation<D>& world, std::size_t block) {
  std::uint64_t any;
  __builtin_memcpy(&any, &world.scratch.contact_changes[block], 8);
  if (any == 0) return;
  for (std::size_t i = block; i < min(block + 8, world.contacts.awake.size()); ++i) {
    if (world.scratch.contact_changes[i] == 0) continue;
    prefetch_lines(&world.contacts.at(world.contacts.awake[i]), sizeof(ContactRecord<D>));
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
  measure_sweeps(world);
  world.scheduler->parallel_for(int(count), contact_grain, [&](int begin, int end, int worker) {
    std::int32_t due[contact_grain];
    const int width = world.kernels.width;
    // Found once: to the compiler, whatever is written might move them.
    const ContactWatch<D>* const watches = scratch.watches.data();
    const typename D::Pose* const poses = world.bodies.pose.data();
    const BodySweep<D>* const sweeps = scratch.sweeps.data();
    const std::int32_t* const awake = world.contacts.awake.data();
    const ContactRecord<D>* const contacts = world.contacts.contacts.data();
    const ShapeRecord<D>* const shapes = world.shapes.record.data();
    const ManifoldRecord<D>* const manifolds = world.contacts.manifolds.data();
    while (begin < end) {
      const int stop = min(begin + contact_grain, end);
      int number = 0;
      for (; begin < stop; begin += width) {
        const int lanes = min(width, stop - begin);
        for (int soon = begin + width; soon < min(begin + 2 * width, stop); ++soon) {
          const ContactWatch<D>& watch = watches[soon];
          __builtin_prefetch(&watch + 4 * width);
          if (watch.body[0] == none) continue;
          for (const std::int32_t body : watch.body) {
            __builtin_prefetch(poses + body);
            __builtin_prefetch(sweeps + body);
          }
        }
        const std::uint32_t old =
            world.kernels.nothing_new(watches + begin, lanes, poses, sweeps, world.last_dt);  // bits by lane
        for (std::uint32_t news = ~old & ((1u << lanes) - 1); news != 0; news &= news - 1) {
          const int i = begin + std::countr_zero(news);
          prefetch_lines(contacts + awake[i], sizeof(ContactRecord<D>));
          due[number++] = i;
        }
      }
      if (D::dimension == 2) sort_by_kind(due, number, contacts, awake);
      const auto look_at_soon = [&](int k) __attribute__((always_inline)) {  // as prefetch_lines
        const ContactRecord<D>& soon = contacts[awake[due[k]]];
        for (const std::int32_t body : soon.body) {
          __builtin_prefetch(poses + body);
          __builtin_prefetch(sweeps + body);
        }
        prefetch_shapes(shapes, soon);
        if (soon.first_manifold != none) prefetch_lines(manifolds + soon.first_manifold, ManifoldRecord<D>::hot_bytes);
      };
      // Those that are apart may have left each other's bounds.
      const auto bounds_soon = [&](int k) __attribute__((always_inline)) {
        const ContactRecord<D>& soon = contacts[awake[due[k]]];
        if (soon.first_manifold != none) return;
        for (const std::int32_t s : soon.shape)
          __builtin_prefetch(&world.shapes.trees[shapes[s].tree].bounds(shapes[s].leaf));
      };
      for (int k = 0; k < min(6, number); ++k) look_at_soon(k);
      for (int k = 0; k < number; ++k) {
        if (k + 6 < number) look_at_soon(k + 6);
        if (D::dimension == 2 && k + 2 < number) bounds_soon(k + 2);
        scratch.contact_changes[std::size_t(due[k])] =
            update_contact(world, due[k], scratch.found_manifolds[std::size_t(worker)]);
      }
    }
  });
  level_room(scratch.found_manifolds);
  scratch.manifolds.clear();
  for (const std::vector<FoundManifold<D>>& list : scratch.found_manifolds)
    scratch.manifolds.insert(scratch.manifolds.end(), list.begin(), list.end());
  // Workers take chunks as they come, and those of a kind together.
  if (D::dimension == 2 || scratch.found_manifolds.size() > 1)
    std::sort(scratch.manifolds.begin(), scratch.manifolds.end(), [](const auto& l, const auto& r) {
      return l.awake_index != r.awake_index ? l.awake_index < r.awake_index : l.ordinal < r.ordinal;
    });

  scratch.doomed_contacts.clear();
  scratch.new_touches.clear();
  std::size_t next_found = 0;
  for (std::size_t block = 0; block < count; block += 8) {
    std::uint64_t any;
    if (block + 64 < count) call_for_changes(world, block + 64);
    __builtin_memcpy(&any, &scratch.contact_changes[block], 8);
    if (any == 0) continue;
    for (std::size_t i = block; i < min(block + 8, count); ++i)
      if (scratch.contact_changes[i] != 0) apply_change(world, i, next_found);
  }
  enter_graph_in_order(world);
  for (std::size_t k = 0; k < scratch.doomed_contacts.size(); ++k) {
    if (k + 6 < scratch.doomed_contacts.size()) {
      const ContactRecord<D>& soon = world.contacts.at(scratch.doomed_contacts[k + 6]);
      world.pairs.prefetch(PairSet::key(soon.shape[0], soon.shape[1]));
      for (int side = 0; side < 2; ++side)
        for (const std::int32_t link : {soon.previous[side], soon.next[side]})
          if (link != none) prefetch_lines(&world.contacts.at(link >> 1), sizeof(ContactRecord<D>));
    }
    destroy_contact(world, scratch.doomed_contacts[k], false);
  }
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
