// The rigid rows of joint blocks one by one, for those that solve them directly.
// Ċ = n·(v_b − v_a) + lever_b·ω_b − lever_a·ω_a.
#pragma once

#include "carom/rigid/detail/joint_record.h"

namespace carom::rigid::detail {

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

/// The same for all blocks of a record that are rigid.
template <class D, class Pair, class Visit>
void visit_rigid_rows(JointRecord<D>& record, const Pair& pair, Visit&& visit) {
  for_each_block(record, [&](JointPart, auto& block) {
    if (is_rigid(block)) visit_rows<D>(block, pair, visit);
  });
}

}  // namespace carom::rigid::detail
