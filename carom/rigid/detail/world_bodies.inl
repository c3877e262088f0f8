// World's members about bodies.
#pragma once

#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/check.h"

namespace carom::rigid {
namespace detail {

/// Slot of a valid body, or the complaint `World::call: body: …`.
template <class D>
Result<std::int32_t> slot_of(const WorldImplementation<D>& world, std::string_view call, BodyId body) {
  const Status status = world.bodies.slots.check(body, "body");
  if (!status.ok()) return core::Error{core::text("World::", call, ": ", status.error().message)};
  return std::int32_t(world.bodies.slots.slot(body));
}
template <class D>
void check_body(Complaint& c, const BodyDef<D>& d) {
  check_size(c, "position", d.position, max_coordinate);
  c.rotation("rotation", d.rotation);
  check_size(c, "linear_velocity", d.linear_velocity, max_velocity);
  check_size(c, "angular_velocity", d.angular_velocity, max_velocity);
  check_range(c, "linear_damping", d.linear_damping, 0, 1e6);
  check_range(c, "angular_damping", d.angular_damping, 0, 1e6);
  check_range(c, "gravity_scale", d.gravity_scale, -1e6, 1e6);
  check_range(c, "time_scale", d.time_scale, 1e-3, 1e3);
  check_range(c, "sleep_speed", d.sleep_speed, 0, 1e6);
  check_range(c, "substeps", d.substeps, 0, 64);
  if (d.type != BodyType::fixed && d.type != BodyType::kinematic && d.type != BodyType::dynamic)
    c.say(core::text("type is ", int(d.type), ", expected fixed, kinematic or dynamic"));
}
/// The awake bodies that contacts and joints tie to a body, with it.
template <class D>
std::vector<std::int32_t> island_of(const WorldImplementation<D>& world, std::int32_t body) {
  std::vector<std::int32_t> island{body};
  const auto visit = [&](std::int32_t other) {
    if (other == none || !world.bodies.is_dynamic(other) || world.bodies.record[std::size_t(other)].awake_index == none)
      return;
    for (const std::int32_t known : island)
      if (known == other) return;
    island.push_back(other);
  };
  for (std::size_t i = 0; i < island.size(); ++i) {
    const BodyRecord& r = world.bodies.record[std::size_t(island[i])];
    if (r.type != BodyType::dynamic) continue;
    for (std::int32_t key = r.first_contact; key != none; key = world.contacts.at(key >> 1).next[key & 1])
      if (world.contacts.at(key >> 1).first_manifold != none) visit(world.contacts.at(key >> 1).body[1 - (key & 1)]);
    for (std::int32_t key = r.first_joint; key != none; key = world.joints.headers[std::size_t(key >> 1)].next[key & 1])
      visit(world.joints.headers[std::size_t(key >> 1)].body[1 - (key & 1)]);
  }
  return island;
}
template <class D>
void reserve_bodies(BodyStore<D>& bodies, std::size_t count) {
  bodies.solver.reserve(count);
  bodies.pose.reserve(count);
  bodies.motion.reserve(count);
  bodies.record.reserve(count);
  bodies.birth.reserve(count);
}

/// Takes the body out of trees, contacts and the set of movers, or puts it back.
template <class D>
void take_out(WorldImplementation<D>& world, std::int32_t body) {
  wake_body(world, body);
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const std::int32_t next = world.contacts.at(key >> 1).next[key & 1];
    destroy_contact(world, key >> 1, true);
    key = next;
  }
  deactivate_body(world, body);
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next)
    remove_from_tree(world, s);
}
template <class D>
void put_back(WorldImplementation<D>& world, std::int32_t body) {
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next)
    insert_into_tree(world, s);
  activate_body(world, body);
  enter_graph_in_order(world);
}
/// Detaches the joints of a body while `change` alters what the graph depends on.
template <class D, class F>
void with_joints_detached(WorldImplementation<D>& world, std::int32_t body, F&& change) {
  std::vector<std::int32_t> joints;
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_joint; key != none;
       key = world.joints.headers[std::size_t(key >> 1)].next[key & 1])
    joints.push_back(key >> 1);
  for (const std::int32_t joint : joints) detach_joint(world, joint);
  change();
  for (std::size_t i = joints.size(); i-- > 0;) attach_joint(world, joints[i]);
}

}  // namespace detail

