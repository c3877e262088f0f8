// A body as the effectors see it: where it will be in the middle of the step.
//
// Forces that depend on position are taken at x + ½ v dt. With x' = x + v dt + ½ a dt² and v' = v + a dt that is the
// leapfrog in its drift–kick–drift form: of second order, and symplectic, so that orbits and floating bodies neither
// gain nor lose energy. Resistances are taken after all other forces, as the exact decay over the step (see `resist`).
#pragma once

#include "carom/environment/environment.h"
#include "carom/math/elementary.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

/// (1 − e^(−z))/z.
inline double mean_decay(double z) { return z > 1e-8 ? -math::expm1(-z) / z : 1 - 0.5 * z; }

template <class D>
struct EffectorBody {
  using Position = typename D::Position;  // double, also for vectors here
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  using AngularD = std::conditional_t<D::dimension == 2, double, Vec3d>;

  std::int32_t slot = none;
  Position center{};        ///< at mid-step
  typename D::Pose pose{};  ///< of the origin, at mid-step
  Position velocity{};      ///< at the start of the step
  AngularD spin{};
  double mass = 0, inverse_mass = 0;
  double dt = 0;  ///< s of its own time, as are the velocities

  EffectorBody(const WorldImplementation<D>& world, std::int32_t body, double step) : slot(body) {
    const std::size_t i = std::size_t(body);
    const double pace = double(world.bodies.pace(body));
    dt = step * pace;
    const BodyMotion<D>& motion = world.bodies.motion[i];
    const SolverBody<D>& state = world.bodies.solver[i];
    velocity = Position(state.linear_velocity) * (1 / pace);
    spin = AngularD(state.angular_velocity) * (1 / pace);
    mass = motion.mass;
    inverse_mass = motion.inverse_mass;
    center = motion.center + velocity * (0.5 * dt);
    pose.rotation = integrate(world.bodies.pose[i].rotation, state.angular_velocity * float(0.5 * step));
    pose.position = center - Position(rotate(pose.rotation, motion.local_center));
  }
};

template <class D>
void push(WorldImplementation<D>& world, const EffectorBody<D>& body, typename D::Position force) {
  world.bodies.motion[std::size_t(body.slot)].force += typename D::Vector(force);
}
template <class D>
void push_at(WorldImplementation<D>& world, const EffectorBody<D>& body, typename D::Position force,
             typename D::Position arm) {
  BodyMotion<D>& motion = world.bodies.motion[std::size_t(body.slot)];
  motion.force += typename D::Vector(force);
  motion.torque += typename D::Angular(cross(arm, force));
}

/// What all other forces, gravity included, do to the body: m/s².
template <class D>
typename D::Position other_acceleration(const WorldImplementation<D>& world, const EffectorBody<D>& body) {
  using Position = typename D::Position;
  const BodyMotion<D>& motion = world.bodies.motion[std::size_t(body.slot)];
  return Position(world.definition.gravity) * double(motion.gravity_scale) + Position(motion.force) * body.inverse_mass;
}

/// The force that makes a body with a linear resistance v̇ = a − k v follow the exact v(dt) = v e^(−k dt) +
/// a (1 − e^(−k dt))/k: stable for any k dt, and with the exact terminal speed. `v` is relative to the medium.
template <class D>
typename D::Position resist(const WorldImplementation<D>& world, const EffectorBody<D>& body, double k,
                            typename D::Position v) {
  const typename D::Position a = other_acceleration(world, body);
  return (mean_decay(k * body.dt) * (a - k * v) - a) * body.mass;
}

/// In the plane the environment is that at z = 0.
inline Vec3d place_of(Vec2d p) { return {p.x, p.y, 0}; }
inline Vec3d place_of(Vec3d p) { return p; }
inline Vec2d part_of(Vec3d v, Dim2*) { return {v.x, v.y}; }
inline Vec3d part_of(Vec3d v, Dim3*) { return v; }

/// Buoyancy and its drag on one body. `surroundings` may be null.
template <class D>
void float_body(WorldImplementation<D>& world, const Buoyancy<D>& water, const EffectorBody<D>& body, double time,
                const environment::Environment* surroundings);
/// The water that goes along with floating bodies takes its share of all the force on them: last of the effectors.
template <class D>
void apply_added_masses(WorldImplementation<D>& world, double dt);

/// Frees the effector's slot, and the joint of a spring.
template <class D>
void release_effector(WorldImplementation<D>& world, std::int32_t effector);

}  // namespace carom::rigid::detail
