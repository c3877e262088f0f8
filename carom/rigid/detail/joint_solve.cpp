// The joints' passes of a substep.
#include "carom/rigid/detail/joint_rows.h"
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
  inverse_inertia = r * motion.world_inverse_inertia * transpose(r);
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
    if (!record.direct || !is_rigid(block)) act(pair, block);
  });
  save_pair(pair, record, bodies);
}

/// Runs f on the blocks that lie at `begin` of each colour.
template <class D, class F>
void for_blocks(StepContext<D>& context, const std::vector<std::int32_t>& begins, int color, F&& f) {
  const int first = begins[std::size_t(color)], count = begins[std::size_t(color) + 1] - first;
  if (count == 0) return;
  const int threads = context.scheduler.thread_count();
  if (threads == 1 || count <= 16) return f(first, first + count);
  const int grain = max(8, (count + 3 * threads - 1) / (3 * threads));
  context.scheduler.parallel_for(count, grain, [&](int begin, int end, int) { f(first + begin, first + end); });
}

/// Runs `act` on the records of a colour: side by side, but for the overflow one after the other.
template <bool first_of_substep, class D, class Act>
void for_each_record(StepContext<D>& context, int color, const Act& act) {
  JointStore<D>& joints = context.world.joints;
  const int first = joints.color_begin[std::size_t(color)], last = joints.color_begin[std::size_t(color) + 1];
  if (first == last) return;
  const auto run = [&](int begin, int end, int) {
    for (int i = first + begin; i < first + end; ++i) {
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
  };
  if (color == overflow_color || last - first < 64)
    run(0, last - first, 0);
  else
    context.scheduler.parallel_for(last - first, 128, run);
}

}  // namespace

template <class D>
void warm_start_joints(StepContext<D>& context, int color) {
  for_each_record<true>(context, color, [](auto& pair, auto& block) { block.warm_start(pair); });
  const JointStore<D>& joints = context.world.joints;
  for_blocks(context, joints.limb_begin, color, [&](int begin, int end) {
    joints.limb_kernels.warm_start(context.bodies, joints.limb_blocks, begin, end);
  });
  for_blocks(context, joints.pin_begin, color,
             [&](int begin, int end) { joints.pin_kernels.warm_start(context.bodies, joints.pin_blocks, begin, end); });
}

template <class D>
void solve_joints(StepContext<D>& context, int color, bool use_bias) {
  const Softness& soft = context.joint_softness;
  const Response biased{soft.mass_scale, soft.mass_scale * soft.bias_rate, soft.impulse_scale};
  const JointPass pass{context.h, context.inverse_h, use_bias, use_bias ? biased : velocity_only};
  for_each_record<false>(context, color, [&pass](auto& pair, auto& block) { block.solve(pair, pass); });
  const JointStore<D>& joints = context.world.joints;
  const LimbPass limb_pass{biased.velocity, biased.position, biased.memory, context.inverse_h};
  for_blocks(context, joints.limb_begin, color, [&](int begin, int end) {
    (use_bias ? joints.limb_kernels.solve : joints.limb_kernels.relax)(context.bodies, joints.limb_blocks, begin, end,
                                                                       limb_pass);
  });
  for_blocks(context, joints.pin_begin, color, [&](int begin, int end) {
    if (use_bias)
      joints.pin_kernels.solve(context.bodies, joints.pin_blocks, begin, end,
                               {biased.velocity, biased.position, biased.memory});
    else
      joints.pin_kernels.relax(context.bodies, joints.pin_blocks, begin, end);
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
  if (joints.data[std::size_t(joint)].internal) --joints.internal_count;
  if (may_break(joints.data[std::size_t(joint)].definition)) --joints.breakable_count;
  drop_knots(joints, joint);
  joints.data[std::size_t(joint)] = {};
  joints.headers[std::size_t(joint)] = {};
  joints.slots.release(joints.slots.handle_at(joint));
}

template void warm_start_joints(StepContext<Dim2>&, int);
template void warm_start_joints(StepContext<Dim3>&, int);
template void solve_joints(StepContext<Dim2>&, int, bool);
template void solve_joints(StepContext<Dim3>&, int, bool);
template void destroy_joints_of(WorldImplementation<Dim2>&, std::int32_t);
template void destroy_joints_of(WorldImplementation<Dim3>&, std::int32_t);
template void release_joint(WorldImplementation<Dim2>&, std::int32_t);
template void release_joint(WorldImplementation<Dim3>&, std::int32_t);

}  // namespace carom::rigid::detail