template <class D>
Result<BodyId> World<D>::create_body(const BodyDef<D>& d) {
  using namespace detail;
  Complaint complaint("World::create_body");
  check_body(complaint, d);
  if (!complaint.none_yet()) return complaint.error();
  BodyStore<D>& bodies = self_->bodies;
  const BodyId id = bodies.slots.allocate();
  const std::size_t slot = std::size_t(bodies.slots.slot(id));
  if (slot == bodies.record.size()) {
    if (slot == bodies.record.capacity()) reserve_bodies(bodies, core::next_capacity(slot));
    bodies.solver.resize(slot + 1);
    bodies.pose.resize(slot + 1);
    bodies.motion.resize(slot + 1);
    bodies.record.resize(slot + 1);
    bodies.birth.resize(slot + 1);
  }
  bodies.solver[slot] = {};
  bodies.motion[slot] = {};
  bodies.record[slot] = {};
  bodies.birth[slot] = self_->births++;
  bodies.pose[slot] = {d.position, unit_rotation(d.rotation)};
  BodyMotion<D>& m = bodies.motion[slot];
  m.center = d.position;
  m.linear_damping = d.linear_damping;
  m.angular_damping = d.angular_damping;
  m.gravity_scale = d.gravity_scale;
  BodyRecord& r = bodies.record[slot];
  r.type = d.type;
  r.locks = lock_bits(d.locks);
  r.sleep_speed = d.sleep_speed;
  r.substeps = std::uint8_t(d.substeps);
  if (d.substeps > 0) ++bodies.substep_wishes;
  bodies.set_pace(std::int32_t(slot), d.time_scale);
  give_word(bodies.user_data, std::int32_t(slot), d.user_data);
  set_flag(r, body_enabled, d.enabled);
  set_flag(r, body_bullet, d.bullet);
  set_flag(r, body_allow_sleep, d.allow_sleep);
  if (!d.name.empty() || !bodies.names.empty()) {
    if (bodies.names.size() < bodies.record.size()) bodies.names.resize(bodies.record.size());
    bodies.names[slot] = std::string(d.name);
  }
  if (d.type != BodyType::fixed) {
    bodies.solver[slot].linear_velocity = d.linear_velocity;
    bodies.solver[slot].angular_velocity = d.angular_velocity;
    if (d.awake) activate_body(*self_, std::int32_t(slot));
  }
  return id;
}

template <class D>
Status World<D>::destroy_body(BodyId body) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "destroy_body", body);
  if (!slot.ok()) return slot.error();
  forget_body_in_effectors(*self_, body);
  destroy_joints_of(*self_, *slot);
  take_out(*self_, *slot);
  for (std::int32_t s = self_->bodies.record[std::size_t(*slot)].first_shape; s != none;) {
    ShapeRecord<D>& shape = self_->shapes.at(s);
    const std::int32_t next = shape.next;
    if (shape.flags & shape_hit_events) --self_->hit_event_shapes;
    self_->shapes.slots.release(self_->shapes.slots.handle_at(s));
    // A slot in `moved` stays there until the next step; without a leaf it is passed over.
    const std::uint8_t moved = shape.flags & shape_moved;
    self_->shapes.forget_extra(s);
    if (is_moving_surface(*self_, s)) --self_->shapes.moving_surfaces;
    shape = {};
    self_->shapes.geometry_copy.reset();
    shape.flags = moved;
    s = next;
  }
  if (!self_->bodies.names.empty() && std::size_t(*slot) < self_->bodies.names.size())
    self_->bodies.names[std::size_t(*slot)].clear();
  if (self_->bodies.record[std::size_t(*slot)].substeps > 0) --self_->bodies.substep_wishes;
  self_->bodies.solver[std::size_t(*slot)] = {};
  self_->bodies.record[std::size_t(*slot)] = {};
  self_->bodies.slots.release(body);
  return {};
}

template <class D>
bool World<D>::contains(BodyId body) const {
  return self_->bodies.slots.contains(body);
}

template <class D>
Result<BodyState<D>> World<D>::state(BodyId body) const {
  const Result<std::int32_t> slot = detail::slot_of(*self_, "state", body);
  if (!slot.ok()) return slot.error();
  return detail::state_of(*self_, *slot);
}

