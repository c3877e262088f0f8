// Bodies that constraints push about, turned side by side: the arithmetic of `torque_free_turn` in lanes.
#pragma once

#include <cstdint>

#include "carom/rigid/detail/solver_body.h"

namespace carom::rigid::detail {

template <int W>
struct alignas(64) TurnLanes {
  std::int32_t body[W];  ///< slots; −1: none in this lane
  float inertia[6][W];   ///< about the centre of mass, body axes: xx, xy, xz, yy, yz, zz
  float start[4][W];     ///< attitude at the start of the step: w, x, y, z
};
/// Turns the bodies of `lanes` (TurnLanes<W>) for a time h (s): their angular momentum stays, their velocity follows.
using TurnKernel = void (*)(SolverBody<Dim3>* bodies, const void* lanes, float h);

namespace pin_kernels_baseline {
TurnKernel turn_kernel();
}
#if defined(__x86_64__)
namespace pin_kernels_avx2 {
TurnKernel turn_kernel();
}
namespace pin_kernels_avx512 {
TurnKernel turn_kernel();
}
#endif

}  // namespace carom::rigid::detail
