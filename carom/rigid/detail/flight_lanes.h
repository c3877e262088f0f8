// Bodies that nothing touches, turned side by side through all substeps of a step, in double: torque-free rotation with
// the arithmetic of `torque_free_turn` (rotation_step.h).
#pragma once

#include <cstdint>

namespace carom::rigid::detail {

/// As many as half the floats of a register. An empty lane has inertia 1 and no spin.
template <int W>
struct alignas(64) FlightLanes {
  double inertia[6][W];  ///< about the centre of mass, body axes: xx, xy, xz, yy, yz, zz; in any unit
  double start[4][W];    ///< attitude at the step's start, unit: w, x, y, z
  double so_far[4][W];   ///< turn since then; becomes the turn at the end
  double spin[3][W];     ///< rad/s, world axes; becomes that at the end in body axes
  double gain[3][W];     ///< rad/s that torques give in a substep, world axes
  double keep[W];        ///< what damping leaves of the spin in a substep
  std::int32_t body[W];  ///< slots
  bool any_gain;
};
/// Turns the bodies of `lanes` (FlightLanes<half the kernels' width>) through substeps of h seconds; faster ones than
/// max_turn (rad) in a substep are slowed to it.
using FlightKernel = void (*)(void* lanes, float h, int substeps, float max_turn);

}  // namespace carom::rigid::detail
