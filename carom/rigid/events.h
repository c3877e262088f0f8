// What a step reports after it, as ordered arrays that stay valid until the next call that changes the world.
#pragma once

#include "carom/rigid/definitions.h"

namespace carom::rigid {

struct ContactBeginEvent {
  ShapeId shape_a, shape_b;
};
struct ContactEndEvent {
  ShapeId shape_a, shape_b;  ///< may no longer exist
};
/// An impact above the world's hit threshold, with the impulse that the solver really applied.
template <class D>
struct ContactHitEvent {
  ShapeId shape_a, shape_b;
  typename D::Position point{};
  typename D::Vector normal{};  ///< from A to B
  float approach_speed = 0;     ///< m/s
  float impulse = 0;            ///< N·s over the step
};
struct SensorEvent {
  ShapeId sensor, visitor;
};
struct SleepEvent {
  BodyId body;
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
};

}  // namespace carom::rigid
