// What joints are made of: the blocks of joint_blocks.h, joint_axis.h and joint_coupling.h.
#pragma once

#include <cstdint>

namespace carom::rigid::detail {

/// The blocks of a joint in the order in which they are solved: what matters most is last.
enum JointPart : std::int32_t {
  part_friction = 1,  ///< AngularBlock
  part_linear = 2,    ///< LinearAxis
  part_cone = 4,      ///< AngularAxis
  part_twist = 8,     ///< AngularAxis
  part_angular = 16,  ///< AngularBlock
  part_hinge = 32,    ///< HingeBlock
  part_slide = 64,    ///< SlideBlock
  part_point = 128,   ///< PointBlock
  part_pin = 256,     ///< PinBlock
  // Of generic joints: part_linear along x, and
  part_linear_y = 512,
  part_linear_z = 1024,
  part_turn_x = 2048,  ///< AngularAxis
  part_turn_y = 4096,
  part_turn_z = 8192,
  part_coupling = 16384,  ///< CouplingBlock
  part_along = 1 << 15,   ///< PathAxis
  part_path = 1 << 16,    ///< PathBlock
};
constexpr JointPart linear_part(int axis) { return axis == 0 ? part_linear : JointPart(part_linear_y << (axis - 1)); }
constexpr JointPart turn_part(int axis) { return JointPart(part_turn_x << axis); }

}  // namespace carom::rigid::detail