template <class D>
Result<BodyDef<D>> World<D>::body_definition(BodyId body) const {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "body_definition", body);
  if (!slot.ok()) return slot.error();
  const std::size_t i = std::size_t(*slot);
  const BodyRecord& r = self_->bodies.record[i];
  const BodyMotion<D>& m = self_->bodies.motion[i];
  BodyDef<D> d;
  d.type = r.type;
  d.position = self_->bodies.pose[i].position;
  d.rotation = self_->bodies.pose[i].rotation;
  d.linear_velocity = self_->bodies.solver[i].linear_velocity;
  d.angular_velocity = self_->bodies.solver[i].angular_velocity;
  d.linear_damping = m.linear_damping;
  d.angular_damping = m.angular_damping;
  d.gravity_scale = m.gravity_scale;
  d.time_scale = self_->bodies.pace(*slot);
  d.sleep_speed = r.sleep_speed;
  d.substeps = r.substeps;
  d.locks = locks_of(r.locks);
  d.awake = r.awake_index != none;
  d.allow_sleep = (r.flags & body_allow_sleep) != 0;
  d.bullet = (r.flags & body_bullet) != 0;
  d.enabled = r.enabled();
  d.user_data = word_of(self_->bodies.user_data, *slot);
  if (i < self_->bodies.names.size()) d.name = self_->bodies.names[i];
  return d;
}

namespace detail {
template <class D>
typename D::MassProperties mass_of(const WorldImplementation<D>& world, std::int32_t body) {
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  typename D::MassProperties p;
  p.mass = m.mass;
  p.center = typename D::Position(m.local_center);
  p.inertia = decltype(p.inertia)(m.inertia);
  return p;
}
inline bool sound_inertia(double i) { return is_finite(i) && i >= 0 && i <= 1e30; }
inline bool sound_inertia(const Mat3d& i) {
  const double scale = i.cx.x + i.cy.y + i.cz.z;
  if (!is_finite(i.cx) || !is_finite(i.cy) || !is_finite(i.cz) || !(scale >= 0 && scale <= 1e30)) return false;
  const double t = 1e-6 * scale;
  if (math::abs(i.cx.y - i.cy.x) > t || math::abs(i.cx.z - i.cz.x) > t || math::abs(i.cy.z - i.cz.y) > t) return false;
  // Positive definite (Sylvester), or all zero: a body that does not turn.
  return scale == 0 || (i.cx.x > 0 && i.cx.x * i.cy.y - i.cx.y * i.cy.x > 0 && determinant(i) > 0);
}
}  // namespace detail

template <class D>
Result<geometry::MassProperties2> World<D>::mass_properties2(BodyId body) const
  requires(D::dimension == 2)
{
  const Result<std::int32_t> slot = detail::slot_of(*self_, "mass_properties2", body);
  if (!slot.ok()) return slot.error();
  return detail::mass_of(*self_, *slot);
}
template <class D>
Result<geometry::MassProperties3> World<D>::mass_properties3(BodyId body) const
  requires(D::dimension == 3)
{
  const Result<std::int32_t> slot = detail::slot_of(*self_, "mass_properties3", body);
  if (!slot.ok()) return slot.error();
  return detail::mass_of(*self_, *slot);
}

template <class D>
Status World<D>::set_mass_properties(BodyId body, const typename D::MassProperties& p) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_mass_properties", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_mass_properties");
  check_range(complaint, "mass", p.mass, 1e-12, max_body_mass);
  check_size(complaint, "center", p.center, max_size);
  if (!sound_inertia(p.inertia))
    complaint.say("inertia is not a symmetric positive tensor (or zero) with elements up to 1e30 kg·m², expected one");
  if (!complaint.none_yet()) return complaint.error();
  if (self_->bodies.record[std::size_t(*slot)].type != BodyType::dynamic)
    return core::Error{"World::set_mass_properties: the body is not dynamic, expected a dynamic body"};
  wake_body(*self_, *slot);
  BodyMotion<D>& m = self_->bodies.motion[std::size_t(*slot)];
  self_->bodies.record[std::size_t(*slot)].flags |= body_mass_given;
  m.mass = float(p.mass);
  const Vector old_center = m.local_center;
  m.local_center = Vector(p.center);
  m.inertia = typename D::Inertia(p.inertia);
  SolverBody<D>& s = self_->bodies.solver[std::size_t(*slot)];
  s.linear_velocity +=
      cross(s.angular_velocity, rotate(self_->bodies.pose[std::size_t(*slot)].rotation, m.local_center - old_center));
  update_mass(*self_, *slot);
  return {};
}

}  // namespace carom::rigid
