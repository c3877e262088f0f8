// Joints of figures as the wide solver reads them: W limbs of one kind side by side, one array of W floats per quantity
// (plain data, as joint_lanes.h). A limb is a pin that turns under laws: in space a ball joint with cone, twist range,
// spring and friction, a weld without a spring along lines, or a hinge; in the plane a hinge with spring, motor or
// limits. All limbs of a block have the same parts (JointPart), which say what of it is used.
#pragma once

#include <cstdint>

#include "carom/rigid/detail/joint_lanes.h"
#include "carom/rigid/detail/joint_part.h"

namespace carom::rigid::detail {

/// How rows answer in a pass: rigid ones as in PinResponse; a stop may close within the substep.
struct LimbPass {
  float velocity, position, memory, inverse_h;
};

/// A bound on an angle: `gap` is what is left to it.
template <int W>
struct StopLanes {
  float gap[W], impulse[W];
};

/// Spring, motor and stops of one angle (AxisLaw).
template <int W>
struct LawLanes {
  float axis_mass[W], axis_mobility[W];  ///< of the row; 0 where it cannot move
  float rest[W], error[W];               ///< rad
  float velocity[W], position[W], memory[W], previous[W], before[W], spring[W], max_spring[W];
  float speed[W], max_motor[W], motor[W];
  float low[W], high[W];  ///< rad
  StopLanes<W> lower, upper;
};

template <class D, int W>
struct LimbLanes;

template <int W>
struct alignas(64) LimbLanes<Dim2, W> {
  std::int32_t read_a[W], read_b[W];    ///< body slots; −1: the world, or no joint in this lane
  std::int32_t write_a[W], write_b[W];  ///< the same, or −1 for bodies that impulses do not move
  float inverse_mass_a[W], inverse_mass_b[W], inverse_inertia_a[W], inverse_inertia_b[W];
  float arm_a[2][W], arm_b[2][W], offset[2][W];  ///< as in PinLanes
  float frame[2][W];                             ///< cosine and sine of frame B in frame A at the start of the step
  float impulse[2][W], turn_impulse[W];
  float reach_a[2][W], reach_b[2][W], error[2][W], factor[3][W];  ///< as the bodies stand now
  LawLanes<W> law;
  std::int32_t joint[W];  ///< slot
  std::uint32_t parts;
};

template <int W>
struct alignas(64) LimbLanes<Dim3, W> {
  std::int32_t read_a[W], read_b[W], write_a[W], write_b[W];
  float inverse_mass_a[W], inverse_mass_b[W];
  float arm_a[3][W], arm_b[3][W], offset[3][W];
  float frame_a[4][W], frame_b[4][W];                ///< joint frames in the world at the start of the step: w, x, y, z
  float start_tensor_a[6][W], start_tensor_b[6][W];  ///< inverse inertia then, world axes: xx, xy, xz, yy, yz, zz
  float impulse[3][W], turn_impulse[3][W];           ///< turn: of all rows about axes, on B
  // As the bodies stand now:
  float tensor_a[6][W], tensor_b[6][W];
  float reach_a[3][W], reach_b[3][W], error[3][W], factor[6][W];
  float turn_factor[6][W];  ///< of the two tensors' sum
  float friction[3][W], max_friction[W];
  float spring[3][W], attitude[3][W], before[3][W];  ///< attitude: rotation vector from frame A to frame B
  float aim[4][W];  ///< of a limb that is aimed: the wanted attitude of frame B in frame A
  float velocity[W], position[W], memory[W], previous[W];
  float cone_axis[3][W], cone_mass[W], cone_angle[W];
  StopLanes<W> cone;
  float twist_axis[3][W];
  LawLanes<W> law;  ///< of the twist
  float hinge_u[3][W], hinge_v[3][W], hinge_error[2][W], hinge[2][W], hinge_factor[3][W];
  std::int32_t joint[W];
  std::uint32_t parts;
};

/// What a block starts from, beside what lies in it: then its arms, and in space its frames, are in their bodies' own.
template <class D, int W>
struct LimbRaw;
template <int W>
struct alignas(64) LimbRaw<Dim2, W> {
  BodyTurns<Dim2, W> turns;
  float frame_a[2][W], frame_b[2][W];  ///< of the joint, in its bodies
  float stiffer[W];                    ///< out: mass_ratio_root of the turn
};
template <int W>
struct alignas(64) LimbRaw<Dim3, W> {
  BodyTurns<Dim3, W> turns;
  float stiffer[W];
};

/// In the parts of a limb: its spring is rigid (a weld).
inline constexpr std::uint32_t limb_is_stiff = 1u << 31;
/// Its spring pulls toward another attitude than that of frames aligned.
inline constexpr std::uint32_t limb_is_aimed = 1u << 30;

/// The kernels of one width. Blocks [begin, end).
template <class D>
struct LimbKernels {
  /// From where its bodies are when the step begins and how fast: what a block holds of that (but for the response of
  /// its springs), from its LimbRaw.
  void (*begin)(const SolverBody<D>* bodies, void* block, void* raw) = nullptr;
  void (*warm_start)(SolverBody<D>* bodies, void* blocks, int begin, int end) = nullptr;
  void (*solve)(SolverBody<D>* bodies, void* blocks, int begin, int end, LimbPass pass) = nullptr;
  void (*relax)(SolverBody<D>* bodies, void* blocks, int begin, int end, LimbPass pass) = nullptr;  ///< places first
};

}  // namespace carom::rigid::detail
