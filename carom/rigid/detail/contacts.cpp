#include "carom/rigid/detail/contacts.h"

#include "carom/rigid/detail/load_account.h"

namespace carom::rigid::detail {
namespace {

template <class D>
void link_contact(WorldImplementation<D>& world, std::int32_t contact, int side) {
  ContactRecord<D>& c = world.contacts.at(contact);
  BodyRecord& body = world.bodies.record[std::size_t(c.body[side])];
  const std::int32_t key = 2 * contact + side;
  c.previous[side] = none;
  c.next[side] = body.first_contact;
  if (body.first_contact != none) world.contacts.at(body.first_contact >> 1).previous[body.first_contact & 1] = key;
  body.first_contact = key;
  ++body.contact_count;
}

template <class D>
void unlink_contact(WorldImplementation<D>& world, std::int32_t contact, int side) {
  ContactRecord<D>& c = world.contacts.at(contact);
  BodyRecord& body = world.bodies.record[std::size_t(c.body[side])];
  const std::int32_t previous = c.previous[side], next = c.next[side];
  if (previous != none)
    world.contacts.at(previous >> 1).next[previous & 1] = next;
  else
    body.first_contact = next;
  if (next != none) world.contacts.at(next >> 1).previous[next & 1] = previous;
  --body.contact_count;
}

template <class D>
bool is_awake(const WorldImplementation<D>& world, std::int32_t body) {
  const BodyRecord& record = world.bodies.record[std::size_t(body)];
  return record.awake_index != none && record.type != BodyType::fixed;
}

template <class D>
void enter_graph(WorldImplementation<D>& world, std::int32_t manifold) {
  ManifoldRecord<D>& m = world.contacts.manifold(manifold);
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  if (m.place.color >= 0) return;
  m.place = world.graph.add(ConstraintKind::manifold, manifold, c.body[0], c.body[1], world.bodies);
  if (needs_extra(m)) ++world.graph.colors[m.place.color].extra;
}

template <class D>
void leave_graph(WorldImplementation<D>& world, std::int32_t manifold) {
  ManifoldRecord<D>& m = world.contacts.manifold(manifold);
  if (m.place.color < 0) return;
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const std::int32_t moved = world.graph.remove(ConstraintKind::manifold, m.place, c.body[0], c.body[1], world.bodies);
  if (moved != none) world.contacts.manifold(moved).place = m.place;
  if (needs_extra(m)) --world.graph.colors[m.place.color].extra;
  m.place = {};
}

float round_radius(const geometry::Shape2& s) {
  switch (s.type) {
    case geometry::ShapeType2::circle:
      return s.circle.radius;
    case geometry::ShapeType2::capsule:
      return s.capsule.radius;
    case geometry::ShapeType2::polygon:
      return s.polygon.radius;
    default:
      return 0;
  }
}
float round_radius(const geometry::Shape3& s) {
  switch (s.type) {
    case geometry::ShapeType3::sphere:
      return s.sphere.radius;
    case geometry::ShapeType3::capsule:
      return s.capsule.radius;
    case geometry::ShapeType3::cylinder:
      return s.cylinder.radius + s.cylinder.rounding;
    case geometry::ShapeType3::cone:
      return s.cone.radius + s.cone.rounding;
    case geometry::ShapeType3::box:
      return s.box.radius;
    case geometry::ShapeType3::ellipsoid:
      return (s.ellipsoid.radii.x + s.ellipsoid.radii.y + s.ellipsoid.radii.z) * (1.0f / 3);
    default:
      return 0;
  }
}
template <class D>
int surface_count(const WorldImplementation<D>& world, std::int32_t shape) {
  const ShapeExtra<D>* extra = world.shapes.extra(shape);
  return extra != nullptr ? extra->surface_count : 0;
}
/// Is it round where it touches? Rounded edges of what lies on its faces do not count.
bool rolls(const ShapeRecord<Dim2>& s) {
  using geometry::ShapeType2;
  return s.geometry.type == ShapeType2::capsule ||
         (s.geometry.type == ShapeType2::polygon && 4 * s.geometry.polygon.radius > s.outer_extent);
}
bool rolls(const ShapeRecord<Dim3>& s) {
  using geometry::ShapeType3;
  switch (s.geometry.type) {
    case ShapeType3::capsule:
    case ShapeType3::cylinder:
    case ShapeType3::cone:
      return true;
    case ShapeType3::box:
      return 4 * s.geometry.box.radius > s.outer_extent;
    case ShapeType3::hull:
      return 4 * s.geometry.hull->radius > s.outer_extent;
    default:
      return false;
  }
}
/// Circles and capsules of the plane: two numbers are all there is to read.
bool is_small(const geometry::Shape2& s) { return s.type <= geometry::ShapeType2::capsule; }
bool is_small(const geometry::Shape3&) { return false; }
bool has_round_base(const geometry::Shape2&) { return false; }
bool has_round_base(const geometry::Shape3& s) {
  return s.type == geometry::ShapeType3::cylinder || s.type == geometry::ShapeType3::cone;
}

}  // namespace

template <class D>
bool may_collide(const WorldImplementation<D>& world, const ShapeRecord<D>& a, const ShapeRecord<D>& b) {
  if (a.body == b.body) return false;
  const bool sensor_a = (a.flags & shape_sensor) != 0, sensor_b = (b.flags & shape_sensor) != 0;
  if (sensor_a && sensor_b) return false;
  const BodyType type_a = world.bodies.record[std::size_t(a.body)].type;
  const BodyType type_b = world.bodies.record[std::size_t(b.body)].type;
  if (type_a != BodyType::dynamic && type_b != BodyType::dynamic) {
    // Only sensors report bodies that forces do not move, and only moving ones.
    if (!sensor_a && !sensor_b) return false;
    if (type_a == BodyType::fixed && type_b == BodyType::fixed) return false;
  }
  const Filter &own = world.shapes.terms_of(a).filter, &other = world.shapes.terms_of(b).filter;
  if (own.group != 0 && own.group == other.group) return own.group > 0;
  return (own.category & other.mask) != 0 && (other.category & own.mask) != 0;
}

template <class D>
void describe_contact(const WorldImplementation<D>& world, ContactRecord<D>& c) {
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  c.flags = contact_in_use;
  const std::uint8_t flags = a.flags | b.flags;
  if (flags & shape_sensor) c.flags |= contact_sensor;
  if (flags & shape_many) c.flags |= contact_many;
  if (flags & shape_contact_events) c.flags |= contact_events;
  if (flags & shape_hit_events) c.flags |= contact_hit_events;
  if (flags & shape_round) c.flags |= contact_round;
  c.rolls = (flags & shape_round) != 0 || rolls(a) || rolls(b);
  c.small = std::uint16_t(is_small(a.geometry) ? 1 : 0) | std::uint16_t(is_small(b.geometry) ? 2 : 0);
  if (has_round_base(a.geometry) || has_round_base(b.geometry)) c.flags |= contact_on_disc;
  if (a.at_origin && b.at_origin) c.flags |= contact_at_origin;
  if (world.bodies.is_dynamic(a.body) && world.bodies.is_dynamic(b.body)) c.flags |= contact_dynamic;
}

template <class D>
void create_contact(WorldImplementation<D>& world, std::int32_t shape_a, std::int32_t shape_b) {
  const ShapeRecord<D>*a = &world.shapes.at(shape_a), *b = &world.shapes.at(shape_b);
  // A is the one in whose frame little changes: the surface of many parts, then the fixed body, then what does not turn
  // in place, then the larger shape.
  const auto rank = [&](const ShapeRecord<D>& s) {
    const bool wheel = D::dimension == 2 && (s.flags & shape_round) != 0;
    return ((s.flags & shape_many) != 0 ? 4 : 0) + (world.bodies.is_fixed(s.body) ? 2 : 0) + (wheel ? 0 : 1);
  };
  if (rank(*b) > rank(*a) || (rank(*b) == rank(*a) && b->outer_extent > a->outer_extent)) {
    std::swap(a, b);
    std::swap(shape_a, shape_b);
  }
  ContactStore<D>& store = world.contacts;
  std::int32_t index;
  if (!store.free_contacts.empty()) {
    index = store.free_contacts.back();
    store.free_contacts.pop_back();
    store.at(index) = {};
  } else {
    index = std::int32_t(store.contacts.size());
    store.contacts.push_back({});
    store.free_contacts.reserve(store.contacts.capacity());
  }
  ContactRecord<D>& c = store.at(index);
  c.shape[0] = shape_a;
  c.shape[1] = shape_b;
  c.body[0] = a->body;
  c.body[1] = b->body;
  describe_contact(world, c);
  update_contact_flags(world, index);
  c.extent = ball_about(*b).radius;
  const float inner = min(a->inner_extent, b->inner_extent);
  c.inner = inner;
  world.pairs.insert(PairSet::key(shape_a, shape_b));
  ++store.count;
  link_contact(world, index, 0);
  link_contact(world, index, 1);
  if (is_awake(world, c.body[0]) || is_awake(world, c.body[1])) activate_contact(world, index);
}

template <class D>
void destroy_contact(WorldImplementation<D>& world, std::int32_t contact, bool wake) {
  ContactStore<D>& store = world.contacts;
  if ((store.at(contact).flags & contact_touching) != 0) {
    const ContactRecord<D>& c = store.at(contact);
    const ShapeId a = world.shapes.slots.handle_at(c.shape[0]), b = world.shapes.slots.handle_at(c.shape[1]);
    if (c.flags & contact_sensor) {
      const bool first = (world.shapes.at(c.shape[0]).flags & shape_sensor) != 0;
      world.scratch.pending_sensor_end.push_back(first ? SensorEvent{a, b} : SensorEvent{b, a});
    } else if (c.flags & contact_events) {
      world.scratch.pending_contact_end.push_back({a, b});
    }
  }
  const bool touched = store.at(contact).first_manifold != none;
  while (store.at(contact).first_manifold != none) remove_manifold(world, store.at(contact).first_manifold);
  deactivate_contact(world, contact);
  unlink_contact(world, contact, 0);
  unlink_contact(world, contact, 1);
  ContactRecord<D>& c = store.at(contact);
  world.pairs.erase(PairSet::key(c.shape[0], c.shape[1]));
  const std::int32_t a = c.body[0], b = c.body[1];
  c.flags = 0;
  store.free_contacts.push_back(contact);
  --store.count;
  if (wake && touched) {
    wake_body(world, a);
    wake_body(world, b);
  }
}

template <class D>
void destroy_contacts_of_shape(WorldImplementation<D>& world, std::int32_t shape) {
  const std::int32_t body = world.shapes.at(shape).body;
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    const std::int32_t next = c.next[key & 1];
    if (c.shape[key & 1] == shape) destroy_contact(world, key >> 1, true);
    key = next;
  }
}

