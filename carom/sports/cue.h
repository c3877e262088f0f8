// A cue strikes a ball: tip offset, squirt, elevation, miscue (chapter 19.4).
//
// The cue is a mass with a tip that slips or holds: impulse along the cue, its size from the elastic impact of the
// cue's mass on the ball at the offset. Squirt: D. G. Alciatore, TP A.31, from the mass of the cue's end alone.
#pragma once

#include "carom/sports/billiards.h"

namespace carom::sports {

struct Cue {
  double mass = 0.567;              ///< kg
  double end_mass = 0.170097 / 30;  ///< kg, of the shaft's end that moves aside during the impact: makes squirt
  double tip_friction = 0.7;        ///< beyond the cone of this friction the tip slips: a miscue
  double restitution = 1;           ///< of tip on ball
};

/// How the ball is struck. `side` and `height` are where the tip meets the ball, in units of R across the cue: side to
/// the striker's right, height up. √(side² + height²) < 1.
struct Stroke {
  double direction = 0;  ///< rad, of the aim seen from above: (cos, −sin) in (x, z), counterclockwise from x
  double speed = 2;      ///< m/s, of the cue
  double side = 0;       ///< tip offset a/R; right english is positive
  double height = 0;     ///< tip offset b/R; follow is positive, draw negative
  double elevation = 0;  ///< rad, of the butt above the horizon, 0 to below 90°
  /// The cue stays on the ball and holds it on the bed while it is struck (a massé), so that it does not hop.
  bool hold_down = false;
};

/// What the stroke gave.
struct CueImpact {
  math::Vec3d velocity{};          ///< m/s, right after the tip, before the bed answers
  math::Vec3d angular_velocity{};  ///< rad/s
  double squirt = 0;               ///< rad, from the line of aim, counterclockwise seen from above
  bool miscue = false;             ///< the tip slipped off
};

/// Errors: what is not finite, speed < 0, an offset that misses the ball, an elevation out of its range.
CAROM_API core::Result<CueImpact> strike_cue(const Stroke& stroke, const Cue& cue, const BilliardBall& ball);

/// tan⁻¹(2.5 a √(1 − a²)/(1 + m_r + 2.5 (1 − a²))) for the tip's offset a/R and the ball's mass over the end's.
CAROM_API double squirt_angle(double offset, double mass_ratio);

/// The direction of a stroke, for a way seen from above.
inline double aim_direction(math::Vec2d way) { return math::atan2(-way.y, way.x); }
inline math::Vec2d aim_vector(double direction) {
  const math::SinCos<double> s = math::sincos(direction);
  return {s.cos, -s.sin};
}

}  // namespace carom::sports
