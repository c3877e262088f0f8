// World's members that change a body after its making.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/detail/load_account.h"
#include "carom/rigid/detail/world_bodies.inl"

namespace carom::rigid {

template <class D>
Status World<D>::set_pose(BodyId body, Position position, Rotation rotation) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_pose", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_pose");
  check_size(complaint, "position", position, max_coordinate);
  complaint.rotation("rotation", rotation);
  if (!complaint.none_yet()) return complaint.error();
  wake_body(*self_, *slot);
  wake_touching(*self_, *slot);
  const Position way = position - self_->bodies.pose[std::size_t(*slot)].position;
  // Kept manifolds take any way along their normal for depth, right through what is there.
  if (math::length(way) > double(self_->bodies.motion[std::size_t(*slot)].inner_extent))
    for (std::int32_t key = self_->bodies.record[std::size_t(*slot)].first_contact; key != none;
         key = self_->contacts.at(key >> 1).next[key & 1])
      look_anew(*self_, self_->contacts.at(key >> 1));
  self_->bodies.pose[std::size_t(*slot)] = {position, unit_rotation(rotation)};
  center_from_pose(*self_, *slot);
  // What is set from place to place has gone no way in between.
  const std::size_t place = std::size_t(self_->bodies.record[std::size_t(*slot)].awake_index);
  if (place < self_->scratch.swept.size())
    self_->scratch.swept[place] = {
        self_->bodies.pose[std::size_t(*slot)].rotation, self_->bodies.motion[std::size_t(*slot)].center, {}, 1};
  update_world_inertia(*self_, *slot);
  refresh_bounds(*self_, *slot, way);
  return {};
}

template <class D>
Status World<D>::set_velocity(BodyId body, Vector linear, Angular angular) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_velocity", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_velocity");
  check_size(complaint, "linear", linear, max_velocity);
  check_size(complaint, "angular", angular, max_velocity);
  if (!complaint.none_yet()) return complaint.error();
  if (self_->bodies.is_fixed(*slot))
    return core::Error{"World::set_velocity: the body is fixed, expected one that moves"};
  const SolverBody<D>& now = self_->bodies.solver[std::size_t(*slot)];
  const bool stood = now.linear_velocity == Vector{} && now.angular_velocity == Angular{};
  if (!(linear == Vector{} && angular == Angular{})) {
    wake_body(*self_, *slot);
    // What fell asleep on a platform is to go with it when it starts.
    if (stood && !self_->bodies.is_dynamic(*slot)) wake_touching(*self_, *slot);
  }
  forget_load(*self_, *slot, linear - now.linear_velocity);
  self_->bodies.solver[std::size_t(*slot)].linear_velocity = linear;
  self_->bodies.solver[std::size_t(*slot)].angular_velocity = angular;
  return {};
}

namespace detail {
inline float turn_between(const Rot2f& from, const Rot2f& to) {
  const Rot2f d = to * conjugate(from);
  return math::atan2(d.s, d.c);
}
inline Vec3f turn_between(const Quatf& from, const Quatf& to) {
  Quatf d = to * conjugate(from);
  if (d.w < 0) d = -d;
  const float s = math::length(d.vector());
  return s < 1e-12f ? 2.0f * d.vector() : d.vector() * (2 * math::atan2(s, d.w) / s);
}
}  // namespace detail

template <class D>
Status World<D>::set_target_pose(BodyId body, Position position, Rotation rotation, float dt) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_target_pose", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_target_pose");
  check_size(complaint, "position", position, max_coordinate);
  complaint.rotation("rotation", rotation);
  if (!(dt > 0 && dt <= 1e6f)) complaint.say(core::refused("dt", dt, "a time above 0 and at most 1e6 s"));
  if (!complaint.none_yet()) return complaint.error();
  if (self_->bodies.record[std::size_t(*slot)].type != BodyType::kinematic)
    return core::Error{"World::set_target_pose: the body is not kinematic, expected a kinematic body"};
  const Pose& now = self_->bodies.pose[std::size_t(*slot)];
  const BodyMotion<D>& m = self_->bodies.motion[std::size_t(*slot)];
  const Rotation q = normalize(rotation);
  const Position center = position + Position(rotate(q, m.local_center));
  const Vector linear = Vector((center - m.center) / double(dt));
  const Angular angular = turn_between(now.rotation, q) * (1 / dt);
  check_size(complaint, "speed to the target", linear, max_velocity);
  if (!complaint.none_yet()) return complaint.error();
  return set_velocity(body, linear, angular);
}