template <class D>
void destroy_contacts_between(WorldImplementation<D>& world, std::int32_t a, std::int32_t b) {
  for (std::int32_t key = world.bodies.record[std::size_t(a)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    const std::int32_t next = c.next[key & 1];
    if (c.body[1 - (key & 1)] == b) destroy_contact(world, key >> 1, true);
    key = next;
  }
}

template <class D>
void find_pairs_again(WorldImplementation<D>& world, std::int32_t body) {
  world.scratch.old_bounds.clear();
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
    ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none || (shape.flags & shape_moved) != 0) continue;
    shape.flags |= shape_moved;
    world.scratch.moved.push_back(s);
  }
}

template <class D>
void update_contact_flags(WorldImplementation<D>& world, std::int32_t contact) {
  ContactRecord<D>& c = world.contacts.at(contact);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  c.flags &= std::uint16_t(~(contact_bouncy | contact_special));
  core::Column<ContactWatch<D>>& watches = world.scratch.watches;
  if (c.awake_index != none && !watches.empty()) watches[std::size_t(c.awake_index)] = {};
  if (((a.flags | b.flags) & shape_special) != 0) c.flags |= contact_special;
  float restitution = 0;
  // Whatever parts may meet: one of the shapes at most has several.
  const int parts = max(1, max(surface_count(world, c.shape[0]), surface_count(world, c.shape[1])));
  for (int part = 0; part < parts; ++part) {
    const Material &ma = material_at(world, c.shape[0], std::uint32_t(part)),
                   &mb = material_at(world, c.shape[1], std::uint32_t(part));
    const PairRule* rule = find_pair_rule(world, ma.user_id, mb.user_id);
    restitution = max(restitution, rule != nullptr ? rule->restitution : max(ma.restitution, mb.restitution));
  }
  for (const std::int32_t shape : c.shape)
    if (const ShapeExtra<D>* extra = world.shapes.extra(shape); extra != nullptr && extra->modify)
      restitution = 1;  // a contact modifier may ask for it
  if (restitution >= least_bounce) c.flags |= contact_bouncy;
}

