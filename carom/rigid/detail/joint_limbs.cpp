// Limbs side by side (joint_limb_lanes.h): who they are, and their way into the blocks and back.
#include "carom/rigid/detail/joint_fill.h"
#include "carom/rigid/detail/joint_law.h"

namespace carom::rigid::detail {
namespace {

constexpr std::uint32_t limb_mask2 = part_pin | part_twist;
constexpr std::uint32_t limb_mask3 = part_pin | part_friction | part_cone | part_twist | part_angular | part_hinge;

template <int W>
Vec3f lane_value(const float (&lanes)[3][W], int lane) {
  return {lanes[0][lane], lanes[1][lane], lanes[2][lane]};
}
template <int W>
Vec2f lane_value(const float (&lanes)[2][W], int lane) {
  return {lanes[0][lane], lanes[1][lane]};
}

/// Springs of one figure and of its like are the same.
class SameSpring {
 public:
  const Response& response(const JointSpring& spring, const Clock& t) {
    if (spring.hertz != hertz_ || spring.damping_ratio != damping_ratio_ || t.pace != pace_) {
      response_ = stiffened_response(spring, t, 1);
      hertz_ = spring.hertz, damping_ratio_ = spring.damping_ratio, pace_ = t.pace;
    }
    return response_;
  }

 private:
  float hertz_ = 0, damping_ratio_ = 0, pace_ = 0;
  Response response_{};
};

/// `out`: LawLanes, or LimbLanes<Dim3>.
void put_response(auto& out, int lane, const Response& response) {
  out.velocity[lane] = response.velocity;
  out.position[lane] = response.position;
  out.memory[lane] = response.memory;
  out.previous[lane] = response.previous;
}
template <int W>
void put_law(LawLanes<W>& out, int lane, const AxisLaw& law) {
  out.rest[lane] = law.rest;
  put_response(out, lane, {0, 0, 1, 0});
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
void put_frames(LimbLanes<Dim2, W>&, LimbRaw<Dim2, W>& raw, int lane, const JointFrames<Dim2>& frames) {
  set_lane(raw.frame_a, lane, frames.frame_a.q);
  set_lane(raw.frame_b, lane, frames.frame_b.q);
}
template <int W>
void put_frames(LimbLanes<Dim3, W>& out, LimbRaw<Dim3, W>&, int lane, const JointFrames<Dim3>& frames) {
  set_lane(out.frame_a, lane, frames.frame_a.q);
  set_lane(out.frame_b, lane, frames.frame_b.q);
}

template <class D, int W>
void put_turns(LimbLanes<D, W>& out, int lane, const JointData<D>& data, const Clock& t, SameSpring& same) {
  if (out.parts & part_twist) {
    AxisLaw law;
    fill_twist(law, data, t);
    put_law(out.law, lane, law);
  }
  if constexpr (D::dimension == 3) {
    const auto* ball = data.template get<BallJointDef>();
    if (out.parts & part_cone) {
      out.cone_angle[lane] = ball->cone_angle;
      out.cone.impulse[lane] = data.memory.turn[0].upper;
    }
    if (out.parts & part_friction) {
      set_lane(out.friction, lane, data.memory.friction);
      out.max_friction[lane] = ball->friction_torque * t.push();
    }
    if (out.parts & part_angular) {
      set_lane(out.spring, lane, data.memory.angular);
      if ((out.parts & limb_is_stiff) == 0)
        put_response(out, lane,
                     same.response(ball != nullptr ? ball->spring : data.template get<WeldJointDef>()->angular, t));
      if (out.parts & limb_is_aimed) set_lane(out.aim, lane, ball->target_rotation);
    }
    if (out.parts & part_hinge) set_lane(out.hinge, lane, data.memory.hinge);
  }
}

template <class D, int W>
void fill_lane(LimbLanes<D, W>& out, LimbRaw<D, W>& raw, int lane, std::int32_t joint,
               const WorldImplementation<D>& world, float h, SameSpring& same) {
  if constexpr (D::dimension == 2)
    put_joint(out, raw.turns, out.inverse_inertia_a, out.inverse_inertia_b, lane, joint, world);
  else
    put_joint(out, raw.turns, out.start_tensor_a, out.start_tensor_b, lane, joint, world);
  if (joint == none) return;
  const JointData<D>& data = world.joints.at(joint);
  put_frames(out, raw, lane, data.frames());
  put_turns(out, lane, data, clock_of(world.bodies, world.joints.headers[std::size_t(joint)], h), same);
}

/// How the springs of hinges respond, whose frequency is that of the whole joint.
template <class D, int W>
void stiffen_springs(LimbLanes<D, W>& out, const LimbRaw<D, W>& raw, const WorldImplementation<D>& world, float h) {
  for (int lane = 0; lane < W; ++lane) {
    if (out.joint[lane] == none) continue;
    const JointSpring* spring = spring_of_twist(world.joints.at(out.joint[lane]));
    if (spring == nullptr) continue;
    const Clock t = clock_of(world.bodies, world.joints.headers[std::size_t(out.joint[lane])], h);
    put_response(out.law, lane, stiffened_response(*spring, t, raw.stiffer[lane]));
  }
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
void prepare_limbs(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(context.world.kernels.width, [&]<int W>() {
    const int count = int(joints.limbs.size()) / W;
    if (count == 0) return;
    const auto blocks = context.arena.template allocate<LimbLanes<D, W>>(std::size_t(count));
    joints.limb_blocks = blocks.data();
    for_blocks_of_colors(context.scheduler, 4, joints.limb_begin, [&](int begin, int end) {
      SameSpring same;
      for (int b = begin; b < end; ++b) {
        LimbLanes<D, W>& block = *::new (static_cast<void*>(&blocks[std::size_t(b)])) LimbLanes<D, W>{};
        block.parts = joints.limbs[std::size_t(b) * W].parts;
        LimbRaw<D, W> raw{};
        for (int lane = 0; lane < W; ++lane)
          fill_lane(block, raw, lane, joints.limbs[std::size_t(b) * W + std::size_t(lane)].joint, context.world,
                    context.h, same);
        context.world.kernels.limbs.begin(context.bodies, &block, &raw);
        if (block.parts & part_twist) stiffen_springs(block, raw, context.world, context.h);
      }
    });
  });
}

template <class D>
void store_limbs(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(context.world.kernels.width, [&]<int W>() {
    const auto* const blocks = static_cast<const LimbLanes<D, W>*>(joints.limb_blocks);
    for_blocks_of_colors(context.scheduler, 4, joints.limb_begin, [&](int begin, int end) {
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
template void prepare_limbs(StepContext<Dim2>&);
template void prepare_limbs(StepContext<Dim3>&);
template void store_limbs(StepContext<Dim2>&);
template void store_limbs(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
