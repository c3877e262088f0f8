// What shapes and the caller say about single contacts: one-way surfaces and contact modifiers.
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

/// m/s of B against A at a point of the world.
template <class D>
typename D::Vector velocity_between(const WorldImplementation<D>& world, const ContactRecord<D>& c,
                                    const typename D::Position& point) {
  const auto velocity = [&](std::int32_t body) {
    const SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
    const typename D::Vector arm(point - world.bodies.motion[std::size_t(body)].center);
    return s.linear_velocity + cross(s.angular_velocity, arm);
  };
  return velocity(c.body[1]) - velocity(c.body[0]);
}

template <class D>
struct Patch {
  typename D::Position points[D::max_points];
  float separations[D::max_points];
  typename D::Vector normal{};
  float deepest = 1e30f;
  typename D::Position middle{};

  Patch(const WorldImplementation<D>& world, const ManifoldRecord<D>& m) {
    contact_points_now(world, m, points, separations, normal);
    for (int i = 0; i < m.manifold.count; ++i) {
      deepest = min(deepest, separations[i]);
      middle += points[i] * (1.0 / m.manifold.count);
    }
  }
};

/// Decides when the contact gets its first manifold, and lets through until the other is out again, or stands on the
/// side that holds.
template <class D>
bool lets_through(const WorldImplementation<D>& world, ContactRecord<D>& c, int side, const ShapeExtra<D>& extra) {
  const typename D::Vector up =
      rotate(shape_pose(world, world.shapes.at(c.shape[side])).rotation, extra.one_way) * (side == 0 ? 1.0f : -1.0f);
  bool beside = false, inside = false, rising = false;
  for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
    const Patch<D> patch(world, world.contacts.manifold(m));
    const float rise = dot(velocity_between(world, c, patch.middle), up);
    beside = beside || dot(patch.normal, up) < side_cosine;
    // A step ago: what falls fast is noticed when it already reaches in.
    inside = inside || patch.deepest - min(rise, 0.0f) * world.last_dt < -0.25f * c.inner;
    rising = rising || rise > 0.05f;
  }
  if ((c.flags & contact_decided) == 0) {
    c.flags |= contact_decided;
    if (beside || inside || (rising && (c.flags & contact_touching) == 0)) c.flags |= contact_passing;
  } else if ((c.flags & contact_passing) != 0) {
    bool clear = !beside && !rising;
    for (std::int32_t m = c.first_manifold; m != none && clear; m = world.contacts.manifold(m).next)
      clear = Patch<D>(world, world.contacts.manifold(m)).deepest >= 0;
    if (clear) c.flags &= std::uint16_t(~contact_passing);
  }
  return (c.flags & contact_passing) != 0;
}

template <class D>
void ask_modifier(WorldImplementation<D>& world, const ContactRecord<D>& c, std::int32_t manifold, bool enabled) {
  mix_materials(world, manifold);
  ManifoldRecord<D>& m = world.contacts.manifold(manifold);
  const Patch<D> patch(world, m);
  ContactModification<D> ask;
  ask.shape_a = world.shapes.slots.handle_at(c.shape[0]);
  ask.shape_b = world.shapes.slots.handle_at(c.shape[1]);
  ask.material_a = material_at(world, c.shape[0], m.manifold.material).user_id;
  ask.material_b = material_at(world, c.shape[1], m.manifold.material).user_id;
  ask.normal = patch.normal;
  ask.relative_velocity = velocity_between(world, c, patch.middle);
  ask.count = m.manifold.count;
  for (int i = 0; i < m.manifold.count; ++i) ask.points[i] = {patch.points[i], patch.separations[i]};
  ask.enabled = enabled;
  ask.friction = m.friction;
  ask.restitution = m.restitution;
  world.contact_modifier(ask);
  m.disabled = !ask.enabled;
  const float friction = ask.friction >= 0 && ask.friction <= 1e6f ? ask.friction : m.friction;
  const float restitution = ask.restitution >= 0 && ask.restitution <= 1 ? ask.restitution : m.restitution;
  set_manifold_material(world, manifold, friction, restitution, m.rolling_lever);
}

}  // namespace

template <class D>
void choose_friction(WorldImplementation<D>& world) {
  bool any = false;
  for (const PairRuleEntry& e : world.pair_rules) any = any || e.rule.static_friction > e.rule.friction;
  if (!any) return;
  for (const std::int32_t contact : world.contacts.awake) {
    const ContactRecord<D>& c = world.contacts.at(contact);
    for (std::int32_t i = c.first_manifold; i != none; i = world.contacts.manifold(i).next) {
      ManifoldRecord<D>& m = world.contacts.manifold(i);
      const PairRule* rule = find_pair_rule(world, material_at(world, c.shape[0], m.manifold.material).user_id,
                                            material_at(world, c.shape[1], m.manifold.material).user_id);
      if (rule != nullptr && rule->static_friction > rule->friction) m.friction = friction_of(world, m, *rule);
    }
  }
}

template <class D>
void modify_contacts(WorldImplementation<D>& world) {
  if (world.shapes.extras.empty()) return;
  for (const std::int32_t contact : world.contacts.awake) {
    ContactRecord<D>& c = world.contacts.at(contact);
    if ((c.flags & contact_special) == 0 || (c.flags & contact_sensor) != 0) continue;
    if (c.first_manifold == none) {
      c.flags &= std::uint16_t(~(contact_decided | contact_passing));
      continue;
    }
    bool open = false, modify = false;
    for (int side = 0; side < 2; ++side)
      if (const ShapeExtra<D>* extra = world.shapes.extra(c.shape[side])) {
        if (!(extra->one_way == typename D::Vector{})) open = open || lets_through(world, c, side, *extra);
        modify = modify || extra->modify;
      }
    bool sinks = false;
    for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
      world.contacts.manifold(m).disabled = open;
      if (modify && world.contact_modifier) ask_modifier(world, c, m, !open);
      sinks = sinks || world.contacts.manifold(m).disabled;
    }
    // What nothing stops goes through along the normal, which kept manifolds take for an ever deeper contact.
    if (sinks) {
      c.flags &= std::uint16_t(~contact_known);
      if (!world.scratch.watches.empty()) world.scratch.watches[std::size_t(c.awake_index)] = {};
    }
  }
}

template <class D>
bool passes_one_way(const WorldImplementation<D>& world, std::int32_t other, const typename D::Vector& travel) {
  const ShapeExtra<D>* extra = world.shapes.extra(other);
  if (extra == nullptr || extra->one_way == typename D::Vector{}) return false;
  return dot(rotate(shape_pose(world, world.shapes.at(other)).rotation, extra->one_way), travel) >= 0;
}

#define CAROM_INSTANTIATE(D)                                 \
  template void choose_friction<D>(WorldImplementation<D>&); \
  template void modify_contacts<D>(WorldImplementation<D>&); \
  template bool passes_one_way<D>(const WorldImplementation<D>&, std::int32_t, const D::Vector&);
CAROM_INSTANTIATE(Dim2)
CAROM_INSTANTIATE(Dim3)
#undef CAROM_INSTANTIATE

}  // namespace carom::rigid::detail