template <class D>
void set_manifold_material(WorldImplementation<D>& world, std::int32_t manifold, float friction, float restitution,
                           float rolling_lever) {
  ManifoldRecord<D>& m = world.contacts.manifold(manifold);
  if (m.place.color >= 0 && needs_extra(m)) --world.graph.colors[m.place.color].extra;
  m.friction = friction;
  m.restitution = restitution;
  m.rolling_lever = rolling_lever;
  if (m.place.color >= 0 && needs_extra(m)) ++world.graph.colors[m.place.color].extra;
}

/// m/s: what slides slower than this is at rest, as far as friction goes. What held an anchor in the last step may be
/// shaken faster than what is new, or slid.
constexpr float creep_speed = 0.01f, shaken_speed = 0.1f;

template <class D>
bool sticks(const WorldImplementation<D>& world, const ManifoldRecord<D>& m) {
  using V = typename D::Vector;
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const typename D::Pose pose = shape_pose(world, world.shapes.at(c.shape[0]));
  V middle{};
  for (int i = 0; i < m.manifold.count; ++i) middle += m.manifold.points[i].point * (1.0f / float(m.manifold.count));
  const typename D::Position place = world_point(pose, middle);
  const auto velocity = [&](std::int32_t body) {
    const SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
    return s.linear_velocity + cross(s.angular_velocity, V(place - world.bodies.motion[std::size_t(body)].center));
  };
  const V n = rotate(pose.rotation, m.manifold.normal);
  V slip = velocity(c.body[1]) - velocity(c.body[0]) - surface_slip(world, c, m.manifold.material);
  if constexpr (D::dimension == 2) slip -= V{-n.y, n.x} * m.tangent_speed;
  slip -= n * dot(n, slip);
  return math::length_squared(slip) < square(m.anchor != Anchor::none ? shaken_speed : creep_speed);
}

