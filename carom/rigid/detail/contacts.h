// Creating, updating and destroying contacts: serial operations on the world's stores.
#pragma once

#include <algorithm>

#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

/// The shape's frame in the world.
template <class D>
inline typename D::Pose shape_pose(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  const typename D::Pose& pose = world.bodies.pose[std::size_t(shape.body)];
  return shape.at_origin ? pose : pose * shape.local;
}

/// Calls for what the narrow phase reads of the shapes of a contact. Always inlined, as prefetch_lines.
template <class D>
[[gnu::always_inline]] inline void prefetch_shapes(const ShapeRecord<D>* shapes, const ContactRecord<D>& c) {
  constexpr std::size_t small = sizeof(ShapeTraits<D>) + 16;
  constexpr std::size_t whole = D::dimension == 2 ? sizeof(ShapeRecord<D>) - 16 : 192;
  for (int side = 0; side < 2; ++side) {
    const char* const shape = reinterpret_cast<const char*>(shapes + c.shape[side]);
    const std::size_t size = D::dimension == 2 && (c.small >> side & 1) != 0 ? small : whole;
    prefetch_lines(shape, size);
    if (D::dimension == 2) __builtin_prefetch(shape + size - 1);
  }
}

/// m: what goes less far in a step hardly moves: by a quarter of the speed that a step of free fall gives.
template <class D>
inline float still_way(const WorldImplementation<D>& world, float dt) {
  return 0.25f * math::length(world.definition.gravity) * dt * dt;
}

/// True if the filters and the bodies' types let two shapes meet.
template <class D>
bool may_collide(const WorldImplementation<D>& world, const ShapeRecord<D>& a, const ShapeRecord<D>& b);

/// Flags that follow from the shapes and bodies alone, and what else the record says of those.
template <class D>
void describe_contact(const WorldImplementation<D>& world, ContactRecord<D>& c);
/// Does the solver hold more for it than for others?
template <class D>
inline bool needs_extra(const ManifoldRecord<D>& m) {
  return m.restitution > 0 || m.rolling_lever > 0;
}
template <class D>
void create_contact(WorldImplementation<D>& world, std::int32_t shape_a, std::int32_t shape_b);
/// Sends the end event that is due. Wakes the bodies where `wake` and they touched.
template <class D>
void destroy_contact(WorldImplementation<D>& world, std::int32_t contact, bool wake);
template <class D>
void destroy_contacts_of_shape(WorldImplementation<D>& world, std::int32_t shape);

/// Takes over a found manifold; it enters the graph with enter_graph_in_order, once all are found.
template <class D>
void add_manifold(WorldImplementation<D>& world, std::int32_t contact, const typename D::Manifold& manifold,
                  std::uint32_t child);
template <class D>
void enter_graph_in_order(WorldImplementation<D>& world);
template <class D>
void remove_manifold(WorldImplementation<D>& world, std::int32_t manifold);
/// What two material ids have been given instead of the mixture, or null.
template <class D>
inline const PairRule* find_pair_rule(const WorldImplementation<D>& world, std::uint32_t a, std::uint32_t b) {
  if (world.pair_rules.empty()) return nullptr;
  const std::uint64_t key = PairRuleEntry::key_of(a, b);
  const auto i = std::lower_bound(world.pair_rules.begin(), world.pair_rules.end(), key,
                                  [](const PairRuleEntry& e, std::uint64_t k) { return e.key < k; });
  return i != world.pair_rules.end() && i->key == key ? &i->rule : nullptr;
}
/// What a shape is made of where a manifold names this material number.
template <class D>
inline const Material& material_at(const WorldImplementation<D>& world, std::int32_t shape, std::uint32_t number) {
  const SurfaceMaterial<D>* surface = world.shapes.surface(shape, number);
  return surface != nullptr ? surface->material : world.shapes.terms_of(shape).material;
}
/// cos of the angle to its direction within which a one-way surface holds: 60°.
inline constexpr float side_cosine = 0.5f;
/// How fast A's surface runs against B's, world axes, where they are belts.
template <class D>
inline typename D::Vector surface_slip(const WorldImplementation<D>& world, const ContactRecord<D>& c,
                                       std::uint32_t number) {
  typename D::Vector slip{};
  for (int side = 0; side < 2; ++side)
    if (const ShapeExtra<D>* extra = world.shapes.extra(c.shape[side])) {
      const SurfaceMaterial<D>* surface = world.shapes.surface(c.shape[side], number);
      const typename D::Vector v = rotate(shape_pose(world, world.shapes.at(c.shape[side])).rotation,
                                          surface != nullptr ? surface->surface_velocity : extra->surface_velocity);
      slip = side == 0 ? slip + v : slip - v;
    }
  return slip;
}
/// The coefficient of friction of a pair whose rule has one of rest too: that of rest while the contact sticks.
template <class D>
float friction_of(const WorldImplementation<D>& world, const ManifoldRecord<D>& m, const PairRule& rule);
/// Its shapes stand or look otherwise than a step would have left them: the next finds its manifolds afresh.
template <class D>
void look_anew(WorldImplementation<D>& world, ContactRecord<D>& c) {
  c.flags &= std::uint16_t(~(contact_known | contact_recycled));
  core::Column<ContactWatch<D>>& watches = world.scratch.watches;
  if (c.awake_index != none && !watches.empty()) watches[std::size_t(c.awake_index)] = {};
}
/// Flags that follow from the shapes and may change while a contact lives.
template <class D>
void update_contact_flags(WorldImplementation<D>& world, std::int32_t contact);
/// Keeps count of the manifolds of a colour that bounce or roll.
template <class D>
void set_manifold_material(WorldImplementation<D>& world, std::int32_t manifold, float friction, float restitution,
                           float rolling_lever);
