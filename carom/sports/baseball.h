// Baseball: the bat, the hit and the pitch (chapter 19), and the public trajectory calculator of A. M. Nathan.
#pragma once

#include "carom/sports/flight.h"

namespace carom::sports {

/// What the calculator asks for, in its own units: exit speed (mph), launch and spray angles (deg, spray positive
/// toward right field), height (ft), right-handed batter or not.
struct CalculatorInput {
  double exit_speed = 100, launch_angle = 28, spray_angle = 0;
  bool right_handed = true;
  double height = 3;
};
/// In feet and seconds, x toward right field, y toward centre field.
struct CalculatorResult {
  double distance = 0, time = 0, x = 0, y = 0;
};
enum class CalculatorMode {
  sheet,      ///< steps of .01 s by Euler's method with ½ a dt², as the sheet does: .7 to .9 ft short of its equation
  converged,  ///< the same equation, integrated to 1e-10
};
/// A. M. Nathan, trajectory calculator (June 2026 edition): C_D .3008 + .0292 rpm/1000, C_L 1.12 S/(.583 + 2.333 S),
/// spin by the launch and spray angles, K .005316103027433 1/ft (75 °F, 29.92 inHg, 50 %). Errors: input that is not
/// finite, or a ball that does not come down within 60 s.
CAROM_API core::Result<CalculatorResult> trajectory_calculator(const CalculatorInput& input, CalculatorMode mode);

/// A pitch as broadcasters tell it.
struct Pitch {
  double speed = 42;          ///< m/s at release
  double elevation = -0.02;   ///< rad
  double azimuth = 0;         ///< rad, to the right as the pitcher sees it
  double spin = 230;          ///< rad/s
  double tilt = 0;            ///< rad: 0 backspin (fastball), π topspin (curve), ± π/2 sideways (slider)
  double gyro = 0;            ///< rad/s, spin about the way, which does not curve it
  Vec3d release{0, 1.83, 0};  ///< m, x toward the plate
};
struct PitchResult {
  BallFlight path;
  double time = 0;              ///< s to the front of the plate
  double speed = 0;             ///< m/s there
  double height = 0, side = 0;  ///< m, where it crosses
  double rise = 0, run = 0;     ///< m: break against the same pitch without spin (induced vertical, horizontal)
};
/// From the release to the front of home plate, `distance` m down x (60 ft 6 in less the stride: 16.76 m).
/// Errors: a pitch that does not arrive.
CAROM_API core::Result<PitchResult> pitch(const Ball& ball, const Conditions& conditions, const Pitch& pitch,
                                          double distance = 16.764);

/// The same pitch aimed so that it crosses the front of the plate `height` m up and `side` m to the right, to a
/// millimetre. Errors as `pitch`; a place out of reach.
CAROM_API core::Result<Pitch> aimed(const Ball& ball, const Conditions& conditions, const Pitch& pitch, double height,
                                    double side, double distance = 16.764);

/// A bat, swung level or up, as its point of impact sees it.
struct Bat {
  double effective_mass = 0.70;  ///< kg, what a ball meets at the sweet spot
  double radius = 0.0333;        ///< m of the barrel (2 5/8 in)
  double restitution = 0.50;     ///< ball on bat at game speeds; the ball's own COR is .546 ± .032 at 60 mph
  double friction = 0.5;
  double tangential_restitution = 0;
};
struct BatSwing {
  double speed = 31;      ///< m/s at the impact
  double attack = 0.17;   ///< rad, above the horizon
  double spray = 0;       ///< rad: where it is swung to, positive to the right of −(pitch)
  double offset = 0.018;  ///< m, of the bat's axis below the ball's centre, across the pitch
};
/// The ball after the blow, by an oblique impact of two rough bodies; the frame is that of the pitch, so a hit leaves
/// toward −x. Errors: bat or swing that cannot be.
CAROM_API core::Result<BallState> hit(const Ball& ball, const Bat& bat, const BatSwing& swing, const BallState& pitch);

}  // namespace carom::sports
