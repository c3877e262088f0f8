// A cricket ball from the bowler's hand over its bounce to the stumps (chapters 6.3 and 19): swing by the seam, dip and
// drift by spin, turn off the pitch. x runs down the pitch to the batter, y up, z to the right as the bowler sees it: a
// right-handed batter's leg side.
#pragma once

#include "carom/sports/bounce.h"

namespace carom::sports {

struct CricketDelivery {
  double speed = 38;         ///< m/s at release
  double elevation = -0.09;  ///< rad
  double azimuth = 0;        ///< rad, to the right
  double spin = 110;         ///< rad/s, across the way
  double tilt = 0;           ///< rad: 0 backspin, π topspin, positive between them curves to the right
  double gyro = 0;           ///< rad/s about the way, right-handed: turns to the right off the pitch (an off break)
  double seam = 0;           ///< rad, the seam points so far to the right of the way; a ball with a held seam swings so
  double height = 2.1;       ///< m, of the ball at release
  double side = -0.6;        ///< m, of the release from the middle of the pitch
};

struct CricketPath {
  BallFlight air{};               ///< to the pitch, or to the stumps on the full
  std::vector<BallFlight> off{};  ///< after each bounce, the last one to the stumps
  bool full = false;              ///< it did not pitch
  double length = 0;              ///< m, where it pitched, before the stumps
  double line = 0;                ///< m, to the right of middle stump where it pitched
  double swing = 0;               ///< m, to the right: what seam and spin moved it by there (full: at the stumps)
  double turn = 0;                ///< rad, to the right: how the pitch changed its direction
  double time = 0, speed = 0;     ///< s from the hand, and m/s, at the stumps
  double height = 0, side = 0;    ///< m there
  bool hits = false;              ///< the stumps
  CAROM_API BallState at(double time) const;
};

inline constexpr double cricket_pitch = 18.9;    ///< m from a bowler's hand at the popping crease to the stumps
inline constexpr double stumps_height = 0.7112;  ///< m, Laws of Cricket 8.2: 28 in
inline constexpr double stumps_width = 0.2286;   ///< m, 9 in

/// From the hand to the batter's stumps, `distance` m away. Once it has pitched the seam is scrambled: it swings no
/// more. Errors: a ball, surface or delivery that cannot be, one that does not arrive within 10 s.
CAROM_API core::Result<CricketPath> deliver(const Ball& ball, const Conditions& conditions, const Surface& pitch,
                                            const CricketDelivery& delivery, double distance = cricket_pitch);
/// The same delivery aimed so that it pitches `length` m before the stumps and `line` m to the right of the middle one,
/// to a millimetre. Errors as `deliver`; a length out of reach.
CAROM_API core::Result<CricketDelivery> aimed(const Ball& ball, const Conditions& conditions, const Surface& pitch,
                                              const CricketDelivery& delivery, double length, double line,
                                              double distance = cricket_pitch);
CAROM_API core::Status check(const CricketDelivery& delivery);

}  // namespace carom::sports
