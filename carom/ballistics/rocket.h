// The flight of a rocket: stages, rail, fins, weathercocking, parachute (chapter 6.4). y is up.
#pragma once

#include <vector>

#include "carom/ballistics/flight.h"
#include "carom/ballistics/motor.h"

namespace carom::ballistics {

/// One stage: what burns together and is dropped together. Lengths are from the nose of the whole rocket (m).
struct Stage {
  Motor motor{};
  double dry_mass = 1;          ///< kg, without the motor
  double dry_centre = 0.5;      ///< m, centre of mass of the dry part
  double motor_centre = 0.9;    ///< m, centre of the motor and of its propellant
  double ignition_delay = 0;    ///< s after the stage below has burnt out (for the first: after launch)
  double separation_delay = 0;  ///< s after its own burnout at which it is dropped; the last one stays
};

/// A fin set, for the static stability by Barrowman.
struct Fins {
  int count = 3;
  double root_chord = 0.1, tip_chord = 0.05, span = 0.06, sweep = 0.04;  ///< m; sweep: of the leading edge
  double position = 0.9;                                                 ///< m, root leading edge from the nose
};

struct Parachute {
  double drag_area = 0;          ///< C_D A, m²; 0: none
  double deploy_height = 1e300;  ///< m: on the way down below it; by default at the apex
  double deploy_delay = 0;       ///< s after that
};

struct Rocket {
  std::vector<Stage> stages;  ///< the first to burn first
  double diameter = 0.05;     ///< m
  double length = 1;          ///< m, of the whole rocket: for its inertia as a slender rod
  double nose_length = 0.15;  ///< m, ogive
  Fins fins{};
  DragCurve drag{0.5};  ///< on the frontal area
  DragCurve coasting_drag{0.5};
  Parachute parachute{};
};

/// Normal-force slope (per rad, on the frontal area) and centre of pressure (m from the nose) of nose and fins.
/// J. S. Barrowman, The Practical Calculation of the Aerodynamic Characteristics of Slender Finned Vehicles, 1967.
struct Stability {
  double normal_slope = 0;
  double centre_of_pressure = 0;
};
CAROM_API Stability barrowman(const Rocket& rocket);

enum class RocketModel {
  point_mass,   ///< the axis is along the velocity through the air: an ideal fin
  six_degrees,  ///< the axis swings: fins turn it into the wind against its inertia
};

struct Launch {
  math::Vec3d position{};
  math::Vec3d direction{0, 1, 0};  ///< of the rail
  double rail_length = 1;          ///< m
};

enum class RocketEvent { ignition, rail_exit, burnout, separation, apex, parachute, landing };
CAROM_API const char* to_string(RocketEvent event);
struct RocketMoment {
  RocketEvent event{};
  int stage = 0;
  double time = 0;
  math::Vec3d position{}, velocity{};
};
struct RocketFlight {
  Trajectory path;
  std::vector<RocketMoment> events;  ///< in order of time
  std::vector<double> masses;        ///< kg at the path's nodes
  double largest_angle = 0;          ///< rad, of attack after the rail
  const RocketMoment* first(RocketEvent event) const {
    for (const RocketMoment& moment : events)
      if (moment.event == event) return &moment;
    return nullptr;
  }
};

/// From the rail to the ground (`limits.ground`) or the time limit. It stands on the pad while the thrust is too weak.
/// Errors name the stage and the field that cannot be.
CAROM_API core::Result<RocketFlight> fly_rocket(const Rocket& rocket, const Conditions& conditions,
                                                const Launch& launch, RocketModel model = RocketModel::point_mass,
                                                const FlightLimits& limits = {.ground = 0});

}  // namespace carom::ballistics