template <class D>
float friction_of(const WorldImplementation<D>& world, const ManifoldRecord<D>& m, const PairRule& rule) {
  return rule.static_friction > rule.friction && sticks(world, m) ? rule.static_friction : rule.friction;
}

template <class D>
void mix_materials(WorldImplementation<D>& world, std::int32_t manifold) {
  ManifoldRecord<D>& m = world.contacts.manifold(manifold);
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  const float round = max(round_radius(a.geometry), round_radius(b.geometry)), radius = round > 0 ? round : c.inner;
  const Material &ma = material_at(world, c.shape[0], m.manifold.material),
                 &mb = material_at(world, c.shape[1], m.manifold.material);
  const PairRule* const rule = find_pair_rule(world, ma.user_id, mb.user_id);
  m.tangent_speed = ma.tangent_speed + mb.tangent_speed;
  if (rule != nullptr)
    set_manifold_material(world, manifold, friction_of(world, m, *rule), rule->restitution,
                          rule->rolling_resistance * radius);
  else
    set_manifold_material(world, manifold, math::sqrt(ma.friction * mb.friction), max(ma.restitution, mb.restitution),
                          max(ma.rolling_resistance, mb.rolling_resistance) * radius);
  m.spinning_lever =
      (rule != nullptr ? rule->spinning_resistance : max(ma.spinning_resistance, mb.spinning_resistance)) * radius;
}

template <class D>
void add_manifold(WorldImplementation<D>& world, std::int32_t contact, const typename D::Manifold& manifold,
                  std::uint32_t child) {
  ContactStore<D>& store = world.contacts;
  std::int32_t index;
  if (!store.free_manifolds.empty()) {
    index = store.free_manifolds.back();
    store.free_manifolds.pop_back();
    store.manifold(index) = {};
  } else {
    index = std::int32_t(store.manifolds.size());
    store.manifolds.push_back({});
    store.free_manifolds.reserve(store.manifolds.capacity());
    world.scratch.new_manifolds.reserve(store.manifolds.capacity());
  }
  ManifoldRecord<D>& m = store.manifold(index);
  ContactRecord<D>& c = store.at(contact);
  m.contact = contact;
  m.manifold = manifold;
  m.manifold.child = child;
  m.next = c.first_manifold;
  c.first_manifold = index;
  ++c.manifold_count;
  mix_materials(world, index);
  const typename D::Vector meeting = world.bodies.solver[std::size_t(c.body[1])].linear_velocity -
                                     world.bodies.solver[std::size_t(c.body[0])].linear_velocity;
  for (const std::int32_t body : c.body) forget_load(world, body, meeting, world.scratch.dropped);
  world.scratch.new_manifolds.push_back(index);
}

