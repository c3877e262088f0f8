// Billiards among rigid bodies: what the contacts of a world do not know of a table.
//
// A ball there is a sphere, the bed a box; the pair of their materials has μ_s as friction, μ_sp as spinning resistance
// and no rolling resistance, which comes from the effector. Friction between balls comes from a contact modifier
// (`ball_friction` of billiards.h), cushions from `meet_cushions` after every step. docs/billiards.md tells how near
// that comes to shots that are computed from event to event.
#pragma once

#include "carom/rigid/effector.h"
#include "carom/sports/billiards.h"
#include "carom/sports/table.h"

namespace carom::sports {

/// The cloth under a ball: while it rolls it slows down by μ_r g. While it slides nothing acts but the friction of the
/// contact; a rolling resistance of the materials would turn it then as well. `step` (s) is the length of the world's
/// steps, `bed` (m) the height of the bed. Balls roll on slowly at the end: a BodyDef::sleep_speed of .005 m/s lets
/// them.
CAROM_API rigid::CustomEffector<rigid::Dim3> cloth_effector(const BilliardPhysics& physics, rigid::BodyId body,
                                                            double step, double bed = 0);

/// After a step, in the table's frame: a ball on the bed that has gone beyond a nose is struck by the cushion's law at
/// the moment when it reached it, and has gone on from there since. The noses need no shapes in the world then. Returns
/// the approach speed (m/s), 0 where it met nothing.
CAROM_API double meet_cushions(BilliardState& state, const BilliardTable& table, const BilliardPhysics& physics);

}  // namespace carom::sports
