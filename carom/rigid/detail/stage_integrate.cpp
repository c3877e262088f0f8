#include "carom/rigid/detail/rotation_step.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

float speed_of(float w) { return math::abs(w); }
float speed_of(const Vec3f& w) { return math::length(w); }

bool turns_freely(const BodyMotion<Dim2>&, const BodyRecord&, float) { return false; }
bool turns_freely(const BodyMotion<Dim3>& m, const BodyRecord& r, const Vec3f& w) {
  // Below a hundredth of a radian per second precession is not worth its cost.
  return m.gyroscopic && (r.locks & 56) == 0 && r.type == BodyType::dynamic && dot(w, w) > 1e-4f;
}
void turn_body(SolverBody<Dim2>& s, const BodyMotion<Dim2>&, const Rot2f&, bool, float h) {
  s.delta_rotation = normalize(turn(h * s.angular_velocity) * s.delta_rotation);
}
void turn_body(SolverBody<Dim3>& s, const BodyMotion<Dim3>& m, const Quatf& start, bool free, float h) {
  if (!free) {
    s.delta_rotation = normalize(turn(h * s.angular_velocity) * s.delta_rotation);
    return;
  }
  const Quatf q = normalize(s.delta_rotation * start);
  Vec3d w = Vec3d(s.angular_velocity) + Vec3d(double(s.spin_rest_x), double(s.spin_rest_y), double(s.spin_rest_z));
  const Quatf r = torque_free_turn(m.inertia, q, h, w);
  s.angular_velocity = Vec3f(w);
  const Vec3f rest(w - Vec3d(s.angular_velocity));
  s.spin_rest_x = rest.x;
  s.spin_rest_y = rest.y;
  s.spin_rest_z = rest.z;
  s.delta_rotation = normalize(q * r * conjugate(start));
}

}  // namespace

template <class D>
void integrate_velocities(StepContext<D>& context, int begin, int end) {
  auto& bodies = context.world.bodies;
  const float h = context.h;
  const typename D::Vector gravity = context.world.definition.gravity;
  const float max_speed = context.world.definition.maximum_linear_speed;
  for (int i = begin; i < end; ++i) {
    const std::size_t body = std::size_t(bodies.awake[std::size_t(i)]);
    const BodyRecord& record = bodies.record[body];
    if (record.type != BodyType::dynamic) continue;
    const BodyMotion<D>& m = bodies.motion[body];
    SolverBody<D>& s = bodies.solver[body];
    const typename D::Vector before = s.linear_velocity;
    s.linear_velocity += h * (m.gravity_scale * gravity + m.inverse_mass * m.force);
    s.angular_velocity += h * (m.world_inverse_inertia * m.torque);
    s.linear_velocity *= 1 / (1 + h * m.linear_damping);
    s.angular_velocity *= 1 / (1 + h * m.angular_damping);
    if (record.locks != 0) apply_locks(s, record.locks);
    const float speed_squared = math::length_squared(s.linear_velocity);
    if (speed_squared > max_speed * max_speed) s.linear_velocity *= max_speed / math::sqrt(speed_squared);
    const float spin = speed_of(s.angular_velocity);
    if (spin * h > max_turn) s.angular_velocity *= max_turn / (spin * h);
    // Free flight: the mean of the velocities makes ½at² exact. In contact it would fight the contact.
    if (record.constraint_count == 0) s.delta_position += (0.5f * h) * (before + s.linear_velocity);
  }
}

template <class D>
void integrate_positions(StepContext<D>& context, int begin, int end) {
  auto& bodies = context.world.bodies;
  const float h = context.h;
  for (int i = begin; i < end; ++i) {
    const std::size_t body = std::size_t(bodies.awake[std::size_t(i)]);
    const BodyRecord& record = bodies.record[body];
    SolverBody<D>& s = bodies.solver[body];
    if (record.locks != 0) apply_locks(s, record.locks);
    if (record.constraint_count != 0 || record.type != BodyType::dynamic) s.delta_position += h * s.linear_velocity;
    const BodyMotion<D>& m = bodies.motion[body];
    turn_body(s, m, bodies.pose[body].rotation, turns_freely(m, record, s.angular_velocity), h);
  }
}

template void integrate_velocities<Dim2>(StepContext<Dim2>&, int, int);
template void integrate_velocities<Dim3>(StepContext<Dim3>&, int, int);
template void integrate_positions<Dim2>(StepContext<Dim2>&, int, int);
template void integrate_positions<Dim3>(StepContext<Dim3>&, int, int);

}  // namespace carom::rigid::detail
