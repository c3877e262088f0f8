// World's members about the world as a whole: making it, stepping it, reading it.
#pragma once

#include <algorithm>

#include "carom/rigid/detail/memory.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid {
namespace detail {

/// Slots of a pool in the order of their birth.
template <class Slots, class Births>
void by_birth(const Slots& slots, const Births& birth, std::vector<std::int32_t>& out) {
  out.clear();
  for (int i = 0; i < slots.capacity(); ++i)
    if (slots.in_use(i)) out.push_back(i);
  std::sort(out.begin(), out.end(),
            [&](std::int32_t a, std::int32_t b) { return birth[std::size_t(a)] < birth[std::size_t(b)]; });
}

inline void hash_add(core::StateHash& h, const Vec2d& v) { h.add(v.x).add(v.y); }
inline void hash_add(core::StateHash& h, const Vec3d& v) { h.add(v.x).add(v.y).add(v.z); }
inline void hash_add(core::StateHash& h, const Vec2f& v) { h.add(v.x).add(v.y); }
inline void hash_add(core::StateHash& h, const Vec3f& v) { h.add(v.x).add(v.y).add(v.z); }
inline void hash_add(core::StateHash& h, const Rot2f& q) { h.add(q.c).add(q.s); }
inline void hash_add(core::StateHash& h, const Quatf& q) { h.add(q.w).add(q.x).add(q.y).add(q.z); }
inline void hash_add(core::StateHash& h, float x) { h.add(x); }

template <class D>
double spin_energy(const BodyMotion<D>& m, const typename D::Rotation& q, const typename D::Angular& w,
                   auto& momentum) {
  if constexpr (D::dimension == 2) {
    momentum += double(m.inertia) * double(w);
    return 0.5 * double(m.inertia) * double(w) * double(w);
  } else {
    const Quatd qd(q);
    const Vec3d body = inverse_rotate(qd, Vec3d(w));
    const Vec3d l = Mat3d(m.inertia) * body;
    momentum += rotate(qd, l);
    return 0.5 * dot(l, body);
  }
}

template <class D>
void reserve_world(WorldImplementation<D>& world, const Capacity& capacity) {
  const std::size_t bodies = std::size_t(capacity.bodies), shapes = std::size_t(capacity.shapes);
  const std::size_t contacts = std::size_t(capacity.contacts), joints = std::size_t(capacity.joints);
  // Contacts with meshes and compounds have several manifolds, others one or none.
  const std::size_t manifolds = contacts;
  world.reserved = true;
  world.bodies.slots.reserve(int(bodies));
  reserve_bodies(world.bodies, bodies);
  world.bodies.awake.reserve(bodies);
  world.shapes.slots.reserve(int(shapes));
  world.shapes.record.reserve(shapes);
  for (auto& tree : world.shapes.trees) tree.reserve(int(shapes));
  world.joints.slots.reserve(int(joints));
  world.joints.headers.reserve(joints);
  world.joints.room.reserve(joints);
  world.joints.small.reserve(joints);
  world.joints.order.reserve(joints);
  world.joints.offset.reserve(joints + 1);
  world.joints.color_begin.reserve(color_count + 2);
  world.joints.pins.reserve(joints + 16 * (color_count + 1));
  world.joints.pin_begin.reserve(color_count + 2);
  world.joints.limbs.reserve(joints + 16 * 16 * (color_count + 1));
  world.joints.limb_begin.reserve(color_count + 2);
  const std::size_t direct = std::size_t(capacity.direct_joints);
  world.joints.trees.trees.reserve(direct);
  world.joints.trees.bodies.reserve(direct + min(direct, bodies));  // a free tree has one body more
  world.joints.trees.joints.reserve(direct);
  world.joints.trees.of_joint.reserve(joints);
  world.joints.trees.visited.reserve(joints);
  world.joints.trees.place.reserve(bodies);
  world.joints.records.reserve(joints * 24);  // the longest record of a joint takes about that
  world.contacts.contacts.reserve(contacts);
  world.contacts.free_contacts.reserve(contacts);
  world.contacts.awake.reserve(contacts);
  world.contacts.manifolds.reserve(manifolds);
  world.contacts.free_manifolds.reserve(manifolds);
  world.pairs.reserve(contacts);
  for (GraphColor& color : world.graph.colors) {
    color.manifolds.reserve(min(bodies, manifolds));  // no body is twice in a colour
    color.joints.reserve(min(bodies, joints));
  }
  world.sleeping.first.reserve(bodies);
  world.sleeping.free.reserve(bodies);
  StepScratch<D>& s = world.scratch;
  s.solver_stages.reserve(most_solver_stages(world.definition.substeps));  // more where islands have their own
  s.solver_loops.reserve(most_solver_stages(world.definition.substeps));
  s.sweeps.reserve(bodies);
  s.sweeping.reserve(bodies);
  s.watches.reserve(contacts);
  s.old_bounds.reserve(shapes);
  s.moved_place.reserve(shapes);
  s.loads.reserve(bodies);
  for (auto& list : s.load_wishes) list.reserve(bodies);
  s.dropped.reserve(bodies);
  s.again.reserve(bodies);
  s.flights.reserve(bodies);
  s.placed.reserve(manifolds);
  s.impacts.reserve(manifolds);
  s.impact_queue.resize(manifolds);
  s.moved.reserve(shapes);
  for (auto& list : s.found_outgrown) list.reserve(shapes);
  s.outgrown.reserve(shapes);
  s.outgrown_places.reserve(shapes);
  s.new_bounds.reserve(shapes);
  for (auto& list : s.found_pairs) list.reserve(contacts);
  s.pairs.reserve(contacts);
  s.swept.reserve(bodies);
  s.fast.reserve(bodies);
  s.broken.reserve(bodies);
  s.body_changes.reserve(bodies);
  s.contact_changes.reserve(contacts + 8);
  for (auto& list : s.found_manifolds) list.reserve(manifolds);
  s.manifolds.reserve(manifolds);
  for (auto* list : {&s.island_parent, &s.island_list, &s.island_bodies, &s.island_ends}) list->reserve(bodies + 1);
  s.island_restless.reserve(bodies);
  s.island_substeps.reserve(bodies);
  s.whole_awake.reserve(bodies);
  s.whole_trees.reserve(direct);
  for (GraphColor& color : s.whole_colors) {
    color.manifolds.reserve(min(bodies, manifolds));
    color.joints.reserve(min(bodies, joints));
  }
  s.doomed_contacts.reserve(contacts);
  s.new_touches.reserve(contacts);
  s.new_manifolds.reserve(manifolds);
  s.contact_begin.reserve(contacts);
  s.contact_end.reserve(contacts);
  s.pending_contact_end.reserve(contacts);
  s.contact_hit.reserve(contacts);
  s.sensor_begin.reserve(contacts);
  s.sensor_end.reserve(contacts);
  s.pending_sensor_end.reserve(contacts);
  s.fell_asleep.reserve(bodies);
  s.quarantined.reserve(bodies);
  if (world.definition.move_events) s.body_moves.reserve(bodies);
  s.joint_break.reserve(joints);
  s.spring_break.reserve(joints);
  // Blocks of the solver: a lane a manifold, and for every colour one that is not full.
  using Block = ContactBlock<D, 16>;
  using Extra = ContactExtra<D, 16>;
  // Twice the ones that are not full, for islands with substeps of their own; of limbs for four kinds in each colour.
  constexpr std::size_t not_full = color_count + 1;
  const std::size_t blocks = manifolds / 16 + 2 * not_full, pins = joints / 16 + 2 * not_full;
  const std::size_t limbs = min(joints, joints / 16 + 4 * not_full);
  world.arena.reset();
  world.arena = core::Arena(blocks * (sizeof(Block) + sizeof(Extra)) + pins * sizeof(PinLanes<D, 16>) +
                            limbs * sizeof(LimbLanes<D, 16>) + bodies * (sizeof(BodyDrive<D>) + 32) +
                            4 * (color_count + 4) * core::Arena::alignment);
}

}  // namespace detail

