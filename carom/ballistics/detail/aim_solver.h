// How AimSolver and its parts are divided: aim_flight.cpp flies, aim_path.cpp knows what a flight owes to its start,
// aim_measure.cpp by how much it is off, aim_roots.cpp finds the shot near a guess, aim_guesses.cpp guesses,
// aim_reach.cpp knows how near shots come to the target and when, aim_walk.cpp walks through the flight times,
// aim_search.cpp asks them in turn.
#pragma once

#include "carom/ballistics/aim.h"
#include "carom/ballistics/detail/aim_kernel.h"
#include "carom/ballistics/detail/flight_step.h"
#include "carom/ballistics/detail/rough_pull.h"
#include "carom/math/cpu.h"

namespace carom::ballistics::detail {

using math::Vec3d;

/// One aiming problem. The target's velocity is only needed near enough for Newton's method: differences serve.
class AimSolver {
 public:
  /// `most`: lanes of no wider instruction set.
  AimSolver(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
            core::FunctionRef<Vec3d(double)> target, const AimOptions& options,
            math::InstructionSet most = math::InstructionSet::avx512);

  using Path = FlightPath;
  struct Guess {
    Vec3d u{};  // the initial velocity in the world
    double time = 0;
  };
  using Arrival = FlightPath::Arrival;

  /// Newton's method for u and T together.
  struct Root {
    bool found = false;
    double slope = 0;  // m/s², of the speed that is needed over T: falls on the low side, rises on the high one
    Guess guess{};
    Arrival arrival{};
  };
  /// `eager`: gives up where the first steps do not lead there; `falling`: the time of the guess is only the order of
  /// magnitude, the right one is when it comes down to the target's height; `known`: a path of the guess, about.
  Root refine(Guess guess, int most = 40, bool eager = false, bool falling = false, Path* known = nullptr) const;

  /// The earliest and the latest of all roots, and of those that are known, by a walk through the flight times.
  void scan(Aims& aims) const;
  /// The usual case, in which the speed to spare has one peak over T, with an arc on either side of it. False: it is
  /// not the usual case, and the scan must tell.
  bool two_arcs(const Target& target, Aims& aims) const;
  /// The same for any motion.
  bool two_arcs(Aims& aims) const;

 private:
  /// The initial velocity that hits at T in vacuum.
  Vec3d vacuum(double time) const {
    const Vec3d way = target_(time) - shooter_.muzzle;
    return way / time + Vec3d{0, 0.5 * conditions_.gravity * time, 0};
  }
  /// Has the speed to spare one peak over T in vacuum?
  bool one_peak(const Target& target) const;
  bool slow_target() const;
  /// Looks at how the target moves, closer together at first.
  static constexpr int looks = 64;
  double time_of_look(int look) const { return options_.longest_time * math::square(double(look) / looks); }
  class Looks {
   public:
    explicit Looks(const AimSolver& solver) : solver_(solver) {
      for (int look = 0; look <= looks; ++look) paces_[look] = -1;
    }
    /// m/s, at most, as far as two looks tell, between the one before and this one.
    double pace(int look);
    Vec3d place(int look);

   private:
    const AimSolver& solver_;
    double paces_[looks + 1];  // < 0: not known yet
    Vec3d places_[looks + 1];
    bool known_[looks + 1] = {};
  };
  /// The roots on either side of the one peak, where each is so far from it that the speed that is needed changes by
  /// `apart` of the muzzle speed in its flight time.
  bool arcs(double apart, Aims& aims) const;
  double vacuum_lack(double time) const {
    return shooter_.muzzle_speed - math::length(vacuum(time) - shooter_.velocity);
  }
  Vec3d velocity_of_target(double time) const {
    const double h = 1e-4 * math::max(time, 1e-2), from = math::max(time - h, 0.0);
    return (target_(time + h) - target_(from)) / (time + h - from);
  }
  /// 1/m, the share of the speed that drag takes by way.
  double drag_by_way(double speed, double height) const;
  /// s, m, of a straight way that rises by `up` of its length (m), in steps each with a drag of its own.
  struct Straight {
    double time = 0, fall = 0;
  };
  Straight fly_straight(double speed, double length, double up) const;
  /// Straight at the target, but for what it falls. `far`: that is more than shots that go farthest do (.3 to .55 of
  /// the way).
  Guess flat_guess(bool& far) const;
  /// Nearly straight up, and down on the target.
  Guess steep_guess() const;
  void keep(Aims& aims, const Root& root) const;
  /// `late`: the root on the high side, where the search for the low one led there.
  bool by_guesses(const Guess& flat, double apart, Aims& aims, Root& late) const;
  /// The inverse of ∂x(T)/∂u.
  struct Inverse {
    Vec3d row[3];
    Vec3d apply(Vec3d x) const { return {math::dot(row[0], x), math::dot(row[1], x), math::dot(row[2], x)}; }
    Vec3d apply_transposed(Vec3d x) const { return x.x * row[0] + x.y * row[1] + x.z * row[2]; }
  };
  static Inverse inverse_of(const Vec3d* rows);

