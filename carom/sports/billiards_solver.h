// Which stroke sends this ball there (chapter 19.8): the aim that pots a ball, banks it off a cushion, kicks at it, or
// brings it to rest at a place.
//
// The solver asks the engine itself: throw, squirt, swerve, slide and the cushions' answer are compensated because they
// happen in its trials. Over the angles at which the cue ball meets the object ball it looks for changes of sign of the
// side on which the object ball passes the goal, closes in on each, and then plays the stroke on the whole table. What
// does not come true there is no solution.
#pragma once

#include <optional>

#include "carom/sports/billiards_engine.h"

namespace carom::sports {

struct ShotGoal {
  int object = 1;           ///< the ball to be sent
  int pocket = -1;          ///< into this pocket; −1: to `place`
  math::Vec2d place{};      ///< m, (x, z): there it is to come to rest
  double tolerance = 0.01;  ///< m, from the place
  int object_cushions = 0;  ///< 0 or 1: so many cushions the object ball touches first (a bank)
  int cue_cushions = 0;     ///< 0 or 1: so many cushions the cue ball touches before it meets the ball (a kick)
};

struct ShotOptions {
  int cue_ball = 0;
  double side = 0, height = 0, elevation = 0;  ///< the tip, as in `Stroke`
  double slowest = 0.4, fastest = 6;           ///< m/s, of the cue
  int speeds = 8;                              ///< tried between them, slowest first
  double arrival = 0.3;                        ///< m/s, at least this fast into a pocket
  bool keep_cue_ball = true;                   ///< no solution where the cue ball falls or leaves the table
  Cue cue{};
};

struct ShotSolution {
  Stroke stroke{};
  double miss = 0;    ///< m: how far beside its aim point the object ball passes; for a place: how far from it it rests
  double window = 0;  ///< rad: the aim may be off by this to either side and the ball still falls (0 for a place)
  double arrival = 0;  ///< m/s, of the object ball at the pocket
};

/// Empty: no stroke with that tip and within those speeds does it. Errors: balls or a pocket that are not there, balls
/// that move, cushions other than 0 or 1, options that cannot be.
CAROM_API core::Result<std::optional<ShotSolution>> solve_shot(const Billiards& layout, const ShotGoal& goal,
                                                               const ShotOptions& options = {});

/// The ball that a straight, thrown-free shot would aim at: where the cue ball's centre must be when it meets the
/// object ball, for it to leave toward `goal`.
inline math::Vec2d ghost_ball(math::Vec2d object, math::Vec2d goal, double radius) {
  return object - 2 * radius * normalize(goal - object);
}

}  // namespace carom::sports
