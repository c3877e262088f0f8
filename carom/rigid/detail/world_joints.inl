// World's members about joints.
#pragma once

#include <algorithm>

#include "carom/rigid/detail/check.h"
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
  if constexpr (requires { def.target_rotation; }) def.target_rotation = unit_rotation(def.target_rotation);
  JointStore<D>& joints = world.joints;
  const JointId id = joints.slots.allocate();
  const std::int32_t slot = joints.slots.slot(id);
  JointData<D>& data = joints.make(slot, def);
  if constexpr (std::is_same_v<Def, PathJointDef<D>>) add_knots(joints, data);
  JointHeader& header = joints.headers[std::size_t(slot)];
  header.body[0] = a;
  header.body[1] = b;
  header.collide_connected = def.collide_connected || a == none;
  find_parts(data);
  if (may_break(data.frames())) ++joints.breakable_count;
  attach_joint(world, slot);
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
  // Only these two may have become rigid, or no longer be.
  find_parts(world.joints.at(joint));
  const JointType type = world.joints.at(joint).type;
  if (type == JointType::distance || type == JointType::weld) world.joints.trees.stale = true;
  for (const std::int32_t body : world.joints.headers[std::size_t(joint)].body)
    if (body != none && world.bodies.is_dynamic(body)) wake_body(world, body);
}
inline std::string_view joint_type_name(std::size_t index) {
  constexpr std::string_view names[] = {"distance", "ball", "hinge", "slider", "weld",   "motor", "mouse",
                                        "generic",  "gear", "rack",  "screw",  "pulley", "path"};
  return names[index];
}
inline core::Error wrong_joint(std::string_view call, JointType type, std::string_view expected) {
  return core::Error{
      core::text(call, ": the joint is a ", joint_type_name(std::size_t(type)), " joint, expected ", expected)};
}

/// What a setter did with the definition of a joint.
enum class Change : std::uint8_t { wrong_type, none, made };
template <class T>
Change give(T& field, const T& value) {
  if (field == value) return Change::none;
  field = value;
  return Change::made;
}
inline Change both(Change a, Change b) { return std::max(a, b); }

/// change(definition) is called with what is known to be right but for the joint's type.
template <class D, class F>
Status change_joint(WorldImplementation<D>& world, JointId joint, std::string_view call, const Complaint& complaint,
                    std::string_view expected, F&& change) {
  const auto slot = find_joint<D>(world, joint, call);
  if (!slot.ok()) return slot.error();
  if (!complaint.none_yet()) return complaint.error();
  JointData<D>& any = world.joints.at(*slot);
  const bool broke = may_break(any.frames());
  const Change done =
      any.visit([&](const auto& def) { return change(const_cast<std::remove_cvref_t<decltype(def)>&>(def)); });
  if (done == Change::wrong_type) return wrong_joint(call, any.type, expected);
  if (done == Change::none) return {};
  world.joints.breakable_count += int(may_break(any.frames())) - int(broke);
  wake_joint<D>(world, *slot);
  return {};
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
  return detail::whole_definition(self_->joints, self_->joints.at(*slot));
}