/// Friction, restitution and so on of a pair, from its shapes.
template <class D>
void mix_materials(WorldImplementation<D>& world, std::int32_t manifold);

/// For waking and falling asleep: the contact joins or leaves those that are updated, its manifolds the graph
/// (enter_graph_in_order).
template <class D>
void activate_contact(WorldImplementation<D>& world, std::int32_t contact);
template <class D>
void deactivate_contact(WorldImplementation<D>& world, std::int32_t contact);

/// Carries impulses of `from` over to the points of `to` with the same features; a point whose feature is new takes
/// over from the nearest one that is left, if that is near (clipping renames corners when boxes turn by a hair).
template <class D>
inline void carry_impulses(const typename D::Manifold& from, const typename D::Manifold& to, float near,
                           ManifoldImpulses<D>& impulses) {
  if (from.count == to.count) {  // mostly nothing was renamed, and what has one point keeps what that bore
    bool same = true;
    for (int i = 0; i < to.count && to.count > 1; ++i) same = same && to.points[i].feature == from.points[i].feature;
    for (int i = to.count; i < D::max_points && same; ++i) impulses.normal[i] = impulses.total[i] = 0;
    if (same) return;
  }
  float normal[D::max_points] = {}, total[D::max_points] = {};
  bool matched[D::max_points] = {}, used[D::max_points] = {};
  for (int i = 0; i < to.count; ++i)
    for (int j = 0; j < from.count; ++j)
      if (!used[j] && to.points[i].feature == from.points[j].feature) {
        normal[i] = impulses.normal[j];
        total[i] = impulses.total[j];
        matched[i] = used[j] = true;
        break;
      }
  for (int i = 0; i < to.count; ++i) {
    if (matched[i]) continue;
    int best = -1;
    float best_distance = near * near;
    for (int j = 0; j < from.count; ++j) {
      if (used[j]) continue;
      const float d = math::distance_squared(to.points[i].point, from.points[j].point);
      if (d < best_distance) best = j, best_distance = d;
    }
    if (best < 0) continue;
    normal[i] = impulses.normal[best];
    total[i] = impulses.total[best];
    matched[i] = used[best] = true;
  }
  // What is left over (a disc that turns shows other points of its rim) is shared: the load stays the same, also where
  // two points become one.
  float normal_left = 0, total_left = 0;
  int old_left = 0, new_left = 0;
  for (int j = 0; j < from.count; ++j)
    if (!used[j]) normal_left += impulses.normal[j], total_left += impulses.total[j], ++old_left;
  for (int i = 0; i < to.count; ++i) new_left += matched[i] ? 0 : 1;
  const float share = old_left > 0 && new_left > 0 ? 1.0f / float(new_left) : 0;
  for (int i = 0; i < to.count; ++i)
    if (!matched[i]) normal[i] = normal_left * share, total[i] = total_left * share;
  for (int i = 0; i < D::max_points; ++i) {
    impulses.normal[i] = normal[i];
    impulses.total[i] = total[i];
  }
}

}  // namespace carom::rigid::detail
