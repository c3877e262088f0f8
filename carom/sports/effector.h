// Joins a ball's aerodynamics to a body of a world.
#pragma once

#include "carom/rigid/effector.h"
#include "carom/sports/flight.h"

namespace carom::sports {

/// Drag, lift, side force and loss of spin of `body` (a sphere of the ball's mass and radius) in the air and wind of
/// `conditions`; gravity stays the world's. The world's step follows the flight that `fly` integrates with an error of
/// the order of its square. A turning seam is read from the body's attitude, so it starts at the identity.
CAROM_API rigid::CustomEffector<rigid::Dim3> flight_effector(const Ball& ball, const Conditions& conditions,
                                                             rigid::BodyId body);

}  // namespace carom::sports
