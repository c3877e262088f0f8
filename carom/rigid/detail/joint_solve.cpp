// The joints' passes of a substep.
#include "carom/rigid/detail/joint_rows.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {
namespace {

template <class D, class I>
void load_pair(BodyPair<D, I>& pair, JointRecord<D>& record, const SolverBody<D>* bodies) {
  load_turns(pair, record, bodies);
  load_masses(pair, record);
  if (record.body_a != none) {
    pair.velocity_a = bodies[record.body_a].linear_velocity;
    pair.spin_a = bodies[record.body_a].angular_velocity;
  }
  pair.velocity_b = bodies[record.body_b].linear_velocity;
  pair.spin_b = bodies[record.body_b].angular_velocity;
}
template <class D, class I>
void save_pair(const BodyPair<D, I>& pair, const JointRecord<D>& record, SolverBody<D>* bodies) {
  if (record.dynamic_a) {
    bodies[record.body_a].linear_velocity = pair.velocity_a;
    bodies[record.body_a].angular_velocity = pair.spin_a;
  }
  if (record.dynamic_b) {
    bodies[record.body_b].linear_velocity = pair.velocity_b;
    bodies[record.body_b].angular_velocity = pair.spin_b;
  }
}

inline void turn_inertia(Mat3f& inverse_inertia, const BodyMotion<Dim3>& motion, const Quatf& turn) {
  if (!motion.gyroscopic || turn.w > 0.99999f) return;  // less than half a degree
  const Mat3f r = to_matrix(turn);
  inverse_inertia = r * (motion.world_inverse_inertia * load_share(motion)) * transpose(r);
}
/// Space only: brings the record's tensors to the attitude of this substep.
inline void turn_inertias(JointRecord<Dim3>& record, const StepContext<Dim3>& context) {
  const auto& motion = context.world.bodies.motion;
  if (record.dynamic_a)
    turn_inertia(record.tensors()[0], motion[std::size_t(record.body_a)], context.bodies[record.body_a].delta_rotation);
  if (record.dynamic_b)
    turn_inertia(record.tensors()[1], motion[std::size_t(record.body_b)], context.bodies[record.body_b].delta_rotation);
}

template <class I, class D, class Act>
void act_on(JointRecord<D>& record, SolverBody<D>* bodies, const Act& act) {
  BodyPair<D, I> pair;
  load_pair(pair, record, bodies);
  for_each_block(record, [&](JointPart, auto& block) {
    if (record.direct != Direct::nothing && is_rigid(block)) return;
    if (record.direct == Direct::all && is_driven<D>(block)) return;
    act(pair, block);
  });
  save_pair(pair, record, bodies);
}

/// The joints of a colour: records that are solved one by one, then blocks of limbs, then of pins.
constexpr int records_a_unit = 8;  ///< take about as long as a block
struct JointUnits {
  int first_record, records, first_limb, limbs, first_pin, pins;

  template <class D>
  JointUnits(const JointStore<D>& joints, int color)
      : first_record(joints.color_begin[std::size_t(color)]),
        records(joints.color_begin[std::size_t(color) + 1] - first_record),
        first_limb(joints.limb_begin[std::size_t(color)]),
        limbs(joints.limb_begin[std::size_t(color) + 1] - first_limb),
        first_pin(joints.pin_begin[std::size_t(color)]),
        pins(joints.pin_begin[std::size_t(color) + 1] - first_pin) {}
  int count() const { return (records + records_a_unit - 1) / records_a_unit + limbs + pins; }
};

/// Runs `act` on a share of the records.
template <bool first_of_substep, class D, class Act>
void for_each_record(StepContext<D>& context, const JointUnits& units, ThreadShare share, const Act& act) {
  JointStore<D>& joints = context.world.joints;
  const int last = units.first_record + share.end(units.records);
  for (int i = units.first_record + share.begin(units.records); i < last; ++i) {
    auto& record = *std::launder(reinterpret_cast<JointRecord<D>*>(&joints.records[joints.offset[std::size_t(i)]]));
    if constexpr (D::dimension == 3) {
      if (!record.isotropic) {
        if constexpr (first_of_substep) turn_inertias(record, context);
        act_on<Mat3f>(record, context.bodies, act);
        continue;
      }
    }
    act_on<float>(record, context.bodies, act);
  }
}

/// Runs f(first block, last block) on a share of `count` blocks.
template <class F>
void for_blocks(int first_block, int count, ThreadShare share, F&& f) {
  const int first = share.begin(count), last = share.end(count);
  if (first < last) f(first_block + first, first_block + last);
}

}  // namespace

