#include "carom/sports/billiards_engine.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/sports/detail/billiards_pieces.h"

namespace carom::sports {

using math::Vec2d;
using math::Vec3d;

core::Result<Billiards> Billiards::create(const BilliardTable& table, const BilliardPhysics& physics,
                                          const BilliardOptions& options) {
  if (const core::Status good = validate(physics); !good) return good.error();
  const double r = physics.ball.radius, nose = table.nose_height();
  if (!(nose >= r && nose < 1.95 * r))
    return core::Error{core::text(
        "billiards: ", core::refused("the table's nose_height", nose, "from the ball's radius up to 1.95 radii"))};
  if (options.most_events < 1)
    return core::Error{core::text("billiards: ", core::refused("most_events", options.most_events, "1 or more"))};
  return Billiards(table, physics, options);
}

Billiards::Billiards(BilliardTable table, const BilliardPhysics& physics, const BilliardOptions& options)
    : table_(std::move(table)), physics_(physics), options_(options) {
  const double r = physics.ball.radius, up = table_.nose_height() - r;
  nose_reach_ = math::sqrt(r * r - up * up);
  sine_ = up / r;
}

core::Status Billiards::check_place(int ball, Vec3d p) const {
  const double r = physics_.ball.radius;
  const Vec2d seen{p.x, p.z};
  if (!is_finite(p)) return core::Error{core::text("billiards: the position of ball ", ball, " is not finite")};
  if (p.y < r - 1e-9) return core::Error{core::text("billiards: ball ", ball, " is below the bed")};
  const bool low = p.y < r + table_.nose_height();
  if (low && (!table_.inside(seen) || table_.pocket_at(seen) >= 0))
    return core::Error{core::text("billiards: ball ", ball, " at (", p.x, ", ", p.z, ") m is not on the bed")};
  if (low && table_.clearance(seen) < nose_reach_ - 1e-9)
    return core::Error{core::text("billiards: ball ", ball, " at (", p.x, ", ", p.z, ") m lies in a cushion")};
  return {};
}

core::Status Billiards::place(std::span<const Vec2d> balls) {
  const std::size_t n = balls.size();
  if (n < 1 || n > 64) return core::Error{core::text("billiards: ", core::refused("number of balls", n, "1 to 64"))};
  const double r = physics_.ball.radius;
  for (std::size_t i = 0; i < n; ++i) {
    if (core::Status good = check_place(int(i), {balls[i].x, r, balls[i].y}); !good) return good;
    for (std::size_t k = 0; k < i; ++k)
      if (distance(balls[i], balls[k]) < 2 * r - 1e-9)
        return core::Error{core::text("billiards: balls ", k, " and ", i, " overlap")};
  }
  motion_.clear();
  for (const Vec2d ball : balls) motion_.push_back(motion_from({{ball.x, r, ball.y}}, physics_, 0));
  time_ = 0;
  count_ = 0;
  events_.clear();
  own_.assign(n, {});
  pair_.assign(n * n, never);
  last_hit_.assign(n * n, -1);
  best_.assign(n, never);
  partner_.assign(n, -1);
  cushion_hit_.assign(n, -1);
  cushion_piece_.assign(n, -1);
  pocketed_.assign(n, -1);
  changed_.clear();
  history_.resize(n);
  states_.resize(n);
  start_.reserve(n);
  touched_.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    history_[i].clear();
    if (options_.record) history_[i].push_back(motion_[i]);
  }
  return {};
}

core::Status Billiards::set_state(int ball, const BilliardState& state) {
  if (ball < 0 || ball >= balls())
    return core::Error{core::text("billiards: ", core::refused("ball", ball, "one that was placed"))};
  if (!is_finite(state.velocity) || !is_finite(state.angular_velocity) || length_squared(state.velocity) > 1e8 ||
      length_squared(state.angular_velocity) > 1e12)
    return core::Error{core::text("billiards: the velocity or spin of ball ", ball, " is not finite or too great")};
  if (in_play(state.phase)) {
    if (const core::Status good = check_place(ball, state.position); !good) return good;
    for (int k = 0; k < balls(); ++k)
      if (k != ball && in_play(motion_[std::size_t(k)].phase) &&
          distance(motion_[std::size_t(k)].position_at(time_), state.position) < 2 * physics_.ball.radius - 1e-9)
        return core::Error{
            core::text("billiards: balls ", math::min(k, ball), " and ", math::max(k, ball), " overlap")};
  }
  BilliardState s = state;
  if (s.position.y <= physics_.ball.radius && s.velocity.y < 0) drop_on_bed(s, physics_);
  if (s.phase != BallPhase::airborne && s.position.y <= physics_.ball.radius + 1e-9) {
    s.position.y = physics_.ball.radius;
    if (s.velocity.y <= physics_.cloth.bounce_threshold) s.velocity.y = 0;
  }
  pocketed_[std::size_t(ball)] = -1;
  apply(ball, s);
  predict();
  return {};
}

