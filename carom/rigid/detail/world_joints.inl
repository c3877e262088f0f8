// World's members about joints.
#pragma once

#include <algorithm>

#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid {
namespace detail {

/// Checks everything and only then makes the joint.
template <class D, class Def>
Result<JointId> make_joint(WorldImplementation<D>& world, Def def) {
  constexpr bool mouse = std::is_same_v<Def, MouseJointDef<D>>;
  Complaint complaint("World::create_joint");
  if (mouse) def.body_a = {};
  if (!def.body_a.is_null()) complaint.status(world.bodies.slots.check(def.body_a, "body_a"));
  complaint.status(world.bodies.slots.check(def.body_b, "body_b"));
  if (!complaint.none_yet()) return complaint.error();
  const std::int32_t a = def.body_a.is_null() ? none : world.bodies.slots.slot(def.body_a);
  const std::int32_t b = world.bodies.slots.slot(def.body_b);
  if (a == b) complaint.say("body_a and body_b are the same body, expected two");
  const bool dynamic_a = a != none && world.bodies.is_dynamic(a);
  if (!dynamic_a && !world.bodies.is_dynamic(b))
    complaint.say(a == none ? "body_b is not dynamic, expected a dynamic body where body_a is the world"
                            : "neither body_a nor body_b is dynamic, expected at least one");
  complaint.vector("frame_a.p", def.frame_a.p);
  complaint.rotation("frame_a.q", def.frame_a.q);
  complaint.vector("frame_b.p", def.frame_b.p);
  complaint.rotation("frame_b.q", def.frame_b.q);
  complaint.not_negative("break_force", def.break_force);
  complaint.not_negative("break_torque", def.break_torque);
  check_joint<D>(complaint, def);
  if (!complaint.none_yet()) return complaint.error();

  def.frame_a.q = unit_rotation(def.frame_a.q);
  def.frame_b.q = unit_rotation(def.frame_b.q);
  JointStore<D>& joints = world.joints;
  const JointId id = joints.slots.allocate();
  const std::size_t slot = std::size_t(joints.slots.slot(id));
  if (slot >= joints.data.size()) {
    grow_by_a_quarter(joints.data);
    grow_by_a_quarter(joints.headers);
    joints.data.resize(slot + 1);
    joints.headers.resize(slot + 1);
  }
  JointData<D> data;
  data.birth = ++joints.births;
  if constexpr (mouse)
    data.world_anchor = def.target;
  else
    data.world_anchor = typename D::Position(def.frame_a.p);
  data.definition = def;
  if constexpr (std::is_same_v<Def, PathJointDef<D>>) add_knots(joints, data);
  joints.data[slot] = data;
  joints.headers[slot] = {};
  joints.headers[slot].body[0] = a;
  joints.headers[slot].body[1] = b;
  if (may_break(data.definition)) ++joints.breakable_count;
  joints.headers[slot].collide_connected = def.collide_connected || a == none;
  attach_joint(world, std::int32_t(slot));
  return id;
}

/// The joint's slot, for a handle that a user may hold.
template <class D>
Result<std::int32_t> find_joint(const WorldImplementation<D>& world, JointId joint, std::string_view call) {
  if (const Status s = world.joints.slots.check(joint, "joint"); !s.ok())
    return core::Error{core::text(call, ": ", s.error().message)};
  return std::int32_t(world.joints.slots.slot(joint));
}
/// After a change of its definition.
template <class D>
void wake_joint(WorldImplementation<D>& world, std::int32_t joint) {
  const AnyJointDef<D>& any = world.joints.data[std::size_t(joint)].definition;
  // Only these two may have become rigid, or no longer be.
  if (std::holds_alternative<DistanceJointDef<D>>(any) || std::holds_alternative<WeldJointDef<D>>(any))
    world.joints.trees.stale = true;
  for (const std::int32_t body : world.joints.headers[std::size_t(joint)].body)
    if (body != none && world.bodies.is_dynamic(body)) wake_body(world, body);
}
inline std::string_view joint_type_name(std::size_t index) {
  constexpr std::string_view names[] = {"distance", "ball", "hinge", "slider", "weld",   "motor", "mouse",
                                        "generic",  "gear", "rack",  "screw",  "pulley", "path"};
  return names[index];
}
inline core::Error wrong_joint(std::string_view call, std::size_t index, std::string_view expected) {
  return core::Error{core::text(call, ": the joint is a ", joint_type_name(index), " joint, expected ", expected)};
}

}  // namespace detail

