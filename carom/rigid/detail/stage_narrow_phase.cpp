#include <algorithm>
#include <bit>

#include "carom/geometry/detail/lane_pairs.h"
#include "carom/rigid/detail/coarse.h"
#include "carom/rigid/detail/fly_past.h"
#include "carom/rigid/detail/found_contacts.h"
#include "carom/rigid/detail/shape_manifolds.h"
#include "carom/rigid/detail/stages.h"
// Parts of this file:
#include "carom/rigid/detail/pair_motion.inl"
#include "carom/rigid/detail/pair_watch.inl"
// And of those two:
#include "carom/rigid/detail/pair_update.inl"

namespace carom::rigid::detail {
namespace {

constexpr int contact_grain = 128;  ///< so many are passed over and sorted at a time
/// So many of all contacts are a worker's at a time: in the plane more, so that fewer lanes stay empty when its queues
/// end; where there are few, fewer: one with a mesh takes as long as many others.
template <class D>
constexpr int worker_grain(std::size_t count) {
  if (D::dimension == 2) return 3 * contact_grain;
  return count < 8 * contact_grain ? contact_grain / 4 : contact_grain;
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
  world.scheduler->parallel_for(int(count), worker_grain<D>(count), [&](int begin, int end, int worker) {
    std::int32_t due[contact_grain];
    PairUpdates<D> updates(world, scratch.found_manifolds[std::size_t(worker)]);
    const int width = world.kernels.pairs.width;
    // Found once: to the compiler, whatever is written might move them.
    const ContactWatch<D>* const watches = scratch.watches.data();
    const typename D::Pose* const poses = world.bodies.pose.data();
    const BodySweep<D>* const sweeps = scratch.sweeps.data();
    const std::int32_t* const awake = world.contacts.awake.data();
    const ContactRecord<D>* const contacts = world.contacts.contacts.data();
    const ShapeRecord<D>* const shapes = world.shapes.record.data();
    const ManifoldRecord<D>* const manifolds = world.contacts.manifolds.data();
    // Of fewer bodies the poses stay in the processor's second cache from the step before.
    const bool many = world.bodies.pose.size() * (sizeof *poses + sizeof *sweeps) > (512u << 10);
    const auto bodies_soon = [&](const std::int32_t(&pair)[2]) __attribute__((always_inline)) {
      for (const std::int32_t body : pair) {
        __builtin_prefetch(poses + body);
        __builtin_prefetch(sweeps + body);
      }
    };
    while (begin < end) {
      const int stop = min(begin + contact_grain, end);
      int number = 0;
      for (; begin < stop; begin += width) {
        const int lanes = min(width, stop - begin);
        for (int soon = begin + width; soon < min(begin + 2 * width, stop); ++soon) {
          const ContactWatch<D>& watch = watches[soon];
          __builtin_prefetch(&watch + 4 * width);
          if (many && watch.body[0] != none) bodies_soon(watch.body);
        }
        const std::uint32_t old =
            world.kernels.pairs.nothing_new(watches + begin, lanes, poses, sweeps, world.last_dt);  // bits by lane
        for (std::uint32_t news = ~old & ((1u << lanes) - 1); news != 0; news &= news - 1) {
          const int i = begin + std::countr_zero(news);
          prefetch_lines(contacts + awake[i], sizeof(ContactRecord<D>));
          due[number++] = i;
        }
      }
      if (D::dimension == 2) sort_by_kind(due, number, contacts, awake);
      const auto look_at_soon = [&](int k) __attribute__((always_inline)) {  // as prefetch_lines
        const ContactRecord<D>& soon = contacts[awake[due[k]]];
        if (many) bodies_soon(soon.body);
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
      for (int k = 0; k < min(width, number); ++k) look_at_soon(k);
      for (int k = 0; k < number; ++k) {
        if (k + width < number) look_at_soon(k + width);
        bounds_soon(k);
        updates.add(due[k]);
      }
    }
    updates.finish();
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
        rouse_body(world, body);
  }
  enter_graph_in_order(world);
}

template void update_contacts<Dim2>(WorldImplementation<Dim2>&);
template void update_contacts<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
