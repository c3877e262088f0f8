// What several tests of ballistics fly.
#pragma once

#include "carom/ballistics/flight.h"
#include "carom/ballistics/motor.h"

namespace carom::ballistics::test {

/// Constant thrust (N) for a time (s); masses in kg.
inline Motor ideal_motor(double thrust, double time, double propellant, double casing) {
  return {.propellant_mass = propellant, .mass = propellant + casing, .curve = ThrustCurve::constant(thrust, time)};
}

/// Those of firing tables.
inline Conditions artillery() { return {.gravity = 9.80665, .gravity_model = GravityModel::inverse_square}; }

}  // namespace carom::ballistics::test
