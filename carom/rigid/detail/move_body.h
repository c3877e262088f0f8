// How a body moves through a substep with the velocity that it has.
#pragma once

#include "carom/rigid/detail/body_store.h"
#include "carom/rigid/detail/rotation_step.h"

namespace carom::rigid::detail {

/// Does the body keep its angular momentum rather than its angular velocity, once it spins?
inline bool may_turn_freely(const BodyMotion<Dim2>&, const BodyRecord&) { return false; }
inline bool may_turn_freely(const BodyMotion<Dim3>& m, const BodyRecord& r) {
  return m.gyroscopic && (r.locks & 56) == 0 && r.type == BodyType::dynamic;
}
inline bool spins(float) { return false; }
inline bool spins(const Vec3f& w) { return dot(w, w) > least_spin_squared; }

template <class D>
void turn_body(SolverBody<D>& s, float h) {
  s.delta_rotation = normalize(turn(h * s.angular_velocity) * s.delta_rotation);
}
/// A body that constraints push about; what nothing touches turns in double (flight_lanes.h).
inline void turn_pushed(SolverBody<Dim2>& s, const BodyMotion<Dim2>&, const Rot2f&, float h) { turn_body(s, h); }
inline void turn_pushed(SolverBody<Dim3>& s, const BodyMotion<Dim3>& m, const Quatf& start, float h) {
  const Quatf q = normalize(s.delta_rotation * start);
  const Quatf r = torque_free_turn(m.inertia, q, h, s.angular_velocity);
  s.delta_rotation = normalize(q * r * conjugate(start));
}

}  // namespace carom::rigid::detail
