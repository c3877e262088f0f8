// What the solver touches of a body: its velocity, and how far it has moved since the step began. Everything else about
// a body is cold and stays in BodyStore.
#pragma once

#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

/// Within a step all is relative to the pose at its start, so float is enough wherever the world's body stands.
/// The layout is rows of four floats, which the wide solver transposes (math::gather_rows): velocities come first and
/// are written back, the rest is read only by it.
template <class D>
struct SolverBody;

/// 32 bytes: one row of velocity, one of displacement.
template <>
struct alignas(32) SolverBody<Dim2> {
  Vec2f linear_velocity{};     ///< m/s, of the centre of mass
  float angular_velocity = 0;  ///< rad/s
  float unused = 0;
  Vec2f delta_position{};  ///< m, of the centre of mass since the step began
  Rot2f delta_rotation{};  ///< rotation now = delta_rotation · rotation at the step's start
};

/// 64 bytes: linear velocity, angular velocity, displacement, rotation.
template <>
struct alignas(64) SolverBody<Dim3> {
  Vec3f linear_velocity{};
  float spin_rest_x = 0;     ///< what the angular velocity of a freely turning body lost to rounding: lets a tumbling
  Vec3f angular_velocity{};  ///< rad/s, world axes
  float spin_rest_y = 0;     ///< body keep its energy to seven digits more; contacts clear it
  Vec3f delta_position{};
  float spin_rest_z = 0;
  Quatf delta_rotation{};  ///< w, x, y, z; rotation now = delta_rotation · rotation at the step's start
};
static_assert(sizeof(SolverBody<Dim2>) == 32 && sizeof(SolverBody<Dim3>) == 64);

}  // namespace carom::rigid::detail