template <class D>
Result<JointId> World<D>::create_joint(const DistanceJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const BallJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const HingeJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const SliderJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const WeldJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const MotorJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const MouseJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const GenericJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const GearJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const RackJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const ScrewJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}
template <class D>
Result<JointId> World<D>::create_joint(const PulleyJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}

template <class D>
Result<JointId> World<D>::create_joint(const PathJointDef<D>& d) {
  return detail::make_joint<D>(*self_, d);
}

template <class D>
Status World<D>::destroy_joint(JointId joint) {
  const auto slot = detail::find_joint<D>(*self_, joint, "World::destroy_joint");
  if (!slot.ok()) return slot.error();
  detail::release_joint<D>(*self_, *slot);
  return {};
}

template <class D>
bool World<D>::contains(JointId joint) const {
  return self_->joints.slots.contains(joint);
}

template <class D>
Result<JointState<D>> World<D>::joint_state(JointId joint) const {
  const auto slot = detail::find_joint<D>(*self_, joint, "World::joint_state");
  if (!slot.ok()) return slot.error();
  return detail::measure_joint<D>(*self_, *slot);
}

template <class D>
Result<AnyJointDef<D>> World<D>::joint_definition(JointId joint) const {
  const auto slot = detail::find_joint<D>(*self_, joint, "World::joint_definition");
  if (!slot.ok()) return slot.error();
  return detail::whole_definition(self_->joints, self_->joints.data[std::size_t(*slot)]);
}

