// World's members that push bodies. Forces wait for the next step, impulses act at once.
#pragma once

#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/check.h"

namespace carom::rigid {
namespace detail {

/// The dynamic body named by the handle; wakes it when all is well.
template <class D>
Result<std::int32_t> pushed_body(WorldImplementation<D>& world, std::string_view call, BodyId body) {
  const Status status = world.bodies.slots.check(body, "body");
  if (!status.ok()) return core::Error{core::text("World::", call, ": ", status.error().message)};
  const std::int32_t slot = world.bodies.slots.slot(body);
  if (!world.bodies.is_dynamic(slot))
    return core::Error{core::text("World::", call, ": the body is not dynamic, expected a dynamic body")};
  return slot;
}

template <class D, class Amount>
Status add_load(WorldImplementation<D>& world, std::string_view call, BodyId body, const Amount* linear,
                const typename D::Angular* angular, const typename D::Position* point, std::string_view field) {
  const Result<std::int32_t> slot = pushed_body(world, call, body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::", call);
  if (linear != nullptr) check_size(complaint, field, *linear, max_force);
  if (angular != nullptr) check_size(complaint, field, *angular, max_force);
  if (point != nullptr) check_size(complaint, "point", *point, max_coordinate);
  if (!complaint.none_yet()) return complaint.error();
  BodyMotion<D>& m = world.bodies.motion[std::size_t(*slot)];
  const typename D::Vector f = linear != nullptr ? typename D::Vector(*linear) : typename D::Vector{};
  typename D::Angular t = angular != nullptr ? *angular : typename D::Angular{};
  if (point != nullptr) t = t + cross(typename D::Vector(*point - m.center), f);
  const typename D::Vector force = m.force + f;
  const typename D::Angular torque = m.torque + t;
  if (!is_finite(force) || !is_finite(torque))
    complaint.say(core::text(field, " makes the sum on the body overflow, expected a finite sum"));
  if (!complaint.none_yet()) return complaint.error();
  wake_body(world, *slot);
  m.force = force;
  m.torque = torque;
  return {};
}

template <class D>
Status add_kick(WorldImplementation<D>& world, std::string_view call, BodyId body, const typename D::Vector* linear,
                const typename D::Angular* angular, const typename D::Position* point) {
  const Result<std::int32_t> slot = pushed_body(world, call, body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::", call);
  if (linear != nullptr) check_size(complaint, "impulse", *linear, max_force);
  if (angular != nullptr) check_size(complaint, "impulse", *angular, max_force);
  if (point != nullptr) check_size(complaint, "point", *point, max_coordinate);
  if (!complaint.none_yet()) return complaint.error();
  // A body at rest may hold the tensor of where it last moved.
  update_world_inertia(world, *slot);
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(*slot)];
  SolverBody<D>& s = world.bodies.solver[std::size_t(*slot)];
  const typename D::Vector p = linear != nullptr ? *linear : typename D::Vector{};
  typename D::Angular t = angular != nullptr ? *angular : typename D::Angular{};
  if (point != nullptr) t = t + cross(typename D::Vector(*point - m.center), p);
  const typename D::Vector v = s.linear_velocity + m.inverse_mass * p;
  const typename D::Angular w = s.angular_velocity + m.world_inverse_inertia * t;
  check_size(complaint, "velocity after the impulse", v, max_velocity);
  check_size(complaint, "angular velocity after the impulse", w, max_velocity);
  if (!complaint.none_yet()) return complaint.error();
  wake_body(world, *slot);
  s.linear_velocity = v;
  s.angular_velocity = w;
  return {};
}

}  // namespace detail

template <class D>
Status World<D>::add_force(BodyId body, Vector force) {
  return detail::add_load<D, Vector>(*self_, "add_force", body, &force, nullptr, nullptr, "force");
}
template <class D>
Status World<D>::add_force_at(BodyId body, Vector force, Position point) {
  return detail::add_load<D, Vector>(*self_, "add_force_at", body, &force, nullptr, &point, "force");
}
template <class D>
Status World<D>::add_torque(BodyId body, Angular torque) {
  return detail::add_load<D, Vector>(*self_, "add_torque", body, nullptr, &torque, nullptr, "torque");
}
template <class D>
Status World<D>::add_impulse(BodyId body, Vector impulse) {
  return detail::add_kick(*self_, "add_impulse", body, &impulse, nullptr, nullptr);
}
template <class D>
Status World<D>::add_impulse_at(BodyId body, Vector impulse, Position point) {
  return detail::add_kick(*self_, "add_impulse_at", body, &impulse, nullptr, &point);
}
template <class D>
Status World<D>::add_angular_impulse(BodyId body, Angular impulse) {
  return detail::add_kick(*self_, "add_angular_impulse", body, static_cast<const Vector*>(nullptr), &impulse,
                          static_cast<const Position*>(nullptr));
}

}  // namespace carom::rigid