  /// The surface that the shots of one flight time reach, where one of them arrives: as a ball with its normal and its
  /// mean curvature there, seen from the target.
  struct Reach {
    bool known = false;
    Guess guess{};
    double gap = 0;             // m, from the surface to the target; < 0: within
    bool fine = true;           // flown so well that it owes next to nothing
    double owes = 0;            // m, by how much the path has still to move; the gap may err by a quarter of that
    double plane = 0;           // m, likewise to the plane that touches it
    double rate = 0, bend = 0;  // m/s, m/s², of the gap over the flight time
    double scale = 0;           // m
    double radius = 0;          // m
    double bulge = 0;           // m, how much of the gap is the ball's doing: none where the target is straight ahead
    Vec3d normal{}, way{};      // outward; m, from the centre to the target
    Vec3d drift{};              // m/s, of the target past the shot
    Vec3d velocity{};           // m/s, of the shot
    Inverse inverse{};
    /// The path is known well enough for the gap.
    bool told() const {
      return fine || (math::abs(gap) > 3e-3 * scale && owes < math::max(1.5e-3 * scale, math::abs(gap)));
    }
    /// It is where the surface comes nearest to the target, or the ball tells little of the gap.
    bool settled() const { return bulge <= math::max(0.2 * math::abs(gap), 1e-4 * scale); }
  };
  static constexpr double rough_reach = 1e-2;  // of the scale
  /// The path of the last look at the surface, which is moved to the next instead of a flight of its own. It tells of
  /// the surfaces at all times that it passes.
  struct Trail {
    bool known = false;
    bool spread = false;  // FlightPath::Spread is of the path as it is
    bool fine = false;    // flown so well that it owes next to nothing
    double horizon = 0;   // s, so far paths are flown at least
    Path path;
  };
  Reach reach(const Guess& guess, Vec3d target, Trail* trail = nullptr) const;
  /// By a flight that may be so far off, a share of the scale, before it is known by how much.
  Reach reach(const Guess& guess, Vec3d target, double accuracy, Path& path) const;
  /// By where the target and a flight are then, and how that hangs on its start (rows); without rate, bend and drift.
  Reach reach(const Guess& guess, double scale, Vec3d target, Vec3d position, const Vec3d* rows) const;
  /// Where the path of a trail is at a time, of the target's place then; without bend, and without rate and drift
  /// unless `moving`. Not known where it does not pass that, or is too far off then.
  Reach along(Trail& trail, double time, Vec3d target, bool moving = true) const;
  /// Moves the path of a trail to where it should be, until it tells the gap.
  void settle(Trail& trail, Vec3d target, Reach& at) const;
  double scale_of(double time, Vec3d target) const {
    return math::max(math::length(target - shooter_.muzzle), 0.1 * shooter_.muzzle_speed * time);
  }
  /// A path with another start to another time: cut off, or flown on. False: too many steps.
  bool bring(const Guess& guess, double allowed, Path& path) const;
  /// Not known either where the path of the trail is too far from the nearest point, or not known well enough.
  Reach on_the_way(Trail& trail, double time) const;
  /// The same where it is nearest to the target, about, at the time of the guess.
  Reach reach_nearest(const Guess& guess, Trail* trail = nullptr) const;
  /// The shot that comes nearest to the target at another flight time, by the ball.
  Guess toward(const Reach& at, double time) const;
  /// Where over all flight times the surface comes nearest to the target, or the target deepest into it.
  struct Nearest {
    bool sure = false;
    Reach at{};                // near there
    double time = 0, gap = 0;  // s, m, foretold from there
    Guess doubtful{};          // on the way to it: the last that seemed to reach farther than the target
  };
  Nearest nearest_from(Guess guess) const;
  /// `time`: of a flat shot, s.
  Nearest nearest(double time) const;
  /// No solution where the surface never comes to the target; else the roots on either side of where it is deepest in.
  /// `late` may be known, the root after that. False: unknown.
  bool by_nearest(Aims& aims, const Nearest& nearest, const Root& late) const;
  /// The root between a and b, on different sides of the surface: by secants until Newton's method finds one there.
  bool between(Reach a, Reach b, Trail& trail, Aims& aims) const;
  /// From the path of a trail, where it is known.
  Root refine_along(const Guess& guess, double scale, Trail& trail, int most, bool eager) const;
  /// s, before it no shot comes to the target.
  double before_any(Looks& at_looks) const;
  /// After it none does. Leaves the path of a shot that is as high as any then.
  Guess after_any(Looks& at_looks, Trail& trail) const;
  /// s, for which neither the target nor shots of a speed (m/s) pass a room (m); 0 where that is less than `least`.
  double safe_step(double time, double side, double room, double shots, double least, Looks& at_looks) const;
  /// Keeps the first root that it comes to.
  void walk(const Guess& from, double to, Looks& at_looks, Trail& trail, Aims& aims) const;
  /// The root at about a time at which the gap would close, as far as it is looked at on the way.
  bool soon(const Reach& at, double time, Trail& trail, Aims& aims) const;
  /// The shot at a target in vacuum, by muzzle speed.
  Guess straight(double time) const;

