// A golf swing: two or three links in an inclined plane, driven by torques, with a wrist that is held cocked and let
// go, and a shaft that bends (chapters 19.1 and 19.2). Two links: D. Williams, Q. J. Mech. Appl. Math. 20 (1967) 247;
// T. Jorgensen, Am. J. Phys. 38 (1970) 644.
#pragma once

#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/elementary.h"
#include "carom/math/vec.h"
#include "carom/ode/state.h"

namespace carom::sports {

using math::Vec2d;

/// A function of time by points, linear between them and constant beyond.
struct Curve {
  struct Point {
    double time = 0, value = 0;
  };
  std::vector<Point> points;
  static Curve constant(double value) { return {{{0, value}}}; }
  CAROM_API double at(double time) const;
  CAROM_API double integral(double time) const;  ///< from time 0
};

/// What holds a joint at its angle until it may move.
struct Hold {
  enum class Until : std::uint8_t {
    free,   ///< not held
    time,   ///< held until `time`
    opens,  ///< a stop that cannot pull: held until the links would part by themselves
  };
  Until until = Until::free;
  double time = 0;  ///< s
};

/// A link that hangs from the one before it (the first from the hub). Angles are taken from straight down in the plane.
struct SwingLink {
  double mass = 1;             ///< kg
  double length = 1;           ///< m, from its joint to the next one; of the last, to the club head
  double centre = 0.5;         ///< m, from its joint to its centre of mass
  double inertia = 0;          ///< kg·m², about its centre of mass
  double angle = 0, rate = 0;  ///< rad, rad/s at the start
  Curve torque{};              ///< N·m on this link, and against the one before
  Hold hold{};
};

/// The bending of the last link: its first mode as a clamped beam, φ(s) = ½ (s/L)² (3 − s/L), in the plane.
struct FlexibleShaft {
  double frequency = 0;  ///< Hz with the grip clamped (250 cycles a minute are 4.2 Hz); 0: stiff
  double damping_ratio = 0.02;
  double head_mass = 0.2;   ///< kg, of the last link's mass, at its end
  double shaft_mass = 0.1;  ///< kg, spread along it
};

struct Swing {
  std::vector<SwingLink> links;  ///< two to four
  FlexibleShaft shaft{};
  double plane = 1.0471975511965976;  ///< rad, the plane's angle over the horizon
  double gravity = 9.80665;
  Curve hub{};  ///< m/s², acceleration of the hub toward the target
  enum class ImpactAt : std::uint8_t {
    head_below_hub,  ///< the club head passes under the hub
    club_vertical,   ///< the last link passes straight down
    ball,            ///< the head passes `ball` m toward the target from below the hub
  } impact = ImpactAt::head_below_hub;
  double ball = 0;
};

inline constexpr std::size_t max_swing_links = 4;
struct SwingState {
  double angle[max_swing_links] = {}, rate[max_swing_links] = {};  ///< rad, rad/s
  double bend = 0, bend_rate = 0;                                  ///< m, m/s of the head across the club
  friend SwingState operator+(const SwingState& a, const SwingState& b) {
    SwingState s;
    for (std::size_t i = 0; i < max_swing_links; ++i) {
      s.angle[i] = a.angle[i] + b.angle[i];
      s.rate[i] = a.rate[i] + b.rate[i];
    }
    s.bend = a.bend + b.bend;
    s.bend_rate = a.bend_rate + b.bend_rate;
    return s;
  }
  friend SwingState operator*(double f, const SwingState& a) {
    SwingState s;
    for (std::size_t i = 0; i < max_swing_links; ++i) {
      s.angle[i] = f * a.angle[i];
      s.rate[i] = f * a.rate[i];
    }
    s.bend = f * a.bend;
    s.bend_rate = f * a.bend_rate;
    return s;
  }
};

/// Which joints are held now, and the torque that holds each.
struct SwingMotion {
  SwingState rate{};
  double hold_torque[max_swing_links] = {};  ///< N·m on the link
};
/// Lagrange's equations in the angles of the links (and the bend): Σ K_ij (cos(θ_i − θ_j) θ̈_j + sin(θ_i − θ_j) θ̇_j²) +
/// S_i (g sin θ_i + a cos θ_i) = Q_i − Q_{i+1}.
CAROM_API SwingMotion swing_motion(const Swing& swing, double time, const SwingState& state,
                                   const bool (&held)[max_swing_links]);
CAROM_API SwingState swing_start(const Swing& swing);
/// Kinetic and potential energy (J), of a hub at rest; zero at rest straight down.
CAROM_API double swing_energy(const Swing& swing, const SwingState& state);
/// Where the joints and the head are, in the plane: x toward the target, y up the plane, from the hub. `joint` 0 is the
/// end of the first link; the last is the head.
CAROM_API Vec2d swing_point(const Swing& swing, const SwingState& state, std::size_t joint);
CAROM_API Vec2d head_velocity(const Swing& swing, double time, const SwingState& state);
/// Errors name the field: two to four links, masses, lengths, curves in order of time.
CAROM_API core::Status check(const Swing& swing);

struct SwingResult {
  struct Node {
    double time = 0;
    SwingState state{}, rate{};
  };
  std::vector<Node> nodes;
  bool impact = false;                   ///< the ball was met
  double time = 0;                       ///< s of the impact, or the end
  double speed = 0;                      ///< m/s of the head
  Vec2d velocity{};                      ///< m/s of the head in the plane
  double attack = 0, path = 0;           ///< rad: of a right-handed player, plane aimed at the target
  double release[max_swing_links] = {};  ///< s, when each joint was let go
  double bend = 0, added_loft = 0;       ///< m; rad that the bent shaft adds to the loft
  CAROM_API SwingState at(double time) const;
};
/// From the start until the head meets the ball. Errors: a swing that cannot be, or that cannot be integrated.
CAROM_API core::Result<SwingResult> swing(const Swing& swing, double time_limit = 2, double tolerance = 1e-11);
/// The swing with all torques scaled so that the head meets the ball with `speed` (m/s). Errors: none such between a
/// tenth and ten times.
CAROM_API core::Result<Swing> swing_for_speed(const Swing& swing, double speed);

/// The textbook swing: arms as a uniform rod of 7 kg and .66 m, club of .34 kg with the head at 1.10 m, 100 N·m at the
/// shoulders, 135° back, the wrists cocked by 90° until they open by themselves.
CAROM_API Swing textbook_swing();
/// Shoulders, arm and club: three links with ramped torques and a flexible shaft.
CAROM_API Swing three_link_swing();

}  // namespace carom::sports

namespace carom::ode {
template <>
inline constexpr int components<sports::SwingState> = int(2 * sports::max_swing_links + 2);
}