template <class D>
Status World<D>::set_motor(JointId joint, const JointMotor& motor) {
  constexpr std::string_view call = "World::set_motor";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::Complaint complaint(call);
  complaint.motor("motor", motor);
  if (!complaint.none_yet()) return complaint.error();
  detail::JointData<D>& any = self_->joints.at(*slot);
  if (auto* distance = any.template get<DistanceJointDef>())
    distance->motor = motor;
  else if (auto* hinge = any.template get<HingeJointDef>())
    hinge->motor = motor;
  else if (auto* slider = any.template get<SliderJointDef>())
    slider->motor = motor;
  else if (auto* path = any.template get<PathJointDef>())
    path->motor = motor;
  else
    return detail::wrong_joint(call, any.type, "a distance, hinge, slider or path joint");
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_limit(JointId joint, const JointLimit& limit) {
  constexpr std::string_view call = "World::set_limit";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::JointData<D>& any = self_->joints.at(*slot);
  auto* distance = any.template get<DistanceJointDef>();
  auto* ball = any.template get<BallJointDef>();
  auto* hinge = any.template get<HingeJointDef>();
  auto* slider = any.template get<SliderJointDef>();
  auto* path = any.template get<PathJointDef>();
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
    return detail::wrong_joint(call, any.type, "a distance, ball (its twist), hinge, slider or path joint");
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
  detail::JointData<D>& any = self_->joints.at(*slot);
  if (any.type >= JointType::generic && any.type != JointType::path)
    return detail::wrong_joint(call, any.type, "one with a spring of its own (of a generic joint: set_axis)");
  any.visit([&](const auto& def) {
    auto& d = const_cast<std::remove_cvref_t<decltype(def)>&>(def);
    if constexpr (requires { d.spring; }) {
      d.spring = spring;
    } else if constexpr (requires { d.angular.hertz; }) {  // weld and motor joints have two
      d.linear = spring;
      d.angular = spring;
    }
  });
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_axis(JointId joint, int axis, const JointAxis& settings) {
  constexpr std::string_view call = "World::set_axis";
  const auto slot = detail::find_joint<D>(*self_, joint, call);
  if (!slot.ok()) return slot.error();
  detail::JointData<D>& any = self_->joints.at(*slot);
  auto* generic = any.template get<GenericJointDef>();
  if (generic == nullptr) return detail::wrong_joint(call, any.type, "a generic joint");
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
  auto& data = self_->joints.at(*slot);
  auto* mouse = data.template get<MouseJointDef>();
  if (mouse == nullptr) return detail::wrong_joint(call, data.type, "a mouse joint");
  if (mouse->target == target) return {};
  mouse->target = target;
  detail::wake_joint<D>(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_spring_target(JointId joint, float target) {
  constexpr std::string_view call = "World::set_spring_target";
  detail::Complaint complaint(call);
  complaint.finite("target", target);
  return detail::change_joint(*self_, joint, call, complaint, "a hinge, slider or path joint", [&](auto& d) {
    if constexpr (requires { d.target_angle; })
      return detail::give(d.target_angle, target);
    else if constexpr (requires { d.target_translation; })
      return detail::give(d.target_translation, target);
    else if constexpr (requires { d.target_distance; })
      return detail::give(d.target_distance, target);
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_max_spring_force(JointId joint, float most) {
  constexpr std::string_view call = "World::set_max_spring_force";
  detail::Complaint complaint(call);
  complaint.not_negative("most", most);
  return detail::change_joint(*self_, joint, call, complaint, "a hinge, slider or path joint", [&](auto& d) {
    if constexpr (requires { d.max_spring_torque; })
      return detail::give(d.max_spring_torque, most);
    else if constexpr (requires { d.max_spring_force; })
      return detail::give(d.max_spring_force, most);
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_target_rotation(JointId joint, Rotation target) {
  constexpr std::string_view call = "World::set_target_rotation";
  detail::Complaint complaint(call);
  complaint.rotation("target", target);
  return detail::change_joint(*self_, joint, call, complaint, "a ball or motor joint", [&](auto& d) {
    if constexpr (requires { d.target_rotation; })
      return detail::give(d.target_rotation, detail::unit_rotation(target));
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_target_pose(JointId joint, Vector position, Rotation rotation) {
  constexpr std::string_view call = "World::set_target_pose";
  detail::Complaint complaint(call);
  detail::check_size(complaint, "position", position, detail::max_size);
  complaint.rotation("rotation", rotation);
  return detail::change_joint(*self_, joint, call, complaint, "a motor joint", [&](auto& d) {
    if constexpr (requires { d.target_position; })
      return detail::both(detail::give(d.target_position, position),
                          detail::give(d.target_rotation, detail::unit_rotation(rotation)));
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_target_velocity(JointId joint, Vector velocity, Angular spin) {
  constexpr std::string_view call = "World::set_target_velocity";
  detail::Complaint complaint(call);
  detail::check_size(complaint, "velocity", velocity, detail::max_velocity);
  detail::check_size(complaint, "spin", spin, detail::max_velocity);
  return detail::change_joint(*self_, joint, call, complaint, "a motor joint", [&](auto& d) {
    if constexpr (requires { d.target_velocity; })
      return detail::both(detail::give(d.target_velocity, velocity), detail::give(d.target_spin, spin));
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_hold(JointId joint, bool position, bool rotation) {
  constexpr std::string_view call = "World::set_hold";
  return detail::change_joint(*self_, joint, call, detail::Complaint(call), "a motor joint", [&](auto& d) {
    if constexpr (requires { d.hold_position; })
      return detail::both(detail::give(d.hold_position, position), detail::give(d.hold_rotation, rotation));
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_max_force(JointId joint, float force, float torque) {
  constexpr std::string_view call = "World::set_max_force";
  detail::Complaint complaint(call);
  complaint.not_negative("force", force);
  complaint.not_negative("torque", torque);
  if (const auto slot = detail::find_joint<D>(*self_, joint, call);
      slot.ok() && self_->joints.at(*slot).type == JointType::mouse && torque != 0)
    complaint.say(core::refused("torque", torque, "0 for a mouse joint"));
  return detail::change_joint(*self_, joint, call, complaint, "a motor or mouse joint", [&](auto& d) {
    if constexpr (requires { d.max_torque; })
      return detail::both(detail::give(d.max_force, force), detail::give(d.max_torque, torque));
    else if constexpr (requires { d.max_force; })
      return detail::give(d.max_force, force);
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_length(JointId joint, float length) {
  constexpr std::string_view call = "World::set_length";
  detail::Complaint complaint(call);
  complaint.not_negative("length", length);
  return detail::change_joint(*self_, joint, call, complaint, "a distance or pulley joint", [&](auto& d) {
    if constexpr (requires { d.length; })
      return detail::give(d.length, length);
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_cone_angle(JointId joint, float angle) {
  constexpr std::string_view call = "World::set_cone_angle";
  detail::Complaint complaint(call);
  complaint.cone_angle("angle", angle, D::dimension == 2);
  return detail::change_joint(*self_, joint, call, complaint, "a ball joint", [&](auto& d) {
    if constexpr (requires { d.cone_angle; })
      return detail::give(d.cone_angle, angle);
    else
      return detail::Change::wrong_type;
  });
}

template <class D>
Status World<D>::set_friction(JointId joint, float friction) {
  constexpr std::string_view call = "World::set_friction";
  detail::Complaint complaint(call);
  complaint.not_negative("friction", friction);
  return detail::change_joint(*self_, joint, call, complaint, "a ball or path joint (others: a motor at speed 0)",
                              [&](auto& d) {
                                if constexpr (requires { d.friction_torque; })
                                  return detail::give(d.friction_torque, friction);
                                else if constexpr (requires { d.friction; })
                                  return detail::give(d.friction, friction);
                                else
                                  return detail::Change::wrong_type;
                              });
}

template <class D>
Status World<D>::set_break_force(JointId joint, float force, float torque) {
  constexpr std::string_view call = "World::set_break_force";
  detail::Complaint complaint(call);
  complaint.not_negative("force", force);
  complaint.not_negative("torque", torque);
  return detail::change_joint(*self_, joint, call, complaint, "any", [&](auto& d) {
    return detail::both(detail::give(d.break_force, force), detail::give(d.break_torque, torque));
  });
}

template <class D>
void World<D>::joints(std::vector<JointId>& out) const {
  out.clear();
  const auto& joints = self_->joints;
  for (int slot = 0; slot < joints.slots.capacity(); ++slot)
    if (joints.slots.in_use(slot) && !joints.at(slot).internal) out.push_back(joints.slots.handle_at(slot));
  std::sort(out.begin(), out.end(), [&](JointId a, JointId b) {
    return joints.at(joints.slots.slot(a)).birth < joints.at(joints.slots.slot(b)).birth;
  });
}

template <class D>
float World<D>::worst_joint_error() const {
  const auto& joints = self_->joints;
  float worst = 0;
  for (int slot = 0; slot < joints.slots.capacity(); ++slot)
    if (joints.slots.in_use(slot) && detail::joint_is_rigid<D>(joints.at(slot)) && !joints.at(slot).internal)
      worst = max(worst, detail::measure_joint<D>(*self_, slot).linear_error);
  return worst;
}

}  // namespace carom::rigid
