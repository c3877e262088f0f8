// A bowling ball on a lane with oil (chapter 19): it skids, hooks and rolls. x runs down the lane, y to the left.
#pragma once

#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::sports {

struct BowlingBall {
  double mass = 6.8;         ///< kg
  double radius = 0.1085;    ///< m
  double gyration = 0.0635;  ///< m, radius of gyration; USBC: 2.46 to 2.80 in
  /// m, greatest less least radius of gyration over the ball's axes; USBC: at most .06 in. It is there for the rules:
  /// `bowl` takes one radius for all axes, the axis does not wander over the ball (track flare).
  double differential = 0;
  double cover = 1;  ///< times the lane's friction: hard plastic grips less than what lanes are measured with
};
/// Stretches of the lane with their friction, one after another; beyond the last its friction goes on.
struct Lane {
  struct Stretch {
    double end = 0;         ///< m from the foul line
    double friction = 0.2;  ///< USBC: at most .32 between ball and dry lane
  };
  std::vector<Stretch> stretches{{12.192, 0.04}, {18.288, 0.20}};  ///< 40 ft of oil
  double length = 18.288;                                          ///< m, foul line to head pin
  double width = 1.0668;                                           ///< m, between the gutters
  double gravity = 9.80665;
};
/// Errors name what cannot be: sizes, stretches that do not follow one another.
CAROM_API core::Status check(const Lane& lane);
/// Whether the rules of the United States Bowling Congress allow this ball on this lane: diameter 8.5 to 8.595 in, at
/// most 16 lb, radius of gyration 2.46 to 2.80 in, differential at most .06 in, friction between them (lane times
/// cover) at most .32. The error names what they refuse. `bowl` does not ask: duckpins and candlepins have rules of
/// their own.
CAROM_API core::Status usbc_allows(const BowlingBall& ball, const Lane& lane);
/// How it is let go: direction and turning of the axis. With axis rotation 0 it rolls end over end, with 90° the spin
/// is about the way itself and carries to the left (a right-hander's hook: positive).
struct Delivery {
  double speed = 8;          ///< m/s
  double angle = 0;          ///< rad, to the left of the lane
  double spin = 31.4159;     ///< rad/s
  double axis_rotation = 0;  ///< rad
  double start = 0;          ///< m to the left of the middle, at the foul line
};
struct LanePoint {
  double time = 0, x = 0, y = 0;    ///< s; m down the lane and to the left of the middle
  double speed_x = 0, speed_y = 0;  ///< m/s
  double rim_x = 0, rim_y = 0;      ///< m/s, radius times spin: what the speed would be if it rolled
  bool rolls = false;               ///< from here on
};
/// The points where something changes: the release, ends of oil, the start of rolling, the gutter, the pins.
struct CAROM_API LanePath {
  std::vector<LanePoint> points;
  bool gutter = false;
  LanePoint at(double time) const;  ///< times before and after give the first and last point
  const LanePoint& end() const { return points.back(); }
  double entry_angle() const;  ///< rad, to the left, at the end
};
/// Within a stretch the slip keeps its direction and the path is a parabola, so all is in closed form:
/// a = −μ g û, slip ends after u/(μ g (1 + r²/k²)). Rolling loses nothing. Errors name what cannot be.
CAROM_API core::Result<LanePath> bowl(const BowlingBall& ball, const Lane& lane, const Delivery& delivery);

}  // namespace carom::sports