// Colours go by who comes first: by the shapes and their parts, so that what else is in the world, and where in memory
// these manifolds came to lie, does not matter.
template <class D>
void enter_graph_in_order(WorldImplementation<D>& world) {
  ContactStore<D>& store = world.contacts;
  std::vector<std::int32_t>& fresh = world.scratch.new_manifolds;
  const auto key = [&](std::int32_t manifold) {
    const ManifoldRecord<D>& m = store.manifold(manifold);
    const ContactRecord<D>& c = store.at(m.contact);
    return std::tuple(c.shape[0], c.shape[1], m.manifold.child);
  };
  std::sort(fresh.begin(), fresh.end(), [&](std::int32_t l, std::int32_t r) { return key(l) < key(r); });
  for (const std::int32_t manifold : fresh)
    if (store.at(store.manifold(manifold).contact).awake_index != none) enter_graph(world, manifold);
  fresh.clear();
}

template <class D>
void remove_manifold(WorldImplementation<D>& world, std::int32_t manifold) {
  leave_graph(world, manifold);
  ContactStore<D>& store = world.contacts;
  ContactRecord<D>& c = store.at(store.manifold(manifold).contact);
  std::int32_t* link = &c.first_manifold;
  while (*link != manifold) link = &store.manifold(*link).next;
  *link = store.manifold(manifold).next;
  --c.manifold_count;
  store.manifold(manifold).contact = none;
  store.free_manifolds.push_back(manifold);
}

template <class D>
void activate_contact(WorldImplementation<D>& world, std::int32_t contact) {
  ContactRecord<D>& c = world.contacts.at(contact);
  if (c.awake_index != none) return;
  c.awake_index = std::int32_t(world.contacts.awake.size());
  world.contacts.awake.push_back(contact);
  if (!world.scratch.watches.empty()) world.scratch.watches.push_back({});
  for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next)
    world.scratch.new_manifolds.push_back(m);
}

template <class D>
void deactivate_contact(WorldImplementation<D>& world, std::int32_t contact) {
  ContactRecord<D>& c = world.contacts.at(contact);
  if (c.awake_index == none) return;
  for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) leave_graph(world, m);
  std::vector<std::int32_t>& awake = world.contacts.awake;
  const std::int32_t last = awake.back();
  awake[std::size_t(c.awake_index)] = last;
  world.contacts.at(last).awake_index = c.awake_index;
  awake.pop_back();
  core::Column<ContactWatch<D>>& watches = world.scratch.watches;
  if (!watches.empty()) {
    watches[std::size_t(c.awake_index)] = watches.back();
    watches.pop_back();
  }
  c.awake_index = none;
}

#define CAROM_INSTANTIATE(D)                                                                                 \
  template bool may_collide<D>(const WorldImplementation<D>&, const ShapeRecord<D>&, const ShapeRecord<D>&); \
  template void describe_contact<D>(const WorldImplementation<D>&, ContactRecord<D>&);                       \
  template void create_contact<D>(WorldImplementation<D>&, std::int32_t, std::int32_t);                      \
  template void destroy_contact<D>(WorldImplementation<D>&, std::int32_t, bool);                             \
  template void destroy_contacts_of_shape<D>(WorldImplementation<D>&, std::int32_t);                         \
  template void destroy_contacts_between<D>(WorldImplementation<D>&, std::int32_t, std::int32_t);            \
  template void find_pairs_again<D>(WorldImplementation<D>&, std::int32_t);                                  \
  template void update_contact_flags<D>(WorldImplementation<D>&, std::int32_t);                              \
  template void set_manifold_material<D>(WorldImplementation<D>&, std::int32_t, float, float, float);        \
  template void mix_materials<D>(WorldImplementation<D>&, std::int32_t);                                     \
  template float friction_of<D>(const WorldImplementation<D>&, const ManifoldRecord<D>&, const PairRule&);   \
  template void add_manifold<D>(WorldImplementation<D>&, std::int32_t, const D::Manifold&, std::uint32_t);   \
  template void enter_graph_in_order<D>(WorldImplementation<D>&);                                            \
  template void remove_manifold<D>(WorldImplementation<D>&, std::int32_t);                                   \
  template void activate_contact<D>(WorldImplementation<D>&, std::int32_t);                                  \
  template void deactivate_contact<D>(WorldImplementation<D>&, std::int32_t);
CAROM_INSTANTIATE(Dim2)
CAROM_INSTANTIATE(Dim3)
#undef CAROM_INSTANTIATE

}  // namespace carom::rigid::detail