core::Result<CueImpact> Billiards::strike(int ball, const Stroke& stroke, const Cue& cue) {
  if (ball < 0 || ball >= balls() || motion_[std::size_t(ball)].phase != BallPhase::resting)
    return core::Error{core::text("billiards: ", core::refused("ball", ball, "one that rests on the bed"))};
  core::Result<CueImpact> impact = strike_cue(stroke, cue, physics_.ball);
  if (!impact) return impact;
  BilliardState s = state(ball);
  s.velocity = impact->velocity;
  s.angular_velocity += impact->angular_velocity;
  s.phase = BallPhase::sliding;
  if (stroke.hold_down)
    press_on_bed(s, physics_);
  else
    drop_on_bed(s, physics_);
  if (s.velocity.y <= physics_.cloth.bounce_threshold) s.velocity.y = 0;
  note(BilliardEvent::Kind::strike, ball, -1, stroke.speed);
  apply(ball, s);
  predict();
  return impact;
}

void Billiards::apply(int ball, const BilliardState& state) {
  const std::size_t k = std::size_t(ball);
  motion_[k] = motion_from(state, physics_, time_);
  if (options_.record) {
    std::vector<BilliardMotion>& path = history_[k];
    if (!path.empty() && path.back().start == time_)
      path.back() = motion_[k];
    else
      path.push_back(motion_[k]);
  }
  changed_.push_back(ball);
}

void Billiards::note(BilliardEvent::Kind kind, int ball, int other, double speed) {
  ++count_;
  if (options_.record) events_.push_back({time_, kind, ball, other, speed});
}

void Billiards::forget() {
  events_.clear();
  for (std::size_t i = 0; i < history_.size(); ++i) {
    history_[i].clear();
    if (options_.record) history_[i].push_back(motion_[i]);
  }
}

double Billiards::next_event_time() const {
  double first = never;
  for (const double t : best_) first = math::min(first, t);
  return first;
}

double Billiards::rest_time() const {
  double last = 0;
  for (const BilliardMotion& m : motion_) last = math::max(last, math::max(m.start, m.spin_end));
  return last;
}

BilliardState Billiards::state(int ball, double time) const {
  const std::vector<BilliardMotion>& path = history_[std::size_t(ball)];
  const auto after =
      std::upper_bound(path.begin(), path.end(), time, [](double t, const BilliardMotion& m) { return t < m.start; });
  if (after == path.begin()) return path.empty() ? state(ball) : path.front().at(path.front().start);
  return (after - 1)->at(time);
}

void Billiards::trace(int ball, double from, double until, double spacing, std::vector<Vec3d>& points) const {
  const std::span<const BilliardMotion> motions = path(ball);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const BilliardMotion& m = motions[i];
    const double next = i + 1 < motions.size() ? motions[i + 1].start : until;
    const double start = math::max(m.start, from), end = math::min(math::min(m.end, next), until);
    if (!(end > start) || m.phase == BallPhase::resting || !in_play(m.phase)) continue;
    if (points.empty() || !(points.back() == m.position_at(start))) points.push_back(m.position_at(start));
    const bool curved = m.phase != BallPhase::rolling && spacing > 0;
    const int parts = curved ? int(math::min(math::ceil((end - start) / spacing), 1e4)) : 1;
    for (int k = 1; k <= parts; ++k) points.push_back(m.position_at(start + (end - start) * k / parts));
  }
}

double Billiards::energy() const {
  double sum = 0;
  for (const BilliardMotion& m : motion_)
    if (in_play(m.phase)) sum += sports::energy(m.at(time_), physics_);
  return sum;
}

