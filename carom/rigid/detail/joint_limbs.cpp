// Limbs side by side (joint_limb_lanes.h): who they are, and their way into the blocks and back.
#include "carom/rigid/detail/joint_place.h"

namespace carom::rigid::detail {
namespace {

constexpr std::uint32_t limb_mask2 = part_pin | part_twist;
constexpr std::uint32_t limb_mask3 = part_pin | part_friction | part_cone | part_twist | part_angular | part_hinge;

template <std::size_t N, int W, class V>
void set_lane(float (&lanes)[N][W], int lane, const V& v) {
  for (std::size_t i = 0; i < N; ++i) lanes[i][lane] = v[int(i)];
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
Vec3f lane_value(const float (&lanes)[3][W], int lane) {
  return {lanes[0][lane], lanes[1][lane], lanes[2][lane]};
}
template <int W>
Vec2f lane_value(const float (&lanes)[2][W], int lane) {
  return {lanes[0][lane], lanes[1][lane]};
}

template <int W>
void put_law(LawLanes<W>& out, int lane, const AxisLaw& law) {
  const bool spring = law.has(AxisLaw::spring);
  out.rest[lane] = law.rest;
  out.velocity[lane] = spring ? law.response.velocity : 0;
  out.position[lane] = spring ? law.response.position : 0;
  out.memory[lane] = spring ? law.response.memory : 1;
  out.previous[lane] = spring ? law.response.previous : 0;
  out.before[lane] = law.before;
  out.spring[lane] = law.spring_impulse;
  out.max_spring[lane] = law.max_spring_impulse > 0 ? law.max_spring_impulse : 1e30f;
  out.speed[lane] = law.speed;
  out.max_motor[lane] = law.has(AxisLaw::motor) ? law.max_motor_impulse : 0;
  out.motor[lane] = law.motor_impulse;
  // What is not limited is far from a stop on either side.
  const bool limited = law.has(AxisLaw::lower);
  out.low[lane] = limited ? law.low : -1e30f;
  out.high[lane] = limited ? law.high : 1e30f;
  out.lower.impulse[lane] = law.lower_impulse;
  out.upper.impulse[lane] = law.upper_impulse;
}
template <int W>
void take_law(const LawLanes<W>& law, int lane, auto& memory) {
  memory.spring = law.spring[lane];
  memory.motor = law.motor[lane];
  memory.lower = law.lower.impulse[lane];
  memory.upper = law.upper.impulse[lane];
}

template <int W>
void fill_block(LimbLanes<Dim2, W>& out, int lane, JointPart, const PinBlock<Dim2>& pin) {
  set_lane(out.arm_a, lane, pin.arm_a);
  set_lane(out.arm_b, lane, pin.arm_b);
  set_lane(out.offset, lane, pin.offset);
  set_lane(out.impulse, lane, pin.impulse);
}
template <int W>
void fill_block(LimbLanes<Dim2, W>& out, int lane, JointPart, const AngularAxis<Dim2>& axis) {
  const Rot2f frame = conjugate(axis.frame_a) * axis.frame_b;
  out.frame[0][lane] = frame.c;
  out.frame[1][lane] = frame.s;
  put_law(out.law, lane, axis.law);
}
template <int W>
void fill_block(LimbLanes<Dim3, W>& out, int lane, JointPart, const PinBlock<Dim3>& pin) {
  set_lane(out.arm_a, lane, pin.arm_a);
  set_lane(out.arm_b, lane, pin.arm_b);
  set_lane(out.offset, lane, pin.offset);
  set_lane(out.impulse, lane, pin.impulse);
}
template <int W>
void fill_block(LimbLanes<Dim3, W>& out, int lane, JointPart part, const AngularAxis<Dim3>& axis) {
  if (part == part_twist) return put_law(out.law, lane, axis.law);
  out.cone_angle[lane] = axis.law.high;
  out.cone.impulse[lane] = axis.law.upper_impulse;
}
template <int W>
void fill_block(LimbLanes<Dim3, W>& out, int lane, JointPart part, const AngularBlock<Dim3>& turn) {
  if (part == part_friction) {
    set_lane(out.friction, lane, turn.impulse);
    out.max_friction[lane] = turn.max_impulse;
    return;
  }
  set_lane(out.spring, lane, turn.impulse);
  set_lane(out.before, lane, turn.before);
  out.velocity[lane] = turn.response.velocity;
  out.position[lane] = turn.response.position;
  out.memory[lane] = turn.response.memory;
  out.previous[lane] = turn.response.previous;
}
template <int W>
void fill_block(LimbLanes<Dim3, W>& out, int lane, JointPart, const HingeBlock& hinge) {
  set_lane(out.hinge, lane, hinge.impulse);
}

template <class D, int W>
void fill_lane(LimbLanes<D, W>& out, int lane, std::int32_t joint, const WorldImplementation<D>& world, float h) {
  out.joint[lane] = joint;
  out.read_a[lane] = out.read_b[lane] = out.write_a[lane] = out.write_b[lane] = none;
  if (joint == none) return;
  constexpr std::uint32_t most = D::dimension == 2 ? limb_mask2 : limb_mask3;
  constexpr std::size_t size = 16 * std::size_t(record_units<D>(most, D::dimension == 2));
  alignas(16) unsigned char bytes[size];
  auto& record = *::new (static_cast<void*>(bytes)) JointRecord<D>{};
  record.joint = joint;
  record.isotropic = D::dimension == 2;
  record.parts = out.parts & most;
  fill_record(record, world, h);
  out.read_a[lane] = record.body_a;
  out.read_b[lane] = record.body_b;
  out.write_a[lane] = record.dynamic_a ? record.body_a : none;
  out.write_b[lane] = record.dynamic_b ? record.body_b : none;
  out.inverse_mass_a[lane] = record.inverse_mass_a;
  out.inverse_mass_b[lane] = record.inverse_mass_b;
  if constexpr (D::dimension == 2) {
    out.inverse_inertia_a[lane] = record.inverse_inertia_a;
    out.inverse_inertia_b[lane] = record.inverse_inertia_b;
  } else {
    set_lane(out.start_tensor_a, lane, record.tensors()[0]);
    set_lane(out.start_tensor_b, lane, record.tensors()[1]);
    const JointPlacement<D> at =
        place_joint(world.bodies, world.joints.headers[std::size_t(joint)], world.joints.at(joint));
    if (out.parts & limb_is_aimed)
      set_lane(out.aim, lane, world.joints.at(joint).template get<BallJointDef>()->target_rotation);
    set_lane(out.frame_a, lane, at.frame_a);
    set_lane(out.frame_b, lane, at.frame_b);
  }
  for_each_block(record, [&](JointPart part, auto& block) {
    if constexpr (requires { fill_block(out, lane, part, block); }) fill_block(out, lane, part, block);
  });
}

template <int W>
void take_lane(const LimbLanes<Dim2, W>& block, int lane, JointMemory<Dim2>& memory) {
  memory.point = lane_value(block.impulse, lane);
  take_law(block.law, lane, memory.turn[0]);
}
template <int W>
void take_lane(const LimbLanes<Dim3, W>& block, int lane, JointMemory<Dim3>& memory) {
  memory.point = lane_value(block.impulse, lane);
  memory.friction = lane_value(block.friction, lane);
  memory.angular = lane_value(block.spring, lane);
  memory.hinge = lane_value(block.hinge, lane);
  memory.turn[0] = {};
  memory.turn[0].upper = block.cone.impulse[lane];
  take_law(block.law, lane, memory.turn[1]);
}

/// Does a lock keep one of the bodies from turning about some axis? Then its tensor must not be turned.
template <class D>
bool turning_is_locked(const WorldImplementation<D>& world, std::int32_t joint) {
  constexpr std::uint8_t turning_locks = 56;
  for (const std::int32_t body : world.joints.headers[std::size_t(joint)].body)
    if (body != none && (world.bodies.record[std::size_t(body)].locks & turning_locks) != 0) return true;
  return false;
}

}  // namespace

template <class D>
std::uint32_t limb_parts(const WorldImplementation<D>& world, std::int32_t joint) {
  constexpr std::uint32_t mask = D::dimension == 2 ? limb_mask2 : limb_mask3;
  const JointData<D>& data = world.joints.at(joint);
  const std::uint32_t parts = data.parts;
  if ((parts & part_pin) == 0 || (parts & ~mask) != 0 || world.joints.tree_of(joint) != none) return 0;
  if (D::dimension == 3 && turning_is_locked(world, joint)) return 0;
  if ((parts & part_angular) == 0) return parts;
  const auto* ball = data.template get<BallJointDef>();
  const bool aimed = ball != nullptr && !(ball->target_rotation == typename D::Rotation{});
  return parts | (turns_rigidly(data) ? limb_is_stiff : 0) | (aimed ? limb_is_aimed : 0);
}

template <class D>
LimbKernels<D> limb_kernels_of(int width) {
#if defined(__x86_64__)
  if (width == 16) {
    if constexpr (D::dimension == 2)
      return pin_kernels_avx512::limb_kernels2();
    else
      return pin_kernels_avx512::limb_kernels3();
  }
  if (width == 8) {
    if constexpr (D::dimension == 2)
      return pin_kernels_avx2::limb_kernels2();
    else
      return pin_kernels_avx2::limb_kernels3();
  }
#else
  (void)width;
#endif
  if constexpr (D::dimension == 2)
    return pin_kernels_baseline::limb_kernels2();
  else
    return pin_kernels_baseline::limb_kernels3();
}

template <class D>
void prepare_limbs(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(joints.pin_kernels.width, [&]<int W>() {
    const int count = int(joints.limbs.size()) / W;
    if (count == 0) return;
    const auto blocks = context.arena.template allocate<LimbLanes<D, W>>(std::size_t(count));
    joints.limb_blocks = blocks.data();
    context.scheduler.parallel_for(count, 4, [&](int begin, int end, int) {
      for (int b = begin; b < end; ++b) {
        LimbLanes<D, W>& block = *::new (static_cast<void*>(&blocks[std::size_t(b)])) LimbLanes<D, W>{};
        block.parts = joints.limbs[std::size_t(b) * W].parts;
        for (int lane = 0; lane < W; ++lane)
          fill_lane(block, lane, joints.limbs[std::size_t(b) * W + std::size_t(lane)].joint, context.world, context.h);
      }
      joints.limb_kernels.place(context.bodies, joints.limb_blocks, begin, end);
    });
  });
}

template <class D>
void store_limbs(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(joints.pin_kernels.width, [&]<int W>() {
    const auto* const blocks = static_cast<const LimbLanes<D, W>*>(joints.limb_blocks);
    context.scheduler.parallel_for(int(joints.limbs.size()) / W, 4, [&](int begin, int end, int) {
      for (int b = begin; b < end; ++b)
        for (int lane = 0; lane < W; ++lane) {
          if (blocks[b].joint[lane] == none) continue;
          JointData<D>& data = joints.at(blocks[b].joint[lane]);
          take_lane(blocks[b], lane, data.memory);
          data.force = data.memory.point * context.inverse_h;
          if constexpr (D::dimension == 2)
            data.torque = blocks[b].turn_impulse[lane] * context.inverse_h;
          else
            data.torque = lane_value(blocks[b].turn_impulse, lane) * context.inverse_h;
        }
    });
  });
}

template std::uint32_t limb_parts(const WorldImplementation<Dim2>&, std::int32_t);
template std::uint32_t limb_parts(const WorldImplementation<Dim3>&, std::int32_t);
template LimbKernels<Dim2> limb_kernels_of(int);
template LimbKernels<Dim3> limb_kernels_of(int);
template void prepare_limbs(StepContext<Dim2>&);
template void prepare_limbs(StepContext<Dim3>&);
template void store_limbs(StepContext<Dim2>&);
template void store_limbs(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
