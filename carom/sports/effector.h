// Joins a ball's aerodynamics to a body of a world.
#pragma once

#include "carom/rigid/effector.h"
#include "carom/sports/flight.h"

namespace carom::sports {

/// Drag, lift, side force and loss of spin of `body` (a sphere of the ball's mass and radius) in the air and wind of
/// the world's Surroundings and its Wind, or of `conditions` where the world has none or these are its own; gravity
/// stays the world's. With `step`, the length of the world's steps (s), the force is that of the middle of the step,
/// foretold from its start, and the body follows the flight that `fly` integrates with an error of the order of the
/// step's square; with 0 of its first power. A turning seam is read from the body's attitude, so it starts at the
/// identity. Where `held_spin` (rad/s) is given, a held seam steers as long as the ball spins about that axis, to
/// within 60°: what turns it, as a pitch does, scrambles the seam.
CAROM_API rigid::CustomEffector<rigid::Dim3> flight_effector(const Ball& ball, const Conditions& conditions,
                                                             rigid::BodyId body, double step = 0, bool own_air = false,
                                                             bool own_wind = false, Vec3d held_spin = {});

}  // namespace carom::sports