core::Status Billiards::run(double until) {
  if (!(until >= time_)) return core::Error{core::refused("until", until, "a time not before the table's")};
  const std::int64_t most = count_ + options_.most_events;
  for (;;) {
    int first = -1;
    double t = until;
    for (int i = 0; i < balls(); ++i)
      if (best_[std::size_t(i)] < t || (first < 0 && best_[std::size_t(i)] == t)) t = best_[std::size_t(i)], first = i;
    if (first < 0 || t == never) break;
    if (count_ > most)
      return core::Error{core::text("billiards: the shot has not come to rest after ", options_.most_events,
                                    " events, at ", time_, " s")};
    time_ = t;
    process(first);
    predict();
  }
  if (until < never)
    time_ = until;
  else
    time_ = math::max(time_, rest_time());
  return {};
}

void Billiards::process(int ball) {
  const std::size_t k = std::size_t(ball);
  if (partner_[k] >= 0) {
    meet_balls(math::min(ball, partner_[k]), math::max(ball, partner_[k]));
    return;
  }
  const Next next = own_[k];
  switch (next.kind) {
    case Own::phase:
      end_phase(ball);
      break;
    case Own::pocket:
      fall(ball, next.index);
      break;
    default:
      meet_cushion(ball, next);
  }
}

void Billiards::fall(int ball, int pocket) {
  BilliardState s = motion_[std::size_t(ball)].at(time_);
  note(pocket < 0 ? BilliardEvent::Kind::leaves : BilliardEvent::Kind::pocket, ball, pocket, length(s.velocity));
  s.phase = pocket < 0 ? BallPhase::off_table : BallPhase::pocketed;
  pocketed_[std::size_t(ball)] = pocket;
  apply(ball, s);
}

void Billiards::end_phase(int ball) {
  const BilliardMotion& m = motion_[std::size_t(ball)];
  if (m.phase != BallPhase::airborne) {
    const bool slid = m.phase == BallPhase::sliding;
    const BilliardState s = m.at_end(physics_);
    apply(ball, s);
    note(motion_[std::size_t(ball)].phase == BallPhase::resting || !slid ? BilliardEvent::Kind::rests
                                                                         : BilliardEvent::Kind::rolls,
         ball, -1, 0);
    return;
  }
  const Vec3d p = m.position_at(time_);
  const int pocket = table_.pocket_at({p.x, p.z});
  if (pocket >= 0 || !table_.inside({p.x, p.z})) {
    fall(ball, pocket);
    return;
  }
  note(BilliardEvent::Kind::lands, ball, -1, -m.velocity_at(time_).y);
  apply(ball, m.at_end(physics_));
}

void Billiards::meet_cushion(int ball, const Next& next) {
  const std::size_t k = std::size_t(ball);
  BilliardState s = motion_[k].at(time_);
  const Vec2d seen{s.position.x, s.position.z};
  const bool on_bed = s.phase != BallPhase::airborne, jaw = next.kind == Own::jaw;
  const std::size_t i = std::size_t(next.index);
  Vec3d toward;
  if (on_bed) {
    const Vec2d away = jaw ? normalize(seen - table_.jaws()[i].center) : table_.edges()[i].inward;
    const double cosine = nose_reach_ / physics_.ball.radius;
    toward = {-cosine * away.x, sine_, -cosine * away.y};
  } else {
    const Vec3d nearest =
        jaw ? detail::nearest_on_jaw(table_, i, s.position) : detail::nearest_on_rail(table_, i, s.position);
    toward = normalize(nearest - s.position);
  }
  const double speed = strike_cushion(s, toward, on_bed, physics_);
  const int piece = jaw ? -2 - next.index : next.index;
  // Whom its own spin drives against the cushion again and again parts from it by a hair, or it would never end.
  if (cushion_piece_[k] == piece && time_ - cushion_hit_[k] < detail::chatter_time && speed < detail::chatter_speed) {
    const double leaving = -dot(s.velocity, toward);
    if (leaving < detail::chatter_speed) {
      s.velocity -= (detail::chatter_speed - leaving) * toward;
      if (on_bed) s.velocity.y = 0;
    }
  }
  cushion_hit_[k] = time_;
  cushion_piece_[k] = piece;
  note(jaw ? BilliardEvent::Kind::jaw : BilliardEvent::Kind::cushion, ball, next.index, speed);
  if (!on_bed && toward.y < -0.999 && s.velocity.y < physics_.cloth.bounce_threshold) {
    fall(ball, -1);  // it lies on the rail
    return;
  }
  apply(ball, s);
}

}  // namespace carom::sports
