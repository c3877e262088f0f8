#include "carom/sports/billiards_solver.h"

#include <algorithm>

#include "carom/core/string.h"

namespace carom::sports {

using math::Vec2d;
using math::Vec3d;

namespace {

using Kind = BilliardEvent::Kind;

/// The last way of the object ball that counts: after the cushions that were asked for.
struct Leg {
  bool valid = false;
  Vec2d start{}, end{}, heading{};
  double speed = 0;  ///< m/s, at its end
  bool rests = false;
};

/// Trials with the two balls alone.
class ShotTrials {
 public:
  ShotTrials(Billiards probe, const ShotGoal& goal, const ShotOptions& options, Vec2d cue, Vec2d object)
      : probe_(std::move(probe)), goal_(goal), options_(options), balls_{cue, object} {}

  Stroke stroke(double direction, double speed) const {
    return {direction, speed, options_.side, options_.height, options_.elevation};
  }

  Leg play(double direction, double speed) {
    Leg leg;
    if (!probe_.place(balls_) || !probe_.strike(0, stroke(direction, speed), options_.cue)) return leg;
    int cue_cushions = 0, object_cushions = 0;
    bool met = false;
    std::size_t seen = 0;
    for (int round = 0; round < 200; ++round) {
      const double next = probe_.next_event_time();
      if (next == never) break;
      const Vec3d before = probe_.motion(1).velocity_at(next);
      if (!probe_.run(next)) return leg;
      for (; seen < probe_.events().size(); ++seen) {
        const BilliardEvent& e = probe_.events()[seen];
        const bool rubber = e.kind == Kind::cushion || e.kind == Kind::jaw;
        if (!met) {
          if (e.ball == 0 && rubber && ++cue_cushions > goal_.cue_cushions) return leg;
          if (e.kind == Kind::leaves || e.kind == Kind::pocket) return leg;
          if (e.kind != Kind::ball) continue;
          if (cue_cushions != goal_.cue_cushions) return leg;
          met = true;
          begin(leg);
          continue;
        }
        const bool again = e.kind == Kind::ball, mine = e.ball == 1;
        if (!again && !mine) continue;
        if (rubber && object_cushions < goal_.object_cushions) {
          if (e.kind == Kind::jaw) return leg;
          ++object_cushions;
          begin(leg);
          continue;
        }
        if (rubber || again || e.kind == Kind::rests || e.kind == Kind::pocket || e.kind == Kind::leaves) {
          if (object_cushions != goal_.object_cushions) {
            if (again) {
              begin(leg);
              continue;
            }
            return leg;
          }
          const Vec3d p = probe_.state(1).position;
          leg.end = {p.x, p.z};
          leg.rests = e.kind == Kind::rests;
          const Vec2d way{before.x, before.z};
          leg.speed = length(way);
          // Where it stops it has no velocity any more: its last straight way tells the direction.
          leg.heading = leg.rests ? last_way() : normalize(way);
          leg.valid = dot(leg.heading, leg.heading) > 0.5;
          return leg;
        }
      }
    }
    return leg;
  }

 private:
  void begin(Leg& leg) const {
    const Vec3d p = probe_.state(1).position;
    leg.start = {p.x, p.z};
  }
  Vec2d last_way() const {
    const std::span<const BilliardMotion> path = probe_.path(1);
    for (std::size_t i = path.size(); i-- > 0;)
      if (path[i].phase == BallPhase::rolling) return normalize(Vec2d{path[i].velocity.x, path[i].velocity.z});
    return {};
  }