template <class D>
World<D>::World(const WorldDef<D>& definition) : self_(std::make_unique<Implementation>(definition)) {}
template <class D>
World<D>::~World() = default;
template <class D>
World<D>::World(World&&) noexcept = default;
template <class D>
World<D>& World<D>::operator=(World&&) noexcept = default;
template <class D>
Status World<D>::check(const WorldDef<D>& definition) {
  return detail::check_definition<D>("World::check", definition);
}
template <class D>
const WorldDef<D>& World<D>::definition() const {
  return self_->definition;
}

template <class D>
Status World<D>::set_gravity(Vector gravity) {
  using namespace detail;
  Complaint complaint("World::set_gravity");
  check_size(complaint, "gravity", gravity, 1e6);
  if (!complaint.none_yet()) return complaint.error();
  if (gravity == self_->definition.gravity) return {};
  self_->definition.gravity = gravity;
  for (std::int32_t i = 0; i < self_->bodies.slots.capacity(); ++i)
    if (self_->bodies.slots.in_use(i) && self_->bodies.is_dynamic(i)) wake_body(*self_, i);
  return {};
}

template <class D>
Status World<D>::set_pair_rule(std::uint32_t material_a, std::uint32_t material_b, const PairRule* rule) {
  using namespace detail;
  if (rule != nullptr) {
    Complaint complaint("World::set_pair_rule");
    check_range(complaint, "friction", rule->friction, 0, 1e6);
    check_range(complaint, "restitution", rule->restitution, 0, 1);
    check_range(complaint, "rolling_resistance", rule->rolling_resistance, 0, 1e6);
    check_range(complaint, "spinning_resistance", rule->spinning_resistance, 0, 1e6);
    check_range(complaint, "static_friction", rule->static_friction, 0, 1e6);
    if (rule->static_friction > 0 && complaint.none_yet())
      check_range(complaint, "static_friction", rule->static_friction, rule->friction, 1e6);
    if (!complaint.none_yet()) return complaint.error();
  }
  const std::uint64_t key = PairRuleEntry::key_of(material_a, material_b);
  self_->shapes.bounce = Bounce::unknown;
  std::vector<PairRuleEntry>& rules = self_->pair_rules;
  const auto i = std::lower_bound(rules.begin(), rules.end(), key,
                                  [](const PairRuleEntry& e, std::uint64_t k) { return e.key < k; });
  const bool known = i != rules.end() && i->key == key;
  if (rule == nullptr && known)
    rules.erase(i);
  else if (rule != nullptr && known)
    i->rule = *rule;
  else if (rule != nullptr)
    rules.insert(i, {key, *rule});
  for (std::size_t k = 0; k < self_->contacts.contacts.size(); ++k) {
    const ContactRecord<D>& c = self_->contacts.contacts[k];
    if ((c.flags & contact_in_use) == 0) continue;
    const std::uint64_t own = PairRuleEntry::key_of(self_->shapes.terms_of(c.shape[0]).material.user_id,
                                                    self_->shapes.terms_of(c.shape[1]).material.user_id);
    if (own != key && (c.flags & contact_special) == 0) continue;  // special ones may have parts of other materials
    update_contact_flags(*self_, std::int32_t(k));
    for (std::int32_t m = c.first_manifold; m != none; m = self_->contacts.manifold(m).next) mix_materials(*self_, m);
    if (c.first_manifold != none)
      for (const std::int32_t body : {c.body[0], c.body[1]}) wake_body(*self_, body);
  }
  return {};
}
template <class D>
void World<D>::pair_rules(std::vector<MaterialPair>& out) const {
  out.clear();
  for (const detail::PairRuleEntry& e : self_->pair_rules)
    out.push_back({std::uint32_t(e.key >> 32), std::uint32_t(e.key), e.rule});
}
template <class D>
void World<D>::set_contact_filter(ContactFilter filter) {
  if (self_->contact_filter) {  // whom the old one refused is to be asked about again
    for (std::size_t body = 0; body < self_->bodies.record.size(); ++body) find_pairs_again(*self_, std::int32_t(body));
  }
  self_->contact_filter = std::move(filter);
}
template <class D>
void World<D>::set_contact_modifier(ContactModifier modifier) {
  self_->contact_modifier = std::move(modifier);
}

