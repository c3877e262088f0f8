// What the demos of this folder share: markers that only are looked at, and lines through points.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/ballistics/flight.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_trajectory_lab();
std::unique_ptr<Demo> make_rocket_launch();
std::unique_ptr<Demo> make_artillery();
std::unique_ptr<Demo> make_shooting_range();
std::unique_ptr<Demo> make_turret();
std::unique_ptr<Demo> make_ballistic_pendulum();

/// The text of presets/motor/black_powder.eng: compiled in (motors.cpp.in), as a demo has no files where it runs.
std::string_view black_powder_motors();

/// A body that follows a path of a model and touches nothing.
inline rigid::BodyId add_marker(Stage3& stage, std::string_view name, const geometry::Shape3& shape, Vec3d position,
                                std::uint32_t color) {
  rigid::BodyDef<rigid::Dim3> body;
  body.type = rigid::BodyType::kinematic;
  body.name = name;
  body.position = position;
  rigid::ShapeDef<rigid::Dim3> definition;
  definition.filter.mask = 0;
  return stage.add(body, shape, definition, color);
}

/// The turn that brings y to a unit vector d.
inline Quatf turn_of_y(Vec3d d) {
  if (d.y < -0.999999) return {0, 1, 0, 0};
  return Quatf(normalize(Quatd{1 + d.y, cross(Vec3d{0, 1, 0}, d)}));
}

/// Every point of a trajectory, or as many as lines allow.
inline void draw_flight(StageBase& stage, const ballistics::Trajectory& flight, double until, std::uint32_t rgba,
                        int pieces = 60) {
  const double end = min(until, flight.duration());
  Vec3d last = flight.at(0).position;
  for (int i = 1; i <= pieces; ++i) {
    const Vec3d next = flight.at(end * i / pieces).position;
    stage.line(last, next, rgba);
    last = next;
  }
}

}  // namespace carom::host::demo
