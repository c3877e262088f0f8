// How a ball of a scene file leaves the hand or the club: the keys "delivery", "pitch" and "shot" of a ball_flight.
#pragma once

#include <optional>

#include "carom/scene/detail/reader.h"
#include "carom/sports/flight.h"

namespace carom::scene::detail {

struct BallRelease {
  std::optional<math::Vec3d> position{};  ///< m; a shot leaves the ball where it lies
  math::Vec3d velocity{}, spin{};         ///< m/s, rad/s
  math::Vec3d seam_normal{0, 0, 1};       ///< of a bowler's seam
};
/// Empty where there is none, or the reader failed. `conditions`: the air that the ball is aimed in.
std::optional<BallRelease> read_ball_release(Reader& reader, const Object& effector, const sports::Ball& ball,
                                             const sports::Conditions& conditions);

}  // namespace carom::scene::detail