template <class D>
Status World<D>::reserve(const Capacity& capacity) {
  using namespace detail;
  Complaint complaint("World::reserve");
  check_range(complaint, "bodies", capacity.bodies, 0, 1 << 24);
  check_range(complaint, "shapes", capacity.shapes, 0, 1 << 24);
  check_range(complaint, "contacts", capacity.contacts, 0, 1 << 24);
  check_range(complaint, "joints", capacity.joints, 0, 1 << 24);
  check_range(complaint, "direct_joints", capacity.direct_joints, 0, 1 << 20);
  if (!complaint.none_yet()) return complaint.error();
  reserve_world(*self_, capacity);
  return {};
}

template <class D>
Status World<D>::step(float dt) {
  return detail::step_world<D>(*self_, dt);
}
template <class D>
std::uint64_t World<D>::step_count() const {
  return self_->step_count;
}
template <class D>
double World<D>::time() const {
  return self_->time;
}

template <class D>
Events<D> World<D>::events() const {
  const detail::StepScratch<D>& s = self_->scratch;
  return {s.contact_begin, s.contact_end, s.contact_hit, s.sensor_begin, s.sensor_end,
          s.fell_asleep,   s.quarantined, s.body_moves,  s.joint_break,  s.spring_break};
}

template <class D>
void World<D>::bodies(std::vector<BodyId>& out) const {
  std::vector<std::int32_t> order;
  detail::by_birth(self_->bodies.slots, self_->bodies.birth, order);
  out.clear();
  for (const std::int32_t i : order) out.push_back(self_->bodies.slots.handle_at(i));
}
template <class D>
void World<D>::shapes(BodyId body, std::vector<ShapeId>& out) const {
  out.clear();
  if (!contains(body)) return;
  for (std::int32_t s = self_->bodies.record[std::size_t(self_->bodies.slots.slot(body))].first_shape;
       s != detail::none; s = self_->shapes.at(s).next)
    out.push_back(self_->shapes.slots.handle_at(s));
}