template <class D>
Status World<D>::set_type(BodyId body, BodyType type) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_type", body);
  if (!slot.ok()) return slot.error();
  if (type != BodyType::fixed && type != BodyType::kinematic && type != BodyType::dynamic)
    return core::Error{core::text("World::set_type: type is ", int(type), ", expected fixed, kinematic or dynamic")};
  BodyRecord& r = self_->bodies.record[std::size_t(*slot)];
  if (r.type == type) return {};
  for (std::int32_t s = r.first_shape; s != none; s = self_->shapes.at(s).next) {
    const ShapeRecord<D>& shape = self_->shapes.at(s);
    if (type == BodyType::dynamic)
      if (const Status status = check_dynamic(shape.geometry, self_->shapes.terms_of(shape).density); !status.ok())
        return core::Error{core::text("World::set_type: ", status.error().message)};
    if (const std::int32_t other =
            clashing_surface(*self_, *slot, type, shape.geometry, self_->shapes.terms_of(shape).filter);
        (shape.flags & shape_sensor) == 0 && other != none)
      return core::Error{core::text("World::set_type: ", clash_message(other))};
  }
  with_joints_detached(*self_, *slot, [&] {
    take_out(*self_, *slot);
    for (std::int32_t s = r.first_shape; s != none; s = self_->shapes.at(s).next) {
      ShapeRecord<D>& shape = self_->shapes.at(s);
      if (!is_surface(shape.geometry)) continue;
      self_->shapes.moving_surfaces += (type != BodyType::fixed) - (r.type != BodyType::fixed);
      const bool thin = type != BodyType::fixed && is_mesh(shape.geometry);
      shape.inner_extent = thin ? mesh_thickness(shape.geometry) : shape.outer_extent;
    }
    self_->bodies.record[std::size_t(*slot)].type = type;
    if (type == BodyType::fixed) self_->bodies.solver[std::size_t(*slot)] = {};
    update_mass(*self_, *slot);
    put_back(*self_, *slot);
  });
  return {};
}

template <class D>
Status World<D>::set_awake(BodyId body, bool awake) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_awake", body);
  if (!slot.ok()) return slot.error();
  const BodyRecord& r = self_->bodies.record[std::size_t(*slot)];
  if (awake) {
    wake_body(*self_, *slot);
  } else if (r.awake_index != none) {
    std::vector<std::int32_t> island = island_of(*self_, *slot);
    put_to_sleep<D>(*self_, island);
  }
  return {};
}

template <class D>
Status World<D>::set_enabled(BodyId body, bool enabled) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_enabled", body);
  if (!slot.ok()) return slot.error();
  if (self_->bodies.record[std::size_t(*slot)].enabled() == enabled) return {};
  with_joints_detached(*self_, *slot, [&] {
    if (!enabled) take_out(*self_, *slot);
    set_flag(self_->bodies.record[std::size_t(*slot)], body_enabled, enabled);
    if (enabled) put_back(*self_, *slot);
  });
  return {};
}

template <class D>
Status World<D>::set_locks(BodyId body, MotionLocks locks) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_locks", body);
  if (!slot.ok()) return slot.error();
  wake_body(*self_, *slot);
  self_->bodies.record[std::size_t(*slot)].locks = lock_bits(locks);
  update_mass(*self_, *slot);
  return {};
}

template <class D>
Status World<D>::set_damping(BodyId body, float linear, float angular) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_damping", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_damping");
  check_range(complaint, "linear", linear, 0, 1e6);
  check_range(complaint, "angular", angular, 0, 1e6);
  if (!complaint.none_yet()) return complaint.error();
  self_->bodies.motion[std::size_t(*slot)].linear_damping = linear;
  self_->bodies.motion[std::size_t(*slot)].angular_damping = angular;
  return {};
}

template <class D>
Status World<D>::set_substeps(BodyId body, int substeps) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_substeps", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_substeps");
  check_range(complaint, "substeps", substeps, 0, 64);
  if (!complaint.none_yet()) return complaint.error();
  BodyRecord& record = self_->bodies.record[std::size_t(*slot)];
  self_->bodies.substep_wishes += (substeps > 0 ? 1 : 0) - (record.substeps > 0 ? 1 : 0);
  record.substeps = std::uint8_t(substeps);
  return {};
}

template <class D>
Status World<D>::set_gravity_scale(BodyId body, float scale) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_gravity_scale", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_gravity_scale");
  check_range(complaint, "scale", scale, -1e6, 1e6);
  if (!complaint.none_yet()) return complaint.error();
  wake_body(*self_, *slot);
  self_->bodies.motion[std::size_t(*slot)].gravity_scale = scale;
  return {};
}

template <class D>
Status World<D>::set_time_scale(BodyId body, float scale) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_time_scale", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_time_scale");
  check_range(complaint, "scale", scale, 1e-3, 1e3);
  if (!complaint.none_yet()) return complaint.error();
  const float before = self_->bodies.pace(*slot);
  if (scale == before) return {};
  wake_body(*self_, *slot);
  self_->bodies.set_pace(*slot, scale);
  if (!self_->bodies.is_dynamic(*slot)) return {};
  SolverBody<D>& s = self_->bodies.solver[std::size_t(*slot)];
  const Vector linear = s.linear_velocity * (scale / before);
  forget_load(*self_, *slot, linear - s.linear_velocity);
  s.linear_velocity = linear;
  s.angular_velocity = s.angular_velocity * (scale / before);
  return {};
}

template <class D>
Status World<D>::set_user_data(BodyId body, std::uint64_t data) {
  const Result<std::int32_t> slot = detail::slot_of(*self_, "set_user_data", body);
  if (!slot.ok()) return slot.error();
  detail::give_word(self_->bodies.user_data, *slot, data);
  return {};
}

}  // namespace carom::rigid
