// What joints are made of, and when they break.
#include "carom/rigid/detail/effector_act.h"
#include "carom/rigid/detail/joint_place.h"

namespace carom::rigid::detail {

template <class D>
void find_parts(JointData<D>& data) {
  const auto parts = [](const auto& d) -> int {
    using Def = std::remove_cvref_t<decltype(d)>;
    if constexpr (std::is_same_v<Def, DistanceJointDef<D>>) {
      return part_linear;
    } else if constexpr (std::is_same_v<Def, BallJointDef<D>>) {
      return part_pin | (d.spring.hertz > 0 ? part_angular : 0) | (d.friction_torque > 0 ? part_friction : 0) |
             (D::dimension == 3 && d.cone_angle >= 0 ? part_cone : 0) | (d.twist.enabled ? part_twist : 0);
    } else if constexpr (std::is_same_v<Def, HingeJointDef<D>>) {
      return part_pin | (D::dimension == 3 ? part_hinge : 0) |
             (axis_is_used(d.spring, d.motor, d.limit) ? part_twist : 0);
    } else if constexpr (std::is_same_v<Def, SliderJointDef<D>>) {
      return part_slide | part_angular | (axis_is_used(d.spring, d.motor, d.limit) ? part_linear : 0);
    } else if constexpr (std::is_same_v<Def, MouseJointDef<D>>) {
      return part_point | (d.spring.hertz > 0 ? part_angular : 0);
    } else if constexpr (std::is_same_v<Def, WeldJointDef<D>>) {
      return (d.linear.hertz > 0 ? part_point : part_pin) | part_angular;
    } else if constexpr (std::is_same_v<Def, GenericJointDef<D>>) {
      int all = 0;
      for (int i = 0; i < D::dimension; ++i)
        if (acts(d.linear[i])) all |= linear_part(i);
      for (int i = 0; i < (D::dimension == 2 ? 1 : 3); ++i)
        if (acts(d.angular[i])) all |= turn_part(i);
      return all;
    } else if constexpr (std::is_same_v<Def, MotorJointDef<D>>) {
      return part_point | part_angular;
    } else if constexpr (std::is_same_v<Def, PathJointDef<D>>) {
      return part_path | (!d.closed || d.friction > 0 || axis_is_used(d.spring, d.motor, d.limit) ? part_along : 0);
    } else {
      return part_coupling;
    }
  };
  data.parts = std::uint32_t(data.visit(parts)) & 0xFFFFFFu;
}

template <class D>
bool is_rod(const JointData<D>& data) {
  const auto* d = data.template get<DistanceJointDef>();
  return d != nullptr && !data.internal && !d->rope && !axis_is_used(d->spring, d->motor, d->limit);
}
template <class D>
bool turns_rigidly(const JointData<D>& data) {
  if (const auto* weld = data.template get<WeldJointDef>()) return !(weld->angular.hertz > 0);
  return data.type == JointType::slider;
}
template <class D>
bool holds_axes(const JointData<D>& data) {
  const auto* d = data.template get<GenericJointDef>();
  if (d == nullptr) return false;
  for (const JointAxis& axis : d->linear)
    if (!axis.free) return true;
  for (const JointAxis& axis : d->angular)
    if (!axis.free) return true;
  return false;
}

template <class D>
bool is_springy(const JointData<D>& data) {
  if (data.internal) return true;
  return data.visit([](const auto& d) {
    using Def = std::remove_cvref_t<decltype(d)>;
    if constexpr (std::is_same_v<Def, WeldJointDef<D>>) {
      return d.linear.hertz > 0 || d.angular.hertz > 0;
    } else if constexpr (std::is_same_v<Def, MotorJointDef<D>> || std::is_same_v<Def, MouseJointDef<D>>) {
      return true;
    } else if constexpr (std::is_same_v<Def, GenericJointDef<D>>) {
      for (const JointAxis& axis : d.linear)
        if (axis.free && axis.spring.hertz > 0) return true;
      for (const JointAxis& axis : d.angular)
        if (axis.free && axis.spring.hertz > 0) return true;
      return false;
    } else if constexpr (requires { d.spring; }) {
      return d.spring.hertz > 0;
    } else {
      return false;
    }
  });
}

template <class D>
void test_joints(WorldImplementation<D>& world) {
  JointStore<D>& joints = world.joints;
  if (joints.breakable_count == 0) return;
  const auto test = [&](std::int32_t joint) {
    const JointData<D>& data = joints.at(joint);
    const JointFrames<D>& frames = data.frames();
    const auto above = [](float x, float limit) { return limit > 0 && x > limit; };
    if (!above(math::length(data.force), frames.break_force) && !above(magnitude(data.torque), frames.break_torque))
      return;
    if (!data.internal) {
      world.scratch.joint_break.push_back(
          {joints.slots.handle_at(joint), frames.body_a, frames.body_b, data.force, data.torque});
      return;
    }
    // A spring's own: the force on its A, which is the joint's B where its other end is in the world.
    for (const std::int32_t slot : world.effectors.in_order) {
      const EffectorData<D>& effector = world.effectors.data[std::size_t(slot)];
      if (effector.joint != joint) continue;
      const auto& spring = std::get<SpringDamper<D>>(effector.definition);
      world.scratch.spring_break.push_back({world.effectors.slots.handle_at(slot), spring.body_a, spring.body_b,
                                            spring.body_b.is_null() ? data.force : -data.force});
    }
  };
  for (const std::int32_t joint : joints.order) test(joint);
  for (const std::int32_t joint : joints.pins)
    if (joint != none) test(joint);
  for (const auto& limb : joints.limbs)
    if (limb.joint != none) test(limb.joint);
}
template <class D>
void break_joints(WorldImplementation<D>& world) {
  for (const JointBreakEvent<D>& event : world.scratch.joint_break)
    if (world.joints.slots.contains(event.joint))
      release_joint(world, std::int32_t(world.joints.slots.slot(event.joint)));
  for (const SpringBreakEvent<D>& event : world.scratch.spring_break)
    if (world.effectors.slots.contains(event.spring))
      release_effector(world, std::int32_t(world.effectors.slots.slot(event.spring)));
}

template void find_parts(JointData<Dim2>&);
template void find_parts(JointData<Dim3>&);
template bool is_rod(const JointData<Dim2>&);
template bool is_rod(const JointData<Dim3>&);
template bool turns_rigidly(const JointData<Dim2>&);
template bool turns_rigidly(const JointData<Dim3>&);
template bool holds_axes(const JointData<Dim2>&);
template bool holds_axes(const JointData<Dim3>&);
template bool is_springy(const JointData<Dim2>&);
template bool is_springy(const JointData<Dim3>&);
template void test_joints(WorldImplementation<Dim2>&);
template void test_joints(WorldImplementation<Dim3>&);
template void break_joints(WorldImplementation<Dim2>&);
template void break_joints(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
