// What the solver streams through: one record a joint, its bodies and masses first, then the blocks that it is made of.
#pragma once

#include <new>
#include <type_traits>

#include "carom/rigid/detail/joint_axis.h"
#include "carom/rigid/detail/joint_coupling.h"
#include "carom/rigid/detail/joint_part.h"
#include "carom/rigid/detail/joint_path.h"
#include "carom/rigid/detail/joint_store.h"

namespace carom::rigid::detail {

template <class D>
struct WorldImplementation;
template <class D>
struct StepContext;

/// What a tree solves of a joint that is in it: the rows that hold, or its motors, springs and stops too.
enum class Direct : std::uint8_t { nothing, rows, all };

/// In space two tensors follow where the bodies do not turn alike about every axis (not `isotropic`).
template <class D>
struct JointRecord {
  std::int32_t body_a = none, body_b = none;  ///< slots; A may be `none`: the world
  std::int32_t joint = none;                  ///< slot
  std::uint32_t parts = 0;
  bool dynamic_a = false, dynamic_b = false;  ///< only dynamic bodies are written to
  bool isotropic = true;
  Direct direct = Direct::nothing;
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

/// Calls f(part, type) for what blocks a record may have, in their order.
template <class D, class F>
constexpr void visit_parts(F&& f) {
  constexpr std::type_identity<AngularAxis<D>> turn{};
  constexpr std::type_identity<LinearAxis<D>> line{};
  f(part_friction, std::type_identity<AngularBlock<D>>{});
  f(part_coupling, std::type_identity<CouplingBlock<D>>{});
  f(part_along, std::type_identity<PathAxis<D>>{});
  for (int i = 0; i < (D::dimension == 2 ? 1 : 3); ++i) f(turn_part(i), turn);
  for (int i = 0; i < D::dimension; ++i) f(linear_part(i), line);
  f(part_cone, turn);
  f(part_twist, turn);
  f(part_angular, std::type_identity<AngularBlock<D>>{});
  if constexpr (D::dimension == 3) f(part_hinge, std::type_identity<HingeBlock>{});
  f(part_path, std::type_identity<PathBlock<D>>{});
  f(part_slide, std::type_identity<SlideBlock<D>>{});
  f(part_point, std::type_identity<PointBlock<D>>{});
  f(part_pin, std::type_identity<PinBlock<D>>{});
}

/// Calls visit(part, block) for each block of the record.
template <class D, class Visit>
void for_each_block(JointRecord<D>& record, Visit&& visit) {
  unsigned char* at = reinterpret_cast<unsigned char*>(&record) + sizeof(JointRecord<D>);
  if (!record.isotropic) at += 2 * sizeof(Mat3f);
  const std::uint32_t parts = record.parts;
  const auto next = [&]<class Block>(std::type_identity<Block>) -> Block& {
    static_assert(std::is_trivially_copyable_v<Block> && alignof(Block) == 4);
    Block& block = *std::launder(reinterpret_cast<Block*>(at));
    at += sizeof(Block);
    return block;
  };
  const auto at_part = [&]<class Block>(JointPart part, std::type_identity<Block> type) {
    if (parts & part) visit(part, next(type));
  };
  visit_parts<D>(at_part);
}

/// Units of 16 bytes that a record with these parts takes.
template <class D>
constexpr std::uint32_t record_units(std::uint32_t parts, bool isotropic) {
  std::size_t bytes = sizeof(JointRecord<D>) + (isotropic ? 0 : 2 * sizeof(Mat3f));
  visit_parts<D>([&]<class Block>(JointPart part, std::type_identity<Block>) {
    if (parts & part) bytes += sizeof(Block);
  });
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
  pair.moved_a = moved_a;
  pair.shift = moved_b - moved_a;
}

/// Notes the blocks that a joint needs by its definition.
template <class D>
void find_parts(JointData<D>& data);
/// Does it hold the distance itself?
template <class D>
bool is_rod(const JointData<D>& data);
/// Does its part_angular hold the frames' attitude without a spring?
template <class D>
bool turns_rigidly(const JointData<D>& data);
/// Has it a spring, whose stiffness goes by the masses of its bodies?
template <class D>
bool is_springy(const JointData<D>& data);

/// Is it a generic joint that holds some axis?
template <class D>
bool holds_axes(const JointData<D>& data);

// joint_pins.cpp: pins whose rows nothing but their own impulses act on go to the wide solver.
template <class D>
bool goes_wide(const WorldImplementation<D>& world, std::int32_t joint);
template <class D>
void prepare_pins(StepContext<D>& context);
template <class D>
void store_pins(StepContext<D>& context);

/// What the record holds, once it says which joint and parts it is for.
template <class D>
void fill_record(JointRecord<D>& record, const WorldImplementation<D>& world, float h);
// joint_limbs.cpp: likewise for joints of figures.
template <class D>
std::uint32_t limb_parts(const WorldImplementation<D>& world, std::int32_t joint);  ///< 0: it is none
template <class D>
void prepare_limbs(StepContext<D>& context);
template <class D>
void store_limbs(StepContext<D>& context);

template <class D>
bool may_break(const JointFrames<D>& frames) {
  return frames.break_force > 0 || frames.break_torque > 0;
}

/// Detaches the joint and frees its slot.
template <class D>
void release_joint(WorldImplementation<D>& world, std::int32_t joint);
/// Where the joint is now, with the forces of the last step.
template <class D>
JointState<D> measure_joint(const WorldImplementation<D>& world, std::int32_t joint);
/// Is `linear_error` of this joint something that should be zero?
template <class D>
bool joint_is_rigid(const JointData<D>& data);

}  // namespace carom::rigid::detail