  Billiards probe_;
  ShotGoal goal_;
  ShotOptions options_;
  std::vector<Vec2d> balls_;
};

/// On which side, and how far, the leg passes the goal; NaN: it does not lead there.
double side_of(const Leg& leg, Vec2d goal) {
  if (!leg.valid || dot(leg.heading, goal - leg.start) <= 0) return std::numeric_limits<double>::quiet_NaN();
  return cross(leg.heading, goal - leg.end);
}

struct Window {
  double middle = 0, half = 0;
};

/// The directions in which the cue ball may meet the object ball.
std::vector<Window> windows(const Billiards& layout, const ShotGoal& goal, Vec2d cue, Vec2d object) {
  const double reach = 2 * layout.physics().ball.radius;
  std::vector<Window> found;
  const auto look = [&](Vec2d at, double more) {
    const double far = distance(cue, at);
    found.push_back(
        {aim_direction(at - cue), math::asin(math::min(1.0, reach / far)) * (1 + more) + math::radians(3.0)});
  };
  if (goal.cue_cushions == 0) {
    look(object, 0);
    return found;
  }
  const double nose = 0.96 * layout.physics().ball.radius;
  for (const BilliardTable::Edge& e : layout.table().edges()) {
    if (e.length < 6 * reach) continue;
    const double behind = dot(e.inward, object) - e.offset - nose;
    const Vec2d mirrored = object - 2 * behind * e.inward;
    if (behind > 0 && dot(e.inward, cue) - e.offset > 0) look(mirrored, 1);
  }
  return found;
}

struct Root {
  double direction = 0, slope = 0, side = 0;
  Leg leg{};
};

/// Every direction in the window that leads to the goal at this speed.
void find_roots(ShotTrials& trials, const Window& window, double speed, std::span<const Vec2d> goals, int samples,
                std::vector<std::pair<Root, Vec2d>>& roots) {
  std::vector<Leg> legs;
  const auto at = [&](int i) { return window.middle + window.half * (2.0 * i / samples - 1); };
  for (int i = 0; i <= samples; ++i) legs.push_back(trials.play(at(i), speed));
  for (const Vec2d goal : goals)
    for (int i = 0; i < samples; ++i) {
      double low = at(i), high = at(i + 1), f_low = side_of(legs[std::size_t(i)], goal),
             f_high = side_of(legs[std::size_t(i) + 1], goal);
      if (!((f_low <= 0 && f_high > 0) || (f_low >= 0 && f_high < 0))) continue;
      if (dot(legs[std::size_t(i)].heading, legs[std::size_t(i) + 1].heading) < 0.5) continue;
      Root root;
      root.slope = (f_high - f_low) / (high - low);
      double kept_low = f_low, kept_high = f_high;
      for (int k = 0; k < 60 && high - low > 1e-12; ++k) {  // Illinois
        double t = low + (high - low) * kept_low / (kept_low - kept_high);
        if (!(t > low && t < high)) t = 0.5 * (low + high);
        root.leg = trials.play(t, speed);
        root.direction = t;
        root.side = side_of(root.leg, goal);
        if (root.side != root.side || math::abs(root.side) < 1e-9) break;
        if ((root.side > 0) == (f_low > 0)) {
          low = t, kept_low = root.side;
          kept_high *= 0.5;
        } else {
          high = t, kept_high = root.side;
          kept_low *= 0.5;
        }
      }
      if (math::abs(root.side) < 1e-3) roots.push_back({root, goal});
    }
}

struct Verified {
  bool good = false;
  double off = 0, arrival = 0;
};

/// Plays the stroke on the whole table.
Verified verify(Billiards& table, const Billiards& layout, const Stroke& stroke, const ShotGoal& goal,
                const ShotOptions& options) {
  table = layout;
  Verified v;
  const std::size_t seen = table.events().size();
  if (!table.strike(options.cue_ball, stroke, options.cue) || !table.run()) return v;
  bool first = true;
  for (const BilliardEvent& e : table.events().subspan(math::min(seen, table.events().size()))) {
    if (e.kind == Kind::ball && first) {
      first = false;
      if (!(math::min(e.ball, e.other) == math::min(options.cue_ball, goal.object) &&
            math::max(e.ball, e.other) == math::max(options.cue_ball, goal.object)))
        return v;
    }
    if (e.kind == Kind::pocket && e.ball == goal.object) v.arrival = e.speed;
  }
  const BilliardState cue = table.state(options.cue_ball), object = table.state(goal.object);
  if (options.keep_cue_ball && !in_play(cue.phase)) return v;
  if (goal.pocket >= 0) {
    v.good = table.pocket_of(goal.object) == goal.pocket && v.arrival >= options.arrival;
  } else {
    v.off = distance(Vec2d{object.position.x, object.position.z}, goal.place);
    v.good = in_play(object.phase) && v.off <= goal.tolerance;
  }
  return v;
}

/// Puts the aim of a shot that pots into the middle of those that do, found by playing; `about` is how far they reach
/// by geometry.
void center_aim(Billiards& table, const Billiards& layout, ShotSolution& shot, double about, const ShotGoal& goal,
                const ShotOptions& options) {
  double reach[2] = {};
  for (int side = 0; side < 2; ++side) {
    double good = 0, bad = 4 * about;
    for (int i = 0; i < 10; ++i) {
      const double middle = 0.5 * (good + bad);
      Stroke off = shot.stroke;
      off.direction += side == 0 ? -middle : middle;
      (verify(table, layout, off, goal, options).good ? good : bad) = middle;
    }
    reach[side] = good;
  }
  Stroke middle = shot.stroke;
  middle.direction += 0.5 * (reach[1] - reach[0]);
  const Verified v = verify(table, layout, middle, goal, options);
  if (v.good) {
    shot.stroke = middle;
    shot.arrival = v.arrival;
    shot.window = 0.5 * (reach[0] + reach[1]);
  } else {
    shot.window = math::min(reach[0], reach[1]);
  }
}

}  // namespace

core::Result<std::optional<ShotSolution>> solve_shot(const Billiards& layout, const ShotGoal& goal,
                                                     const ShotOptions& options) {
  const auto refuse = [](std::string_view field, auto found, std::string_view expected) {
    return core::Error{core::text("shot: ", core::refused(field, found, expected))};
  };
  const int n = layout.balls();
  if (options.cue_ball < 0 || options.cue_ball >= n) return refuse("cue_ball", options.cue_ball, "a ball on the table");
  if (goal.object < 0 || goal.object >= n || goal.object == options.cue_ball)
    return refuse("object", goal.object, "a ball on the table other than the cue ball");
  for (const int ball : {options.cue_ball, goal.object})
    if (layout.motion(ball).phase != BallPhase::resting) return refuse("ball", ball, "one that rests on the bed");
  if (goal.pocket >= int(layout.table().pockets().size()) || goal.pocket < -1)
    return refuse("pocket", goal.pocket, "a pocket of the table, or -1 for a place");
  if (goal.object_cushions < 0 || goal.object_cushions > 1 || goal.cue_cushions < 0 || goal.cue_cushions > 1)
    return refuse("cushions", math::max(goal.object_cushions, goal.cue_cushions), "0 or 1");
  if (goal.pocket < 0 && (!is_finite(goal.place) || !layout.table().inside(goal.place) || !(goal.tolerance > 0)))
    return core::Error{"shot: the place must lie on the table, the tolerance above 0"};
  if (!(options.slowest > 0 && options.fastest >= options.slowest && options.fastest < 100) || options.speeds < 1 ||
      options.speeds > 1000)
    return core::Error{"shot: speeds must be 0 < slowest <= fastest < 100 m/s, 1 to 1000 of them"};
  if (const auto possible =
          strike_cue({0, 1, options.side, options.height, options.elevation}, options.cue, layout.physics().ball);
      !possible)
    return possible.error();

  const auto seen = [&](int ball) {
    const Vec3d p = layout.state(ball).position;
    return Vec2d{p.x, p.z};
  };
  const Vec2d cue = seen(options.cue_ball), object = seen(goal.object);
  core::Result<Billiards> probe = Billiards::create(layout.table(), layout.physics());
  if (!probe) return probe.error();
  ShotTrials trials(std::move(*probe), goal, options, cue, object);
  Billiards table = layout;

  std::vector<Vec2d> goals;
  double mouth = 0;
  if (goal.pocket >= 0) {
    const TablePocket& pocket = layout.table().pockets()[std::size_t(goal.pocket)];
    Vec2d middle{};
    for (const TableCorner& c : layout.table().definition().outline)
      middle += c.point / double(layout.table().definition().outline.size());
    for (const double toward : {0.0, 0.7, 1.2})
      goals.push_back(pocket.center + toward * pocket.radius * normalize(middle - pocket.center));
    mouth = math::max(0.0, pocket.radius - 0.9 * layout.physics().ball.radius);
  } else {
    goals.push_back(goal.place);
  }
  const std::vector<Window> ways = windows(layout, goal, cue, object);
  const int samples = goal.object_cushions + goal.cue_cushions > 0 ? 96 : 48;
  const auto speed_at = [&](double part) {
    return options.slowest * math::pow(options.fastest / options.slowest, part);
  };

  std::vector<std::pair<Root, Vec2d>> roots;
  if (goal.pocket >= 0) {
    for (int i = 0; i < options.speeds; ++i) {
      const double speed = speed_at(options.speeds > 1 ? double(i) / (options.speeds - 1) : 1);
      std::optional<ShotSolution> best;
      for (const Window& way : ways) {
        roots.clear();
        find_roots(trials, way, speed, goals, samples, roots);
        for (const auto& [root, aim] : roots) {
          const Stroke stroke = trials.stroke(root.direction, speed);
          const Verified v = verify(table, layout, stroke, goal, options);
          if (!v.good) continue;
          ShotSolution shot{stroke, 0, 0, v.arrival};
          center_aim(table, layout, shot, mouth / math::max(math::abs(root.slope), 1e-9), goal, options);
          if (!best || shot.window > best->window) best = shot;
        }
      }
      if (best) return best;
    }
    return std::optional<ShotSolution>{};
  }

  // To a place: for each speed the directions that lead over it, then between two speeds the one at which it stops
  // there. Above zero: it comes to rest beyond the place, or is stopped there by something.
  const auto beyond = [&](const Root& root) {
    const double left = dot(root.leg.heading, goal.place - root.leg.end);
    return root.leg.rests ? -left : math::max(-left, 1e-6);
  };
  for (const Window& way : ways) {
    std::vector<std::pair<Root, Vec2d>> before;
    double slower = 0;
    for (int i = 0; i < options.speeds; ++i) {
      const double speed = speed_at(options.speeds > 1 ? double(i) / (options.speeds - 1) : 1);
      roots.clear();
      find_roots(trials, way, speed, goals, samples, roots);
      for (const auto& [start, aim] : before)
        for (const auto& [end, same] : roots) {
          if (!(beyond(start) <= 0 && beyond(end) > 0) || math::abs(start.direction - end.direction) > 0.05) continue;
          double low = slower, high = speed;
          Root at = end;
          std::vector<std::pair<Root, Vec2d>> here;
          for (int k = 0; k < 40 && high - low > 1e-9; ++k) {
            const double middle = 0.5 * (low + high);
            here.clear();
            const double spread = 1.5 * math::abs(start.direction - end.direction) + 1e-3;
            find_roots(trials, {0.5 * (start.direction + end.direction), spread}, middle, goals, 6, here);
            if (here.empty()) break;
            at = here.front().first;
            (beyond(at) > 0 ? high : low) = middle;
          }
          const Stroke stroke = trials.stroke(at.direction, low);
          const Verified v = verify(table, layout, stroke, goal, options);
          if (v.good) return std::optional<ShotSolution>{ShotSolution{stroke, v.off, 0, 0}};
        }
      before = roots;
      slower = speed;
    }
  }
  return std::optional<ShotSolution>{};
}

}  // namespace carom::sports
