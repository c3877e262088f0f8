// What the solver streams through: one record a joint, its bodies and masses first, then the blocks that it is made of.
#pragma once

#include <new>
#include <type_traits>

#include "carom/rigid/detail/joint_blocks.h"
#include "carom/rigid/detail/joint_store.h"

namespace carom::rigid::detail {

/// The blocks of a joint in the order in which they are solved: what matters most is last.
enum JointPart : std::uint8_t {
  part_friction = 1,  ///< AngularBlock
  part_linear = 2,    ///< LinearAxis
  part_cone = 4,      ///< AngularAxis
  part_twist = 8,     ///< AngularAxis
  part_angular = 16,  ///< AngularBlock
  part_hinge = 32,    ///< HingeBlock
  part_slide = 64,    ///< SlideBlock
  part_point = 128,   ///< PointBlock
};

template <class D>
struct JointRecord {
  std::int32_t body_a = none, body_b = none;  ///< slots; A may be `none`: the world
  std::int32_t joint = none;                  ///< slot
  std::uint8_t parts = 0;
  bool dynamic_a = false, dynamic_b = false;  ///< only dynamic bodies are written to
  bool turning_inertia = false;               ///< a body's inertia depends on where it has turned within the step
  float inverse_mass_a = 0, inverse_mass_b = 0;
  typename D::Inertia inverse_inertia_a{}, inverse_inertia_b{};
};

/// Calls visit(part, block) for each block of the record.
template <class D, class Visit>
void for_each_block(JointRecord<D>& record, Visit&& visit) {
  unsigned char* at = reinterpret_cast<unsigned char*>(&record) + sizeof(JointRecord<D>);
  const std::uint8_t parts = record.parts;
  const auto next = [&]<class Block>(std::type_identity<Block>) -> Block& {
    static_assert(std::is_trivially_copyable_v<Block> && alignof(Block) == 4);
    Block& block = *std::launder(reinterpret_cast<Block*>(at));
    at += sizeof(Block);
    return block;
  };
  if (parts & part_friction) visit(part_friction, next(std::type_identity<AngularBlock<D>>{}));
  if (parts & part_linear) visit(part_linear, next(std::type_identity<LinearAxis<D>>{}));
  if (parts & part_cone) visit(part_cone, next(std::type_identity<AngularAxis<D>>{}));
  if (parts & part_twist) visit(part_twist, next(std::type_identity<AngularAxis<D>>{}));
  if (parts & part_angular) visit(part_angular, next(std::type_identity<AngularBlock<D>>{}));
  if constexpr (D::dimension == 3) {
    if (parts & part_hinge) visit(part_hinge, next(std::type_identity<HingeBlock>{}));
  }
  if (parts & part_slide) visit(part_slide, next(std::type_identity<SlideBlock<D>>{}));
  if (parts & part_point) visit(part_point, next(std::type_identity<PointBlock<D>>{}));
}

/// Units of 16 bytes that a record with these parts takes.
template <class D>
constexpr std::uint32_t record_units(std::uint8_t parts) {
  std::size_t bytes = sizeof(JointRecord<D>);
  if (parts & part_friction) bytes += sizeof(AngularBlock<D>);
  if (parts & part_linear) bytes += sizeof(LinearAxis<D>);
  if (parts & part_cone) bytes += sizeof(AngularAxis<D>);
  if (parts & part_twist) bytes += sizeof(AngularAxis<D>);
  if (parts & part_angular) bytes += sizeof(AngularBlock<D>);
  if (D::dimension == 3 && (parts & part_hinge)) bytes += sizeof(HingeBlock);
  if (parts & part_slide) bytes += sizeof(SlideBlock<D>);
  if (parts & part_point) bytes += sizeof(PointBlock<D>);
  return std::uint32_t((bytes + 15) / 16);
}

/// How the bodies have turned and moved since the step began.
template <class D>
void load_turns(BodyPair<D>& pair, const JointRecord<D>& record, const SolverBody<D>* bodies) {
  typename D::Vector moved_a{}, moved_b{};
  if (record.body_a != none) {
    pair.turn_a = bodies[record.body_a].delta_rotation;
    moved_a = bodies[record.body_a].delta_position;
  }
  pair.turn_b = bodies[record.body_b].delta_rotation;
  moved_b = bodies[record.body_b].delta_position;
  pair.shift = moved_b - moved_a;
}

/// The blocks that this joint needs now.
template <class D>
std::uint8_t parts_of(const JointData<D>& data);

template <class D>
const JointFrames<D>& frames_of(const AnyJointDef<D>& definition) {
  return std::visit([](const auto& d) -> const JointFrames<D>& { return d; }, definition);
}

template <class D>
struct WorldImplementation;
/// Detaches the joint and frees its slot.
template <class D>
void release_joint(WorldImplementation<D>& world, std::int32_t joint);
/// Where the joint is now, with the forces of the last step.
template <class D>
JointState<D> measure_joint(const WorldImplementation<D>& world, std::int32_t joint);
/// Is `linear_error` of this joint something that should be zero?
template <class D>
bool joint_is_rigid(const AnyJointDef<D>& definition);

}  // namespace carom::rigid::detail
