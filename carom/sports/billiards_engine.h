// Shots on a table, from event to event (chapter 19.5, 19.6).
//
// Nothing is stepped through time: between events every ball moves on its own polynomial, and the engine finds the next
// moment at which something changes (slip ends, a ball stops, drops on the bed, meets another, a cushion, a jaw, a
// pocket), the way of FastFiz and pooltool. What depends on one ball alone is found once when that ball's motion
// changes, each pair's meeting once when either's does; a ball keeps its earliest. Balls that touch when one of them is
// struck are solved together, the fastest approach first, equals at the same moment. All motions are kept, so that the
// shot can be asked for any time.
#pragma once

#include <span>
#include <vector>

#include "carom/sports/billiards.h"
#include "carom/sports/cue.h"
#include "carom/sports/table.h"

namespace carom::sports {

struct BilliardEvent {
  enum class Kind : std::uint8_t {
    strike,  ///< by the cue
    rolls,   ///< slip has ended
    rests,
    ball,     ///< `other` is the second ball
    cushion,  ///< `other` is the table's edge
    jaw,      ///< `other` is the table's jaw
    lands,    ///< on the bed
    pocket,   ///< `other` is the pocket
    leaves,   ///< the table
  };
  double time = 0;
  Kind kind = Kind::strike;
  int ball = 0, other = -1;
  double speed = 0;  ///< m/s, of approach where something is struck
};

struct BilliardOptions {
  bool record = true;       ///< keep all motions and events, for `state(ball, time)` and `events()`
  int most_events = 50000;  ///< of one shot; more are an error
};

class CAROM_API Billiards {
 public:
  /// Error: what `validate` refuses, or a nose that is not between R and 2R above the bed.
  static core::Result<Billiards> create(const BilliardTable& table, const BilliardPhysics& physics = {},
                                        const BilliardOptions& options = {});

  /// Puts the balls on the bed at these points (x, z), at rest, at time 0. At most 64. Errors: not finite, outside of
  /// the table or in a pocket, overlapping another ball or a cushion by more than 1e-9 m.
  core::Status place(std::span<const math::Vec2d> balls);
  /// A ball's state from now on, whatever it was. Phase `airborne` or a height above R: it flies. Errors as above.
  core::Status set_state(int ball, const BilliardState& state);
  /// The cue strikes a ball that is at rest on the bed. Error: no such ball, one that moves, or a stroke that cannot
  /// be.
  core::Result<CueImpact> strike(int ball, const Stroke& stroke, const Cue& cue = {});

  /// On to `until` (s), or to where everything rests. Error: more events than the options allow.
  core::Status run(double until = never);

  /// Drops the record of what has been: states are then known from now on.
  void forget();

  int balls() const { return int(motion_.size()); }
  double time() const { return time_; }
  /// The next thing that happens; `never`: all is at rest.
  double next_event_time() const;
  /// When the last ball stops and spins no more, as far as has been run.
  double rest_time() const;
  BilliardState state(int ball) const { return motion_[std::size_t(ball)].at(time_); }
  /// At any time since `place` up to `time()`; needs `record` for times before the last event.
  BilliardState state(int ball, double time) const;
  const BilliardMotion& motion(int ball) const { return motion_[std::size_t(ball)]; }
  /// All motions of a ball since `place`.
  std::span<const BilliardMotion> path(int ball) const { return history_[std::size_t(ball)]; }
  /// Appends points of a ball's way for drawing: the ends of every motion between the two times, and where it curves a
  /// point every `spacing` s between them.
  void trace(int ball, double from, double until, double spacing, std::vector<math::Vec3d>& points) const;
  std::span<const BilliardEvent> events() const { return events_; }
  std::int64_t event_count() const { return count_; }
  double energy() const;                                                  ///< J, of the balls in play
  int pocket_of(int ball) const { return pocketed_[std::size_t(ball)]; }  ///< −1: in none

  const BilliardTable& table() const { return table_; }
  const BilliardPhysics& physics() const { return physics_; }

 private:
  Billiards(BilliardTable table, const BilliardPhysics& physics, const BilliardOptions& options);
  enum class Own : std::uint8_t { phase, edge, jaw, pocket };
  struct Next {
    double time = never;
    Own kind = Own::phase;
    int index = -1;
  };

  core::Status check_place(int ball, math::Vec3d position) const;
  void apply(int ball, const BilliardState& state);
  void predict();
  void predict_own(int ball);
  void predict_flight(int ball, Next& next, double limit) const;
  void predict_pairs(int ball);
  double meeting(int a, int b) const;
  void rescan(int ball);
  void process(int ball);
  void end_phase(int ball);
  void meet_cushion(int ball, const Next& next);
  void fall(int ball, int pocket);
  void meet_balls(int a, int b);
  void solve_pair(int pair);
  void compress(double blow, double depth);
  double motion_energy() const;
  void note(BilliardEvent::Kind kind, int ball, int other, double speed);
  std::size_t at(int a, int b) const { return std::size_t(a) * motion_.size() + std::size_t(b); }
  double& last_hit(int a, int b) { return last_hit_[at(a, b)]; }

  BilliardTable table_;
  BilliardPhysics physics_;
  BilliardOptions options_;
  double nose_reach_ = 0;  ///< m, from a ball's centre on the bed to the nose, seen from above
  double sine_ = 0;        ///< of the angle of the contact with the nose over the ball's equator
  double time_ = 0;
  std::int64_t count_ = 0;
  std::vector<BilliardMotion> motion_;
  std::vector<Next> own_;
  std::vector<double> pair_, last_hit_;  ///< by two balls
  std::vector<double> best_;
  std::vector<int> partner_;  ///< −1: its own event is its next
  std::vector<double> cushion_hit_;
  std::vector<int> cushion_piece_, pocketed_;
  std::vector<int> changed_;
  std::vector<std::vector<BilliardMotion>> history_;
  std::vector<BilliardEvent> events_;
  // Of the balls that touch, while they are solved.
  struct Touching {
    int a = 0, b = 0;
    math::Vec3d normal{};
    bool on_bed = true;
    double gap = 0;  ///< m
    double push = 0, now = 0, depth = 0, deepest = 0, friction = -1;
    math::Vec3d rub{};
  };
  std::vector<Touching> pairs_;
  std::vector<int> members_;
  std::vector<BilliardState> states_, start_;
  std::vector<char> touched_;
};

}  // namespace carom::sports
