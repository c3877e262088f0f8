// World's members that push bodies. Forces wait for the next step, impulses act at once.
#pragma once

#include <algorithm>

#include "carom/geometry/query.h"
#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/check.h"
#include "carom/rigid/detail/load_account.h"

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
  BodyMotion<D>& m = world.bodies.motion[std::size_t(*slot)];
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
  forget_load(world, *slot, v - s.linear_velocity);
  s.linear_velocity = v;
  s.angular_velocity = w;
  return {};
}

/// The area (2D: length) of the shape's own box as seen along `direction` (unit, shape frame).
inline float seen_area(const geometry::Shape2& shape, const Vec2f& direction) {
  const Vec2f half = geometry::bounds(shape, {}).extents();
  return 2 * (half.x * math::abs(direction.y) + half.y * math::abs(direction.x));
}
inline float seen_area(const geometry::Shape3& shape, const Vec3f& direction) {
  if (shape.type == geometry::ShapeType3::sphere) return pi_f * shape.sphere.radius * shape.sphere.radius;
  const Vec3f half = geometry::bounds(shape, {}).extents();
  return 4 * (half.y * half.z * math::abs(direction.x) + half.x * half.z * math::abs(direction.y) +
              half.x * half.y * math::abs(direction.z));
}
inline geometry::Shape2 point_shape(Dim2) { return geometry::Circle{1e-4f}; }
inline geometry::Shape3 point_shape(Dim3) { return geometry::Sphere{1e-4f}; }

}  // namespace detail

template <class D>
Result<int> World<D>::explode(const ExplosionDef<D>& d) {
  using namespace detail;
  Complaint complaint("World::explode");
  check_size(complaint, "center", d.center, max_coordinate);
  check_range(complaint, "radius", d.radius, 0, max_size);
  check_range(complaint, "falloff", d.falloff, 0, max_size);
  check_range(complaint, "impulse_per_area", d.impulse_per_area, -max_force, max_force);
  check_range(complaint, "speed", d.speed, -max_velocity, max_velocity);
  if (!complaint.none_yet()) return complaint.error();
  const float reach = d.radius + d.falloff;
  std::vector<std::int32_t> near;
  self_->shapes.trees[tree_dynamic].query(
      geometry::grow(typename D::Bounds{d.center, d.center}, double(reach)), [&](std::uint32_t item) {
        const ShapeRecord<D>& shape = self_->shapes.at(std::int32_t(item));
        if ((shape.flags & shape_sensor) == 0 && (self_->shapes.terms_of(shape).filter.category & d.mask) != 0)
          near.push_back(std::int32_t(item));
        return true;
      });
  std::sort(near.begin(), near.end(), [&](std::int32_t a, std::int32_t b) {
    const std::int32_t body_a = self_->shapes.at(a).body, body_b = self_->shapes.at(b).body;
    return body_a != body_b ? body_a < body_b : a < b;
  });
  int count = 0;
  std::int32_t last_pushed = none;
  for (const std::int32_t s : near) {
    const ShapeRecord<D>& shape = self_->shapes.at(s);
    const typename D::Pose pose = shape_pose(*self_, shape);
    const Vector center = local_point(pose, d.center);
    const auto gap = geometry::distance(shape.geometry, point_shape(D{}), typename D::Transform{center, {}});
    if (gap.distance > reach) continue;
    const float strength = gap.distance <= d.radius || !(d.falloff > 0) ? 1 : (reach - gap.distance) / d.falloff;
    const BodyMotion<D>& motion = self_->bodies.motion[std::size_t(shape.body)];
    // From inside a shape, outward means away from its centre of mass.
    Vector out =
        gap.distance > 0 ? gap.point_a - center : inverse_rotate(pose.rotation, Vector(motion.center - d.center));
    const float length = math::length(out);
    if (!(length > 1e-6f)) continue;
    out = out * (1 / length);
    const float push = d.impulse_per_area * strength * seen_area(shape.geometry, out);
    const Vector direction = rotate(pose.rotation, out);
    const Position point = gap.distance > 0 ? world_point(pose, gap.point_a) : motion.center;
    // Speed is given to a body once, by its first shape.
    const float speed = shape.body == last_pushed ? 0 : d.speed * strength;
    const Vector impulse = direction * push;
    const Vector kick = direction * (speed * motion.mass);
    const BodyId body = self_->bodies.slots.handle_at(shape.body);
    bool felt = push != 0 && add_kick<D>(*self_, "explode", body, &impulse, nullptr, &point).ok();
    if (speed != 0 && add_kick<D>(*self_, "explode", body, &kick, nullptr, nullptr).ok()) felt = true;
    last_pushed = shape.body;
    count += felt ? 1 : 0;
  }
  return count;
}

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
