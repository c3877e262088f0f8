// Bodies of space through a substep, side by side.
#pragma once

#include <cstdint>

#include "carom/rigid/detail/rotation_step.h"
#include "carom/rigid/detail/step_context.h"

namespace carom::rigid::detail {

/// Which of as many bodies as there are lanes were not wholly moved. Bits by lane.
struct LeftOver {
  std::uint32_t locked = 0;  ///< not at all: axes are locked
  std::uint32_t free = 0;    ///< not turned: by themselves, and nothing pushed them
  std::uint32_t pushed = 0;  ///< not turned: constraints pushed them about
};

/// `drives`, `flights`: those of `count` places of the awake list, at most as many as there are lanes. Bodies that fly
/// through (BodyDrive) are left alone.
struct MoveKernels {
  /// What forces do to velocities in a substep (stage_integrate.cpp). carry_on: see SolverStage::order. Returns those
  /// whose axes are locked, with which nothing is done: bits by lane.
  std::uint32_t (*accelerate)(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, Flight<Dim3>* flights, int count,
                              float h, float max_speed, bool carry_on) = nullptr;
  /// Moves their centres, and turns those whose spin stays as it is.
  LeftOver (*move)(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, const Flight<Dim3>* flights, int count,
                   float h) = nullptr;
  /// Turns `count` bodies that constraints push about for a time h (s), with the arithmetic of `torque_free_turn`:
  /// their angular momentum stays, their velocity follows.
  void (*turn)(SolverBody<Dim3>* bodies, const Pose3* poses, const BodyMotion<Dim3>* motions, const std::int32_t* slots,
               int count, float h) = nullptr;
  /// All substeps of those that fly through. Returns those that turn by themselves, which are not turned.
  std::uint32_t (*fly)(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, int count, float h, int substeps,
                       float max_speed) = nullptr;
};

}  // namespace carom::rigid::detail