template <class D>
Status World<D>::set_motor(JointId joint, const JointMotor& motor) {
  constexpr std::string_view call = "World::set_motor";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::Complaint complaint(call);
  complaint.motor("motor", motor);
  if (!complaint.none_yet()) return complaint.error();
  AnyJointDef<D>& any = self_->joints.data[std::size_t(*slot)].definition;
  if (auto* distance = std::get_if<DistanceJointDef<D>>(&any))
    distance->motor = motor;
  else if (auto* hinge = std::get_if<HingeJointDef<D>>(&any))
    hinge->motor = motor;
  else if (auto* slider = std::get_if<SliderJointDef<D>>(&any))
    slider->motor = motor;
  else if (auto* path = std::get_if<PathJointDef<D>>(&any))
    path->motor = motor;
  else
    return detail::wrong_joint(call, any.index(), "a distance, hinge, slider or path joint");
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_limit(JointId joint, const JointLimit& limit) {
  constexpr std::string_view call = "World::set_limit";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  AnyJointDef<D>& any = self_->joints.data[std::size_t(*slot)].definition;
  auto* distance = std::get_if<DistanceJointDef<D>>(&any);
  auto* ball = std::get_if<BallJointDef<D>>(&any);
  auto* hinge = std::get_if<HingeJointDef<D>>(&any);
  auto* slider = std::get_if<SliderJointDef<D>>(&any);
  auto* path = std::get_if<PathJointDef<D>>(&any);
  detail::Complaint complaint(call);
  if (distance != nullptr)
    complaint.distance_limit("limit", limit);
  else if (slider != nullptr || path != nullptr)
    complaint.limit("limit", limit);
  else
    complaint.angle_limit("limit", limit);
  if (path != nullptr && path->closed && limit.enabled)
    complaint.say("limit is enabled, expected none on a closed path");
  if (!complaint.none_yet()) return complaint.error();
  if (distance != nullptr)
    distance->limit = limit;
  else if (ball != nullptr)
    ball->twist = limit;
  else if (hinge != nullptr)
    hinge->limit = limit;
  else if (slider != nullptr)
    slider->limit = limit;
  else if (path != nullptr)
    path->limit = limit;
  else
    return detail::wrong_joint(call, any.index(), "a distance, ball (its twist), hinge, slider or path joint");
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_spring(JointId joint, const JointSpring& spring) {
  constexpr std::string_view call = "World::set_spring";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::Complaint complaint(call);
  complaint.spring("spring", spring);
  if (!complaint.none_yet()) return complaint.error();
  if (const std::size_t type = self_->joints.data[std::size_t(*slot)].definition.index();
      type >= std::size_t(JointType::generic) && type != std::size_t(JointType::path))
    return detail::wrong_joint(call, type, "one with a spring of its own (of a generic joint: set_axis)");
  std::visit(
      [&](auto& d) {
        if constexpr (requires { d.spring; }) {
          d.spring = spring;
        } else if constexpr (requires { d.angular.hertz; }) {  // weld and motor joints have two
          d.linear = spring;
          d.angular = spring;
        }
      },
      self_->joints.data[std::size_t(*slot)].definition);
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_axis(JointId joint, int axis, const JointAxis& settings) {
  constexpr std::string_view call = "World::set_axis";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  AnyJointDef<D>& any = self_->joints.data[std::size_t(*slot)].definition;
  auto* generic = std::get_if<GenericJointDef<D>>(&any);
  if (generic == nullptr) return detail::wrong_joint(call, any.index(), "a generic joint");
  constexpr int turning = D::dimension == 2 ? 1 : 3;
  if (axis < 0 || axis >= D::dimension + turning)
    return core::Error{core::text(call, ": axis is ", axis, ", expected 0 to ", D::dimension + turning - 1)};
  JointAxis& now = axis < D::dimension ? generic->linear[axis] : generic->angular[axis - D::dimension];
  detail::Complaint complaint(call);
  complaint.axis("settings", settings, axis >= D::dimension);
  if (settings.free != now.free)
    complaint.say(core::text("settings.free is ", settings.free ? "true" : "false", ", expected as it was made"));
  if (!complaint.none_yet()) return complaint.error();
  now = settings;
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_mouse_target(JointId joint, Position target) {
  constexpr std::string_view call = "World::set_mouse_target";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::Complaint complaint(call);
  complaint.vector("target", target);
  if (!complaint.none_yet()) return complaint.error();
  auto& data = self_->joints.data[std::size_t(*slot)];
  auto* mouse = std::get_if<MouseJointDef<D>>(&data.definition);
  if (mouse == nullptr) return detail::wrong_joint(call, data.definition.index(), "a mouse joint");
  if (mouse->target == target) return {};
  mouse->target = target;
  data.world_anchor = target;
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
void World<D>::joints(std::vector<JointId>& out) const {
  out.clear();
  const auto& joints = self_->joints;
  for (int slot = 0; slot < joints.slots.capacity(); ++slot)
    if (joints.slots.in_use(slot) && !joints.data[std::size_t(slot)].internal)
      out.push_back(joints.slots.handle_at(slot));
  std::sort(out.begin(), out.end(), [&](JointId a, JointId b) {
    return joints.data[std::size_t(joints.slots.slot(a))].birth < joints.data[std::size_t(joints.slots.slot(b))].birth;
  });
}

template <class D>
float World<D>::worst_joint_error() const {
  const auto& joints = self_->joints;
  float worst = 0;
  for (int slot = 0; slot < joints.slots.capacity(); ++slot)
    if (joints.slots.in_use(slot) && detail::joint_is_rigid<D>(joints.data[std::size_t(slot)].definition) &&
        !joints.data[std::size_t(slot)].internal)
      worst = max(worst, detail::measure_joint<D>(*self_, slot).linear_error);
  return worst;
}

}  // namespace carom::rigid