template <class D>
int joint_units(const WorldImplementation<D>& world, int color) {
  return JointUnits(world.joints, color).count();
}

template <class D>
void warm_start_joints(StepContext<D>& context, int color, ThreadShare share) {
  const JointStore<D>& joints = context.world.joints;
  const LaneKernels<D>& kernels = context.world.kernels;
  const JointUnits units(joints, color);
  for_each_record<true>(context, units, share, [](auto& pair, auto& block) { block.warm_start(pair); });
  for_blocks(units.first_limb, units.limbs, share,
             [&](int first, int last) { kernels.limbs.warm_start(context.bodies, joints.limb_blocks, first, last); });
  for_blocks(units.first_pin, units.pins, share,
             [&](int first, int last) { kernels.pins.warm_start(context.bodies, joints.pin_blocks, first, last); });
}

template <class D>
void solve_joints(StepContext<D>& context, int color, bool use_bias, ThreadShare share) {
  const Response biased = response_of(context.joint_softness);
  const JointPass pass = joint_pass(context, use_bias);
  const JointStore<D>& joints = context.world.joints;
  const LaneKernels<D>& kernels = context.world.kernels;
  const JointUnits units(joints, color);
  for_each_record<false>(context, units, share, [&pass](auto& pair, auto& block) { block.solve(pair, pass); });
  const LimbPass limb_pass{biased.velocity, biased.position, biased.memory, context.inverse_h};
  for_blocks(units.first_limb, units.limbs, share, [&](int first, int last) {
    (use_bias ? kernels.limbs.solve : kernels.limbs.relax)(context.bodies, joints.limb_blocks, first, last, limb_pass);
  });
  for_blocks(units.first_pin, units.pins, share, [&](int first, int last) {
    if (use_bias)
      kernels.pins.solve(context.bodies, joints.pin_blocks, first, last,
                         {biased.velocity, biased.position, biased.memory});
    else
      kernels.pins.relax(context.bodies, joints.pin_blocks, first, last);
  });
}

template <class D>
void destroy_joints_of(WorldImplementation<D>& world, std::int32_t body) {
  while (world.bodies.record[std::size_t(body)].first_joint != none) {
    const std::int32_t joint = world.bodies.record[std::size_t(body)].first_joint / 2;
    release_joint(world, joint);
  }
}

template <class D>
void release_joint(WorldImplementation<D>& world, std::int32_t joint) {
  JointStore<D>& joints = world.joints;
  detach_joint(world, joint);
  if (joints.at(joint).internal) --joints.internal_count;
  if (may_break(joints.at(joint).frames())) --joints.breakable_count;
  drop_knots(joints, joint);
  joints.drop(joint);
  joints.slots.release(joints.slots.handle_at(joint));
}

template int joint_units(const WorldImplementation<Dim2>&, int);
template int joint_units(const WorldImplementation<Dim3>&, int);
template void warm_start_joints(StepContext<Dim2>&, int, ThreadShare);
template void warm_start_joints(StepContext<Dim3>&, int, ThreadShare);
template void solve_joints(StepContext<Dim2>&, int, bool, ThreadShare);
template void solve_joints(StepContext<Dim3>&, int, bool, ThreadShare);
template void destroy_joints_of(WorldImplementation<Dim2>&, std::int32_t);
template void destroy_joints_of(WorldImplementation<Dim3>&, std::int32_t);
template void release_joint(WorldImplementation<Dim2>&, std::int32_t);
template void release_joint(WorldImplementation<Dim3>&, std::int32_t);

}  // namespace carom::rigid::detail
