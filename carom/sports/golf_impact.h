// Club against ball (chapters 5.4 and 19): launch, spin and gear effect from loft, face, path and where it is struck.
#pragma once

#include <span>
#include <string_view>

#include "carom/math/mat.h"
#include "carom/sports/flight.h"

namespace carom::sports {

/// A club head. Its own frame: x out of the face at the sweet spot, level; y up; z toward the toe of a right-handed
/// club.
struct ClubHead {
  double mass = 0.200;                    ///< kg
  Vec3d inertia{2.8e-4, 4.8e-4, 3.2e-4};  ///< kg·m², about its centre of mass: roll (x), yaw (y), pitch (z)
  double depth = 0.035;                   ///< m from the face back to the centre of mass: gear effect grows with it
  double loft = 0.19;                     ///< rad, static
  double restitution = 0.83;              ///< e of ball on face, along its normal
  double tangential_restitution = 0;      ///< e_x of the ball's cover: above 0 it springs back along the face
  double friction = 0.4;                  ///< μ
  double bulge = 0;                       ///< 1/m, horizontal curvature of the face
  double roll = 0;                        ///< 1/m, vertical curvature
};
/// How it comes to the ball, as a launch monitor tells it. Angles in rad; right is +z for everybody.
struct ClubDelivery {
  double speed = 45;  ///< m/s of the head's centre
  double attack = 0;  ///< angle of attack: upward positive
  double path = 0;    ///< direction of the head, to the right
  double face = 0;    ///< direction of the face, to the right
  double lean = 0;    ///< dynamic loft less static loft; forward lean of the shaft is negative
  double toe = 0;     ///< m, where the ball is met from the sweet spot: toward the toe
  double high = 0;    ///< m, and up the face
};
struct ClubImpact {
  BallState ball{};  ///< leaves the origin of the frame of the shot
  Launch launch{};
  double smash = 0;          ///< ball speed over head speed
  double spin_loft = 0;      ///< rad, between the face's normal and the path in the plane that holds both
  double contact_speed = 0;  ///< m/s, along the normal
  bool slides = false;
  Vec3d head_velocity{}, head_spin{};  ///< m/s, rad/s, after
};
/// A collision of two rigid bodies at a point: with K = 1/m + 1/M and both inertias, the impulse turns the normal
/// velocity round by e and the tangential one by e_x, within the cone of friction. The D-plane (Jorgensen, The Physics
/// of Golf, 1994) and the gear effect come out of it. Errors name the field that cannot be.
CAROM_API core::Result<ClubImpact> strike(const Ball& ball, const ClubHead& head, const ClubDelivery& delivery,
                                          Vec3d position = {});

/// A club with the delivery that tour players give it on average, and what comes of it.
struct ClubPreset {
  std::string_view name;
  double length = 1.1;  ///< m
  ClubHead head{};
  ClubDelivery delivery{};
  // TrackMan's averages of the PGA tour, in mph, deg, rpm, yd.
  double ball_speed = 0, launch = 0, spin = 0, carry = 0, apex = 0, landing = 0;
};
/// driver, 3-wood, 5-wood, hybrid, 3-iron to 9-iron, wedge. Head speed, angle of attack, ball speed, launch and spin
/// are published averages; restitution, tangential restitution and lean are what makes this model give them.
CAROM_API std::span<const ClubPreset> club_presets();
CAROM_API core::Result<ClubPreset> club_preset(std::string_view name);

}  // namespace carom::sports
