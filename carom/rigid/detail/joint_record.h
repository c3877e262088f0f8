// What the solver streams through: one record a joint, its bodies and masses first, then the blocks that it is made of.
#pragma once

#include <new>
#include <type_traits>

#include "carom/rigid/detail/joint_blocks.h"
#include "carom/rigid/detail/joint_store.h"

namespace carom::rigid::detail {

/// The blocks of a joint in the order in which they are solved: what matters most is last.
enum JointPart : std::uint16_t {
  part_friction = 1,  ///< AngularBlock
  part_linear = 2,    ///< LinearAxis
  part_cone = 4,      ///< AngularAxis
  part_twist = 8,     ///< AngularAxis
  part_angular = 16,  ///< AngularBlock
  part_hinge = 32,    ///< HingeBlock
  part_slide = 64,    ///< SlideBlock
  part_point = 128,   ///< PointBlock
  part_pin = 256,     ///< PinBlock
};

/// In space two tensors follow where the bodies do not turn alike about every axis (not `isotropic`).
template <class D>
struct JointRecord {
  std::int32_t body_a = none, body_b = none;  ///< slots; A may be `none`: the world
  std::int32_t joint = none;                  ///< slot
  std::uint16_t parts = 0;
  bool dynamic_a = false, dynamic_b = false;  ///< only dynamic bodies are written to
  bool isotropic = true;
  float inverse_mass_a = 0, inverse_mass_b = 0;
  float inverse_inertia_a = 0, inverse_inertia_b = 0;

  Mat3f* tensors() { return std::launder(reinterpret_cast<Mat3f*>(this + 1)); }  ///< of A and B, world axes
};

/// Masses of the record, at rest.
template <class D, class I>
void load_masses(BodyPair<D, I>& pair, JointRecord<D>& record) {
  pair.inverse_mass_a = record.inverse_mass_a;
  pair.inverse_mass_b = record.inverse_mass_b;
  if constexpr (std::is_same_v<I, float>) {
    pair.inverse_inertia_a = record.inverse_inertia_a;
    pair.inverse_inertia_b = record.inverse_inertia_b;
  } else if (record.isotropic) {
    const float a = record.inverse_inertia_a, b = record.inverse_inertia_b;
    pair.inverse_inertia_a = Mat3f::diagonal({a, a, a});
    pair.inverse_inertia_b = Mat3f::diagonal({b, b, b});
  } else {
    pair.inverse_inertia_a = record.tensors()[0];
    pair.inverse_inertia_b = record.tensors()[1];
  }
}

/// Calls visit(part, block) for each block of the record.
template <class D, class Visit>
void for_each_block(JointRecord<D>& record, Visit&& visit) {
  unsigned char* at = reinterpret_cast<unsigned char*>(&record) + sizeof(JointRecord<D>);
  if (!record.isotropic) at += 2 * sizeof(Mat3f);
  const std::uint16_t parts = record.parts;
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
  if (parts & part_pin) visit(part_pin, next(std::type_identity<PinBlock<D>>{}));
}

/// Units of 16 bytes that a record with these parts takes.
template <class D>
constexpr std::uint32_t record_units(std::uint16_t parts, bool isotropic) {
  std::size_t bytes = sizeof(JointRecord<D>) + (isotropic ? 0 : 2 * sizeof(Mat3f));
  if (parts & part_friction) bytes += sizeof(AngularBlock<D>);
  if (parts & part_linear) bytes += sizeof(LinearAxis<D>);
  if (parts & part_cone) bytes += sizeof(AngularAxis<D>);
  if (parts & part_twist) bytes += sizeof(AngularAxis<D>);
  if (parts & part_angular) bytes += sizeof(AngularBlock<D>);
  if (D::dimension == 3 && (parts & part_hinge)) bytes += sizeof(HingeBlock);
  if (parts & part_slide) bytes += sizeof(SlideBlock<D>);
  if (parts & part_point) bytes += sizeof(PointBlock<D>);
  if (parts & part_pin) bytes += sizeof(PinBlock<D>);
  return std::uint32_t((bytes + 15) / 16);
}

/// How the bodies have turned and moved since the step began.
template <class D, class I>
void load_turns(BodyPair<D, I>& pair, const JointRecord<D>& record, const SolverBody<D>* bodies) {
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
std::uint16_t parts_of(const JointData<D>& data);

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
