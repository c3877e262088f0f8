// The rigid rows of joint blocks one by one, for those that solve them directly.
// Ċ = n·(v_b − v_a) + lever_b·ω_b − lever_a·ω_a.
#pragma once

#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/step_context.h"

namespace carom::rigid::detail {

inline Response response_of(const Softness& soft) {
  return {soft.mass_scale, soft.mass_scale * soft.bias_rate, soft.impulse_scale};
}
template <class D>
JointPass joint_pass(const StepContext<D>& context, bool use_bias) {
  if (!use_bias) return {context.h, context.inverse_h, false, velocity_only, velocity_only};
  return {context.h, context.inverse_h, true, response_of(context.joint_softness),
          response_of(context.coupling_softness)};
}

/// Does this block hold its rows rigidly, with any impulse that it takes?
template <class Block>
bool is_rigid(const Block& block) {
  if constexpr (requires { block.friction; })
    return block.rigid && !block.friction && block.max_impulse > 1e29f;
  else if constexpr (requires { block.law; })
    return block.law.has(AxisLaw::rigid);
  else
    return !requires { block.response; } && !requires { block.ratio; };
}

/// Has it motors, springs, friction or stops, which a tree solves along or about an axis, or about three?
template <class D, class Block>
bool is_driven(const Block& block) {
  if constexpr (std::is_same_v<Block, AngularBlock<D>> || requires { block.law; })
    return !is_rigid(block);
  else
    return false;
}

/// Calls visit(n, lever_a, lever_b, error, impulse) for each rigid row.
template <class D, class Block, class Pair, class Visit>
void visit_rows(Block& block, const Pair& pair, Visit&& visit) {
  using Vector = typename D::Vector;
  if constexpr (std::is_same_v<Block, PinBlock<D>>) {
    const Vector b = rotate(pair.turn_b, block.arm_b), a = block.offset + pair.shift + b;
    const Vector error = a - rotate(pair.turn_a, block.arm_a);
    for (int i = 0; i < D::dimension; ++i) {
      Vector n{};
      n[i] = 1;
      visit(n, cross(a, n), cross(b, n), error[i], block.impulse[i]);
    }
  } else if constexpr (std::is_same_v<Block, AngularBlock<D>>) {
    const auto turn_a = pair.turn_a * block.frame_a, turn_b = pair.turn_b * block.frame_b;
    if constexpr (D::dimension == 2) {
      visit(Vector{}, 1.0f, 1.0f, twist_angle(conjugate(turn_a) * turn_b), block.impulse);
    } else {
      const Vec3f error = rotation_vector_of(turn_b * conjugate(turn_a));
      for (int i = 0; i < 3; ++i) {
        Vec3f axis{};
        axis[i] = 1;
        visit(Vector{}, axis, axis, error[i], block.impulse[i]);
      }
    }
  } else if constexpr (std::is_same_v<Block, SlideBlock<D>>) {
    typename Block::Row row[Block::rows];
    block.directions(pair, row);
    for (int i = 0; i < Block::rows; ++i)
      visit(row[i].n, row[i].lever_a, row[i].lever_b, row[i].error, block.impulse[i]);
  } else if constexpr (std::is_same_v<Block, PathBlock<D>>) {
    typename Block::Row row[Block::most];
    const int count = block.rows(pair, row);
    for (int i = 0; i < count; ++i) visit(row[i].n, row[i].lever_a, row[i].lever_b, row[i].error, block.impulse[i]);
  } else if constexpr (std::is_same_v<Block, LinearAxis<D>>) {
    const auto row = block.row(pair);
    visit(row.n, row.lever_a, row.lever_b, row.coordinate - block.law.rest, block.law.spring_impulse);
  } else if constexpr (std::is_same_v<Block, AngularAxis<D>>) {
    float coordinate;
    const auto n = block.row(pair, true, coordinate);
    visit(Vector{}, n, n, wrap_angle(coordinate - block.law.rest), block.law.spring_impulse);
  } else if constexpr (std::is_same_v<Block, HingeBlock>) {
    Vec3f u, v;
    Vec2f error;
    block.directions(pair, u, v, error);
    visit(Vector{}, u, u, error.x, block.impulse.x);
    visit(Vector{}, v, v, error.y, block.impulse.y);
  }
}

/// Calls visit(n, lever_a, lever_b, coordinate, law) for the axis of a block that is driven.
template <class D, class Block, class Pair, class Visit>
void visit_axis(Block& block, const Pair& pair, Visit&& visit) {
  if constexpr (std::is_same_v<Block, AngularAxis<D>>) {
    float coordinate;
    const auto n = block.row(pair, block.law.needs_coordinate(), coordinate);
    visit(typename D::Vector{}, n, n, coordinate, block.law);
  } else if constexpr (requires { block.law; }) {
    const auto row = block.row(pair);
    visit(row.n, row.lever_a, row.lever_b, row.coordinate, block.law);
  }
}

/// The same for all blocks of a record that are rigid.
template <class D, class Pair, class Visit>
void visit_rigid_rows(JointRecord<D>& record, const Pair& pair, Visit&& visit) {
  for_each_block(record, [&](JointPart, auto& block) {
    if (is_rigid(block)) visit_rows<D>(block, pair, visit);
  });
}

}  // namespace carom::rigid::detail
