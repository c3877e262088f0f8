// How joints come into lanes (joint_lanes.h, joint_limb_lanes.h): one lane's numbers, from the bodies and the
// definition.
#pragma once

#include "carom/rigid/detail/joint_place.h"
#include "carom/rigid/detail/set_lane.h"

namespace carom::rigid::detail {

/// Whom the joint reads and writes, masses, impulse, and the arms, these in the frames of their bodies. Lanes without a
/// joint are left as they are but for their bodies.
template <class D, int W, class Lanes>
void put_joint(Lanes& out, BodyTurns<D, W>& turns, auto& inertia_a, auto& inertia_b, int lane, std::int32_t joint,
               const WorldImplementation<D>& world) {
  out.joint[lane] = joint;
  out.read_a[lane] = out.read_b[lane] = out.write_a[lane] = out.write_b[lane] = none;
  if (joint == none) return;
  const BodyStore<D>& bodies = world.bodies;
  const JointHeader& header = world.joints.headers[std::size_t(joint)];
  const JointData<D>& data = world.joints.at(joint);
  const JointFrames<D>& frames = data.frames();
  const std::int32_t a = header.body[0], b = header.body[1];
  const auto put = [&](std::int32_t body, std::int32_t(&read)[W], std::int32_t(&write)[W], float(&mass)[W],
                       auto& inertia, auto& rotation) {
    read[lane] = body;
    set_lane(rotation, lane, bodies.pose[std::size_t(body)].rotation);
    if (!bodies.is_dynamic(body)) return;
    write[lane] = body;
    mass[lane] = bodies.motion[std::size_t(body)].inverse_mass;
    set_lane(inertia, lane, bodies.motion[std::size_t(body)].world_inverse_inertia);
  };
  put(b, out.read_b, out.write_b, out.inverse_mass_b, inertia_b, turns.b);
  const BodyMotion<D>& motion_b = bodies.motion[std::size_t(b)];
  set_lane(out.arm_b, lane, frames.frame_b.p - motion_b.local_center);
  if (a != none) {
    put(a, out.read_a, out.write_a, out.inverse_mass_a, inertia_a, turns.a);
    const BodyMotion<D>& motion_a = bodies.motion[std::size_t(a)];
    set_lane(out.arm_a, lane, frames.frame_a.p - motion_a.local_center);
    set_lane(out.offset, lane, typename D::Vector(motion_b.center - motion_a.center));
  } else {
    set_lane(turns.a, lane, typename D::Rotation{});
    set_lane(out.offset, lane, typename D::Vector(motion_b.center - data.world_anchor()));
  }
  set_lane(out.impulse, lane, data.memory.point);
}

}  // namespace carom::rigid::detail
