// Bodies at the end of a step, side by side.
#pragma once

#include <cstdint>

#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

/// What became of as many bodies as there are lanes in a step.
struct alignas(64) BodyEnds {
  static constexpr int most = 16;  ///< lanes
  float travel[most];              ///< m, of the centre of mass
  float turned[most];              ///< rad, by the shorter way
  float surface_way[most];         ///< m that the turn moved the surface at most
  float spin[most];                ///< rad/s
  float speed[most];               ///< m/s, of what moves fastest of it
  float pushed_squared[most];      ///< (m/s)²: that part of the way's mean speed that is not in the velocity
  float turn[4][most];             ///< of whirling ones: c, s or w, x, y, z, since the step began
  std::uint32_t broken;            ///< bits by lane: not finite, and left alone
  std::uint32_t whirling;          ///< bits by lane: may have turned by more than half a revolution
  std::uint32_t near_bounds;       ///< bits by lane: a shape may have left its fat bounds, or will in the next step
};

struct StepEndTerms {
  float dt, inverse_dt;   ///< s, 1/s
  std::uint32_t turning;  ///< bits by lane: dynamic, and free to turn about every axis
};

/// Brings poses and centres of `count` bodies, at most as many as there are lanes, from the start of the step to its
/// end, with the inertia in world axes of those that turn unlike a ball: what they have moved since the step began is
/// nothing again. Motion below any measure becomes none.
template <class D>
using StepEndKernel = void (*)(SolverBody<D>* bodies, typename D::Pose* poses, BodyMotion<D>* motions,
                               const std::int32_t* slots, int count, const StepEndTerms& terms, BodyEnds& ends);

/// m/s, rad/s or of a unit quaternion: less than that is the rounding of bodies that turn about one axis. Products of
/// it are too small for floats to be fast with.
inline constexpr float motion_trace = 1e-15f;
inline constexpr float small_turn = 0.2f;  ///< rad: up to it chords serve for arcs
inline constexpr float quick_share =
    0.25f;  ///< of a body's half thickness in a step: then bounds hold the next one too

}  // namespace carom::rigid::detail
