// Ball joints and plane hinges that only hold (no limit, motor, spring), as the wide solver reads them: W joints side
// by side, one array of W floats per quantity. Plain data, so that sources compiled for different instruction sets can
// share it. In space both bodies must turn alike about every axis; others stay with JointRecord.
#pragma once

#include <cstdint>

#include "carom/rigid/detail/solver_body.h"

namespace carom::rigid::detail {

template <class D, int W>
struct alignas(64) PinLanes {
  static constexpr int factors = D::dimension == 2 ? 3 : 6;
  std::int32_t read_a[W], read_b[W];    ///< body slots; −1: the world, or no joint in this lane
  std::int32_t write_a[W], write_b[W];  ///< the same, or −1 for bodies that impulses do not move
  float inverse_mass_a[W], inverse_mass_b[W], inverse_inertia_a[W], inverse_inertia_b[W];
  float arm_a[D::dimension][W], arm_b[D::dimension][W];  ///< from the centres of mass, at the start of the step
  float offset[D::dimension][W];                         ///< centre of B minus centre of A, at the start of the step
  float impulse[D::dimension][W];
  // As the bodies stand now:
  float reach_a[D::dimension][W], reach_b[D::dimension][W];  ///< from the centres to B's anchor
  float error[D::dimension][W];                              ///< from A's anchor to B's
  float factor[factors][W];                                  ///< 1/D, then L of the mobility's LDLᵀ
  std::int32_t joint[W];                                     ///< slot
};

/// Rotations of both bodies when the step begins: cosine and sine, or w, x, y, z.
template <class D, int W>
struct alignas(64) BodyTurns {
  static constexpr int numbers = D::dimension == 2 ? 2 : 4;
  float a[numbers][W], b[numbers][W];
};

/// How rigid rows answer in the biased pass (joint_response.h).
struct PinResponse {
  float velocity, position, memory;
};

/// The kernels of one width. Blocks [begin, end).
template <class D>
struct PinKernels {
  /// Of a block whose arms are in the frames of their bodies: turns them (by BodyTurns), and what follows from that.
  void (*begin)(void* block, const void* turns) = nullptr;
  void (*warm_start)(SolverBody<D>* bodies, void* blocks, int begin, int end) = nullptr;
  void (*solve)(SolverBody<D>* bodies, void* blocks, int begin, int end, PinResponse response) = nullptr;
  /// Brings the arms to where the bodies are now, and removes the velocity that is left.
  void (*relax)(SolverBody<D>* bodies, void* blocks, int begin, int end) = nullptr;
};

}  // namespace carom::rigid::detail
