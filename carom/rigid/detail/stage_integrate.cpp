#include "carom/rigid/detail/move_body.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

float speed_of(float w) { return math::abs(w); }
float speed_of(const Vec3f& w) { return math::length(w); }

}  // namespace

template <class D>
void prepare_drives(StepContext<D>& context) {
  const auto& bodies = context.world.bodies;
  const float h = context.h;
  const typename D::Vector gravity = context.world.definition.gravity;
  context.drives = context.arena.template allocate<BodyDrive<D>>(bodies.awake.size()).data();
  context.scheduler.parallel_for(int(bodies.awake.size()), 256, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      BodyDrive<D>& drive = *::new (static_cast<void*>(&context.drives[i])) BodyDrive<D>{};
      drive.body = bodies.awake[std::size_t(i)];
      const BodyRecord& record = bodies.record[std::size_t(drive.body)];
      const BodyMotion<D>& m = bodies.motion[std::size_t(drive.body)];
      drive.locks = record.locks;
      if (record.type != BodyType::dynamic) continue;
      drive.flags = BodyDrive<D>::dynamic;
      if (record.constraint_count == 0) drive.flags |= BodyDrive<D>::in_flight;
      if (may_turn_freely(m, record)) drive.flags |= BodyDrive<D>::gyroscopic;
      drive.linear_gain = h * (m.gravity_scale * gravity + m.inverse_mass * m.force);
      drive.angular_gain = h * (m.world_inverse_inertia * m.torque);
      drive.linear_keep = 1 / (1 + h * m.linear_damping);
      drive.angular_keep = 1 / (1 + h * m.angular_damping);
    }
  });
}

template <class D>
void integrate_velocities(StepContext<D>& context, int begin, int end) {
  const float h = context.h, max_speed = context.world.definition.maximum_linear_speed;
  for (int i = begin; i < end; ++i) {
    const BodyDrive<D>& drive = context.drives[i];
    if ((drive.flags & BodyDrive<D>::dynamic) == 0) continue;
    SolverBody<D>& s = context.bodies[drive.body];
    const typename D::Vector before = s.linear_velocity;
    s.linear_velocity += drive.linear_gain;
    s.angular_velocity += drive.angular_gain;
    s.linear_velocity *= drive.linear_keep;
    s.angular_velocity *= drive.angular_keep;
    if (drive.locks != 0) apply_locks(s, drive.locks);
    const float speed_squared = math::length_squared(s.linear_velocity);
    if (speed_squared > max_speed * max_speed) s.linear_velocity *= max_speed / math::sqrt(speed_squared);
    const float spin = speed_of(s.angular_velocity);
    if (spin * h > max_turn) s.angular_velocity *= max_turn / (spin * h);
    // Free flight: the mean of the velocities makes ½at² exact. In contact it would fight the contact.
    if ((drive.flags & BodyDrive<D>::in_flight) != 0)
      s.delta_position += (0.5f * h) * (before + s.linear_velocity);
    else
      context.flights[i] = {s.linear_velocity, before};
  }
}

template <class D>
void integrate_positions(StepContext<D>& context, int begin, int end) {
  const auto& bodies = context.world.bodies;
  const float h = context.h;
  for (int i = begin; i < end; ++i) {
    const BodyDrive<D>& drive = context.drives[i];
    SolverBody<D>& s = context.bodies[drive.body];
    if (drive.locks != 0) apply_locks(s, drive.locks);
    if ((drive.flags & BodyDrive<D>::in_flight) == 0) {
      // What others are near but do not touch flies too: nothing has changed its velocity.
      if ((drive.flags & BodyDrive<D>::dynamic) != 0 && s.linear_velocity == context.flights[i].after)
        s.delta_position += (0.5f * h) * (context.flights[i].before + s.linear_velocity);
      else
        s.delta_position += h * s.linear_velocity;
    }
    if ((drive.flags & BodyDrive<D>::gyroscopic) != 0 && spins(s.angular_velocity))
      turn_freely(s, bodies.motion[std::size_t(drive.body)], bodies.pose[std::size_t(drive.body)].rotation, h);
    else
      turn_body(s, h);
  }
}

template void prepare_drives<Dim2>(StepContext<Dim2>&);
template void prepare_drives<Dim3>(StepContext<Dim3>&);
template void integrate_velocities<Dim2>(StepContext<Dim2>&, int, int);
template void integrate_velocities<Dim3>(StepContext<Dim3>&, int, int);
template void integrate_positions<Dim2>(StepContext<Dim2>&, int, int);
template void integrate_positions<Dim3>(StepContext<Dim3>&, int, int);

}  // namespace carom::rigid::detail
