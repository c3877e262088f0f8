// A golf shot in one call: swing, impact, flight, bounces and roll (chapter 19).
#pragma once

#include "carom/sports/bounce.h"
#include "carom/sports/golf_impact.h"
#include "carom/sports/golf_swing.h"

namespace carom::sports {

struct GolfShot {
  Swing swing{};
  ClubHead club{};
  Ball ball{};
  Conditions conditions{};
  Vec3d tee{0, 0.021335, 0};  ///< m, the ball's centre
  double aim = 0;             ///< rad, to the right: where the plane of the swing is aimed
  double face = 0;            ///< rad, to the right: where the face looks at the impact
  double lean = 0;            ///< rad, dynamic less static loft
  double toe = 0, high = 0;   ///< m, where on the face
  /// Path and angle of attack as given here instead of those of the swing's plane.
  bool delivery_given = false;
  double attack = 0, path = 0;  ///< rad
};
struct GolfShotResult {
  SwingResult swing{};
  ClubDelivery delivery{};
  ClubImpact impact{};
  Shot shot{};
  Landing landing{};  ///< of the first flight
  double total = 0;   ///< m from the tee to where it rests
};
/// Errors: those of its parts, or a swing that misses the ball.
CAROM_API core::Result<GolfShotResult> play_golf(const GolfShot& shot, GroundAt ground);
CAROM_API core::Result<GolfShotResult> play_golf(const GolfShot& shot, const Surface& surface);
/// The shot that a tour player would make with this club: the textbook swing at the preset's head speed, and its
/// delivery.
CAROM_API core::Result<GolfShot> tour_shot(std::string_view club);

}  // namespace carom::sports
