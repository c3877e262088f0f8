// What a step reports after it, as ordered arrays that stay valid until the next call that changes the world.
#pragma once

#include "carom/rigid/definitions.h"

namespace carom::rigid {

struct ContactBeginEvent {
  ShapeId shape_a, shape_b;
  std::uint32_t material_a = 0, material_b = 0;  ///< Material::user_id of the parts that met
};
struct ContactEndEvent {
  ShapeId shape_a, shape_b;  ///< may no longer exist
};
/// An impact faster than WorldDef::restitution_threshold, with the impulse that the solver really applied.
template <class D>
struct ContactHitEvent {
  ShapeId shape_a, shape_b;
  std::uint32_t material_a = 0, material_b = 0;  ///< Material::user_id of the parts that met
  typename D::Position point{};
  typename D::Vector normal{};  ///< from A to B
  float approach_speed = 0;     ///< m/s
  float slip_speed = 0;         ///< m/s across the surface when they met
  float impulse = 0;            ///< N·s over the step
};
struct SensorEvent {
  ShapeId sensor, visitor;
};
struct SleepEvent {
  BodyId body;
};
/// Where an awake body is after the step, for who mirrors poses elsewhere (WorldDef::move_events).
template <class D>
struct MoveEvent {
  BodyId body;
  typename D::Pose pose{};
};

/// What a contact modifier sees of a patch of contact between two shapes, and what it may change for this step.
template <class D>
struct ContactModification {
  ShapeId shape_a, shape_b;
  std::uint32_t material_a = 0, material_b = 0;  ///< Material::user_id of the parts that touch
  typename D::Vector normal{};                   ///< from A to B, world
  typename D::Vector relative_velocity{};        ///< m/s of B against A, at the middle of the points
  int count = 0;
  struct Point {
    typename D::Position point{};
    float separation = 0;  ///< m
  } points[D::max_points];

  bool enabled = true;    ///< false: nothing is pushed in this step
  float friction = 0;     ///< out of range or not a number: stays as mixed
  float restitution = 0;  ///< likewise
};

/// A joint gave way (JointFrames::break_force, break_torque) and is gone.
template <class D>
struct JointBreakEvent {
  JointId joint;  ///< no longer exists
  BodyId body_a, body_b;
  typename D::Vector force{};    ///< N, on B, in the last substep
  typename D::Angular torque{};  ///< N·m, on B
};
/// A spring gave way (SpringDamper::break_force) and is gone.
template <class D>
struct SpringBreakEvent {
  EffectorId spring;  ///< no longer exists
  BodyId body_a, body_b;
  typename D::Vector force{};  ///< N, on A, in the last substep
};

template <class D>
struct Events {
  std::span<const ContactBeginEvent> contact_begin;
  std::span<const ContactEndEvent> contact_end;
  std::span<const ContactHitEvent<D>> contact_hit;
  std::span<const SensorEvent> sensor_begin;
  std::span<const SensorEvent> sensor_end;
  std::span<const SleepEvent> fell_asleep;
  std::span<const SleepEvent> quarantined;  ///< bodies whose state became NaN or infinite: frozen, and named here
  std::span<const MoveEvent<D>> moved;      ///< of all bodies that were awake, if WorldDef::move_events
  std::span<const JointBreakEvent<D>> joint_break;
  std::span<const SpringBreakEvent<D>> spring_break;
};

}  // namespace carom::rigid