namespace detail {
/// Appends the manifolds of a contact that touch.
template <class D>
void view_contact(const WorldImplementation<D>& world, const ContactRecord<D>& c, std::vector<ContactView<D>>& out) {
  if ((c.flags & contact_in_use) == 0 || (c.flags & contact_sensor) != 0) return;
  for (std::int32_t i = c.first_manifold; i != none; i = world.contacts.manifold(i).next) {
    const ManifoldRecord<D>& m = world.contacts.manifold(i);
    ContactView<D> view;
    typename D::Position points[D::max_points];
    float separations[D::max_points];
    contact_points_now(world, m, points, separations, view.normal);
    bool touches = false;
    for (int k = 0; k < m.manifold.count; ++k) touches = touches || separations[k] <= 0 || m.impulses.total[k] > 0;
    if (!touches) continue;
    view.shape_a = world.shapes.slots.handle_at(c.shape[0]);
    view.shape_b = world.shapes.slots.handle_at(c.shape[1]);
    view.material_a = material_at(world, c.shape[0], m.manifold.material).user_id;
    view.material_b = material_at(world, c.shape[1], m.manifold.material).user_id;
    view.count = m.manifold.count;
    for (int k = 0; k < m.manifold.count; ++k) view.points[k] = {points[k], separations[k], m.impulses.total[k]};
    view.friction_impulse = m.impulses.friction_total;
    view.color = m.place.color;
    out.push_back(view);
  }
}
}  // namespace detail

template <class D>
void World<D>::contacts(std::vector<ContactView<D>>& out) const {
  out.clear();
  for (const auto& c : self_->contacts.contacts) detail::view_contact<D>(*self_, c, out);
}
template <class D>
void World<D>::contacts(BodyId body, std::vector<ContactView<D>>& out) const {
  out.clear();
  if (!contains(body)) return;
  const auto& record = self_->bodies.record[std::size_t(self_->bodies.slots.slot(body))];
  for (std::int32_t key = record.first_contact; key != detail::none;) {
    const auto& c = self_->contacts.at(key >> 1);
    detail::view_contact<D>(*self_, c, out);
    key = c.next[key & 1];
  }
}