  /// How the arrival depends on the start and by how much it is off, to first order in the defects of the elements and
  /// the leaps between them. `finely`: but for what is bent within elements, to about the tolerance.
  void linearize(Path& path, bool finely) const;
  void spread(Path& path) const { (path.count > 4 ? lanes_ : few_lanes_).spread(medium_, path); }
  /// m, what errors within elements may do beside what the moments of their defects say: they fade on the way to its
  /// end, and wind may change with height. And whether the path lands.
  double unsettled(Path& path) const;
  /// m/s, what the points of an element may mistake of the drag curve's nodes within it, where its second derivative
  /// jumps.
  double kinks(const Path& path, int n) const;
  /// Elements within which something is bent, anew.
  void measure(Path& path) const;
  /// Newton's step for u and T together, from a path with its derivatives.
  struct Newton {
    bool known = false;
    Vec3d du{};
    double dt = 0, slope = 0;     // s, and of Root
    double missed = 0;            // m, by place and by the muzzle speed
    double moved = 0, scale = 0;  // m, by how much the path moves and leaps, and of how much
    double left = 0;              // m, what the step leaves
  };
  Newton newton(const Path& path, const Guess& guess) const;
  /// To another initial velocity and time, with what the elements owe.
  static void move(Path& path, Vec3d du, double dt);
  /// Elements into parts of which each mistakes the arrival by about `enough` m; into fewer where there would be too
  /// many.
  void divide(Path& path, double enough) const;

  /// Faster than sound, and most of all through the barrier, drag curves bend too sharply for the estimate of the
  /// error: no longer steps there than it takes to lose so much speed (m/s; above the barrier `far_bend` times that),
  /// the shorter the better the path must be known: to `share` of its length.
  double speed_of_a_bend(double share) const {
    return sound_ * math::clamp(0.55 * math::sqrt(math::sqrt(share)), 0.03, 0.3);
  }
  static constexpr double far_bend = 4;
  static constexpr double least_bend = 0.1;  // m/s, of the wind

  using Step = FlightStep;
  template <bool Rough>
  [[gnu::always_inline]] inline Step step(Vec3d x, Vec3d v, Vec3d k1, double h) const;
  /// Steps held by the error of the velocity: at every moment so small that it moves the end by less than `allowed` m.
  /// `falling`: until it comes down to the target's height; `Rough`: of third order. False: too many steps.
  /// On from the end of the path where `on`.
  template <bool Rough>
  bool fly(Guess guess, double allowed, Path& path, bool falling, bool on) const;
  bool record(Guess guess, double allowed, Path& path, bool falling = false, bool on = false) const {
    return allowed < 2e-4 * math::length(guess.u) * guess.time ? fly<false>(guess, allowed, path, falling, on)
                                                               : fly<true>(guess, allowed, path, falling, on);
  }
  const RoughPull rough_;   // what flights feel
  const AimMedium medium_;  // what holds, for lanes
  const AimKernel& lanes_;
  const AimKernel& few_lanes_;  // for up to four elements
  const Projectile& projectile_;
  const Conditions& conditions_;
  const Shooter& shooter_;
  core::FunctionRef<Vec3d(double)> target_;
  AimOptions options_;
  double decay_ = 1e30;     // s, in which drag takes the muzzle speed
  double fall_speed_ = 0;   // m/s, terminal, at most the muzzle speed
  double sound_ = 340.294;  // m/s, at the muzzle
  double ground_ = -1e300;  // m, where profiles of wind begin, with a leap
  bool layered_ = false;    // the wind bends sharply somewhere
  bool bent_ = false;       // the drag curve does, at a Mach number that is flown
};

}  // namespace carom::ballistics::detail
