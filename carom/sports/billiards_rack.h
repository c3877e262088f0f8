// Where the balls lie when a game begins (chapter 19.3). Points are (x, z); the head of the table is at −x.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/sports/table.h"

namespace carom::sports {

struct RackOptions {
  double gap = 0;     ///< m between neighbours; 0: they touch exactly
  double jitter = 0;  ///< 0 to 1: each ball lies off its place by up to this part of half the gap, in any direction
  std::uint64_t seed = 1;
};

/// A triangle of so many rows behind its first ball, rows one after the other from −z to +z.
CAROM_API std::vector<math::Vec2d> triangle_rack(int rows, math::Vec2d apex, double radius,
                                                 const RackOptions& options = {});
/// The cue ball on the head spot, then the triangle of 15 with its apex on the foot spot.
CAROM_API std::vector<math::Vec2d> eight_ball_rack(const RectangularTable& table, double radius,
                                                   const RackOptions& options = {});
/// The cue ball on the head spot, then the diamond of nine, its apex on the foot spot.
CAROM_API std::vector<math::Vec2d> nine_ball_rack(const RectangularTable& table, double radius,
                                                  const RackOptions& options = {});
/// The cue ball in the D, yellow, green, brown, blue, pink, black, then the 15 reds behind the pink. The D and the
/// spots are WPBSA's, scaled from a length of 3.569 m.
CAROM_API std::vector<math::Vec2d> snooker_rack(const RectangularTable& table, double radius,
                                                const RackOptions& options = {});
/// The opening of three-cushion: the cue ball beside the head spot, the other white on it, the red on the foot spot.
CAROM_API std::vector<math::Vec2d> carom_opening(const RectangularTable& table, double radius);

}  // namespace carom::sports
