// All that is compiled once for each instruction set, as one table: a world chooses it when it is made.
#pragma once

#include "carom/math/cpu.h"
#include "carom/rigid/detail/contact_block.h"
#include "carom/rigid/detail/flight_lanes.h"
#include "carom/rigid/detail/joint_lanes.h"
#include "carom/rigid/detail/joint_limb_lanes.h"
#include "carom/rigid/detail/move_lanes.h"
#include "carom/rigid/detail/step_end_lanes.h"

namespace carom::rigid::detail {

/// The kernels of joints and bodies (joint_solver_*.cpp).
template <class D>
struct LaneKernels {
  PinKernels<D> pins;
  LimbKernels<D> limbs;
  StepEndKernel<D> bring_to_end = nullptr;
  MoveKernels move;                  ///< in space; the plane's are among ContactKernels
  FlightKernel turn_free = nullptr;  ///< in space
};

template <class D>
struct Kernels : ContactKernels<D>, LaneKernels<D> {
  PairKernels<D> pairs;
};

namespace pin_kernels_baseline {
LaneKernels<Dim2> kernels(Dim2);
LaneKernels<Dim3> kernels(Dim3);
}  // namespace pin_kernels_baseline
#if CAROM_WIDE_UNITS
namespace pin_kernels_avx2 {
LaneKernels<Dim2> kernels(Dim2);
LaneKernels<Dim3> kernels(Dim3);
}  // namespace pin_kernels_avx2
namespace pin_kernels_avx512 {
LaneKernels<Dim2> kernels(Dim2);
LaneKernels<Dim3> kernels(Dim3);
}  // namespace pin_kernels_avx512
#endif

/// Pairs are asked by eight lanes at most: between their kernels stands much that is not in lanes, which registers of
/// sixteen slow down (narrow phases by 2 to 15 %).
template <class D>
Kernels<D> kernels_of([[maybe_unused]] math::InstructionSet set) {
#if CAROM_WIDE_UNITS
  if (set >= math::InstructionSet::avx2) {
    const PairKernels<D> pairs = contact_kernels_avx2::pair_kernels(D{});
    if (set == math::InstructionSet::avx512)
      return {contact_kernels_avx512::kernels(D{}), pin_kernels_avx512::kernels(D{}), pairs};
    return {contact_kernels_avx2::kernels(D{}), pin_kernels_avx2::kernels(D{}), pairs};
  }
#endif
  return {contact_kernels_baseline::kernels(D{}), pin_kernels_baseline::kernels(D{}),
          contact_kernels_baseline::pair_kernels(D{})};
}

}  // namespace carom::rigid::detail
