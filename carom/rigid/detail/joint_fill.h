// How joints come into lanes (joint_lanes.h, joint_limb_lanes.h): one lane's numbers, from the bodies and the
// definition.
#pragma once

#include "carom/rigid/detail/joint_place.h"

namespace carom::rigid::detail {

template <std::size_t N, int W, class V>
void set_lane(float (&lanes)[N][W], int lane, const V& v) {
  for (std::size_t i = 0; i < N; ++i) lanes[i][lane] = v[int(i)];
}
template <int W>
void set_lane(float (&lanes)[2][W], int lane, const Rot2f& q) {
  lanes[0][lane] = q.c;
  lanes[1][lane] = q.s;
}
template <int W>
void set_lane(float (&lanes)[4][W], int lane, const Quatf& q) {
  lanes[0][lane] = q.w;
  for (int i = 0; i < 3; ++i) lanes[i + 1][lane] = q.vector()[i];
}
template <int W>
void set_lane(float (&lanes)[6][W], int lane, const Mat3f& m) {
  const float t[6] = {m.cx.x, m.cx.y, m.cx.z, m.cy.y, m.cy.z, m.cz.z};
  for (int i = 0; i < 6; ++i) lanes[i][lane] = t[i];
}
template <int W>
void set_lane(float (&lanes)[W], int lane, float v) {
  lanes[lane] = v;
}
/// Of a body that turns alike about every axis.
template <int W>
void set_lane(float (&lanes)[W], int lane, const Mat3f& m) {
  lanes[lane] = m.cx.x;
}

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
    const BodyMotion<D>& motion = bodies.motion[std::size_t(body)];
    const float share = load_share(motion);
    mass[lane] = motion.inverse_mass * share;
    set_lane(inertia, lane, motion.world_inverse_inertia * share);
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