template <class D>
Totals<D> World<D>::totals() const {
  using namespace detail;
  Totals<D> t;
  Position weighted{};
  std::vector<std::int32_t> order;
  by_birth(self_->bodies.slots, self_->bodies.birth, order);
  for (const std::int32_t i : order) {
    const BodyMotion<D>& m = self_->bodies.motion[std::size_t(i)];
    if (!self_->bodies.is_dynamic(i) || !self_->bodies.record[std::size_t(i)].enabled()) continue;
    const SolverBody<D>& s = self_->bodies.solver[std::size_t(i)];
    const double mass = double(m.mass);
    const Position p = Position(s.linear_velocity) * mass;
    t.mass += mass;
    weighted += m.center * mass;
    t.momentum += p;
    t.angular_momentum += cross(m.center, p);
    t.kinetic_energy +=
        0.5 * mass * math::length_squared(Position(s.linear_velocity)) +
        spin_energy<D>(m, self_->bodies.pose[std::size_t(i)].rotation, s.angular_velocity, t.angular_momentum);
    const double pace = double(self_->bodies.pace(i));
    t.potential_energy -=
        mass * double(m.gravity_scale) * (pace * pace) * dot(Position(self_->definition.gravity), m.center);
  }
  if (t.mass > 0) t.center_of_mass = weighted * (1 / t.mass);
  return t;
}

template <class D>
Counters World<D>::counters() const {
  using namespace detail;
  Counters c;
  c.bodies = self_->bodies.slots.size();
  c.awake_bodies = int(self_->bodies.awake.size());
  c.shapes = self_->shapes.slots.size();
  c.joints = self_->joints.count();
  c.effectors = self_->effectors.count();
  c.contacts = self_->contacts.count;
  for (const ContactRecord<D>& contact : self_->contacts.contacts)
    if ((contact.flags & contact_in_use) != 0 && (contact.flags & contact_touching) != 0 &&
        (contact.flags & contact_sensor) == 0)
      ++c.touching_contacts;
  for (const ManifoldRecord<D>& m : self_->contacts.manifolds)
    if (m.contact != none) c.contact_points += m.manifold.count;
  c.islands = count_islands(*self_);
  for (int i = 0; i < color_count; ++i)
    if (!self_->graph.colors[i].manifolds.empty() || !self_->graph.colors[i].joints.empty()) ++c.colors;
  c.overflow_constraints =
      int(self_->graph.colors[overflow_color].manifolds.size() + self_->graph.colors[overflow_color].joints.size());
  c.bytes = bytes_of_world<D>(*self_);
  c.peak_bytes = max(self_->peak_bytes, c.bytes);
  return c;
}

template <class D>
StepProfile World<D>::profile() const {
  return self_->profile;
}

template <class D>
float World<D>::worst_penetration() const {
  using namespace detail;
  float worst = 0;
  for (const ManifoldRecord<D>& m : self_->contacts.manifolds) {
    if (m.contact == none || m.disabled) continue;  // what a one-way surface lets through is in it by right
    if ((self_->contacts.at(m.contact).flags & contact_passing) != 0) continue;
    Position points[D::max_points];
    float separations[D::max_points];
    Vector normal;
    contact_points_now(*self_, m, points, separations, normal);
    for (int k = 0; k < m.manifold.count; ++k) worst = max(worst, -separations[k]);
  }
  return worst;
}

template <class D>
std::uint64_t World<D>::state_hash() const {
  using namespace detail;
  core::StateHash hash;
  std::vector<std::int32_t> order;
  by_birth(self_->bodies.slots, self_->bodies.birth, order);
  for (const std::int32_t i : order) {
    const typename D::Pose& pose = self_->bodies.pose[std::size_t(i)];
    const SolverBody<D>& s = self_->bodies.solver[std::size_t(i)];
    hash_add(hash, pose.position);
    hash_add(hash, pose.rotation);
    hash_add(hash, s.linear_velocity);
    hash_add(hash, s.angular_velocity);
    hash.add(self_->bodies.record[std::size_t(i)].awake_index != none);
    hash.add(std::uint32_t(self_->bodies.record[std::size_t(i)].type));
  }
  return hash.digest();
}

}  // namespace carom::rigid
