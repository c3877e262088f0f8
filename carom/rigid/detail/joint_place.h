// Where joints are when a step begins, and what of them acts.
#pragma once

#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

/// Calls f.operator()<W>() for the width of the kernels.
template <class F>
void for_width(int width, F&& f) {
  if (width == 16) return f.template operator()<16>();
  if (width == 8) return f.template operator()<8>();
  f.template operator()<4>();
}

/// Is there anything on this coordinate of a generic joint?
inline bool acts(const JointAxis& axis) {
  return !axis.free || axis.spring.hertz > 0 || axis.limit.enabled || axis.motor.enabled || axis.friction > 0;
}
inline bool axis_is_used(const JointSpring& spring, const JointMotor& motor, const JointLimit& limit) {
  return spring.hertz > 0 || motor.enabled || limit.enabled;
}

/// Where the two bodies and the joint's frames are when the step begins.
template <class D>
struct JointPlacement {
  typename D::Position center_a{};
  typename D::Vector arm_a{}, arm_b{}, offset{};
  typename D::Rotation frame_a{}, frame_b{};
};

template <class D>
JointPlacement<D> place_joint(const BodyStore<D>& bodies, const JointHeader& header, const JointData<D>& data) {
  const JointFrames<D>& frames = data.frames();
  JointPlacement<D> at;
  typename D::Position center_a{};
  if (header.body[0] != none) {
    const std::size_t a = std::size_t(header.body[0]);
    const auto rotation = bodies.pose[a].rotation;
    at.arm_a = rotate(rotation, frames.frame_a.p - bodies.motion[a].local_center);
    at.frame_a = rotation * frames.frame_a.q;
    center_a = bodies.motion[a].center;
  } else {
    center_a = data.world_anchor();
    at.frame_a = frames.frame_a.q;
  }
  const std::size_t b = std::size_t(header.body[1]);
  const auto rotation = bodies.pose[b].rotation;
  at.arm_b = rotate(rotation, frames.frame_b.p - bodies.motion[b].local_center);
  at.frame_b = rotation * frames.frame_b.q;
  at.offset = typename D::Vector(bodies.motion[b].center - center_a);
  at.center_a = center_a;
  return at;
}

/// Axis i of a frame.
template <class D>
typename D::Vector axis_of(const typename D::Rotation& q, int i) {
  typename D::Vector axis{};
  axis[i] = 1;
  return rotate(q, axis);
}

/// Do both bodies turn alike about every axis?
template <class D>
bool is_isotropic(const WorldImplementation<D>& world, std::int32_t joint) {
  if constexpr (D::dimension == 2) return true;
  constexpr std::uint8_t turning_locks = 56;
  for (const std::int32_t body : world.joints.headers[std::size_t(joint)].body) {
    if (body == none || !world.bodies.is_dynamic(body)) continue;
    if (world.bodies.motion[std::size_t(body)].gyroscopic ||
        (world.bodies.record[std::size_t(body)].locks & turning_locks) != 0)
      return false;
  }
  return true;
}

}  // namespace carom::rigid::detail
