// When what happens: the events of one ball, and the meetings of pairs.
#include "carom/sports/billiards_engine.h"
#include "carom/sports/detail/billiards_pieces.h"
#include "carom/sports/detail/billiards_root.h"

namespace carom::sports {

using math::Vec2d;
using math::Vec3d;

void Billiards::predict() {
  for (const int ball : changed_) predict_own(ball);
  for (const int ball : changed_) predict_pairs(ball);
  changed_.clear();
}

void Billiards::predict_own(int ball) {
  const std::size_t k = std::size_t(ball);
  const BilliardMotion& m = motion_[k];
  Next& next = own_[k];
  next = {m.end, Own::phase, -1};
  if (!in_play(m.phase) || m.phase == BallPhase::resting) {
    next.time = never;
    return;
  }
  double limit = m.end - m.start;
  if (m.phase == BallPhase::airborne) {
    predict_flight(ball, next, limit);
    return;
  }
  const Vec2d p{m.position.x, m.position.z}, v{m.velocity.x, m.velocity.z},
      h{m.half_acceleration.x, m.half_acceleration.z};
  const auto take = [&](double t, Own kind, int index) {
    limit = t;
    next = {m.start + t, kind, index};
  };
  const auto edge = [&](int i) {
    const BilliardTable::Edge& e = table_.edges()[std::size_t(i)];
    const double s = dot(e.inward, p) - e.offset - nose_reach_;
    const double t = detail::first_descent(s, dot(e.inward, v), dot(e.inward, h), limit);
    if (!(t < limit)) return;
    const double foot = dot(e.along, p + t * (v + t * h) - e.from);
    if (foot >= 0 && foot <= e.length) take(t, Own::edge, i);
  };
  const auto jaw = [&](int i) {
    const BilliardTable::Jaw& j = table_.jaws()[std::size_t(i)];
    const double t = detail::first_contact(p - j.center, v, h, j.radius + nose_reach_, limit);
    if (t < limit) take(t, Own::jaw, i);
  };
  for (const int i : table_.free_edges()) edge(i);
  for (const int i : table_.free_jaws()) jaw(i);
  for (const BilliardTable::Group& g : table_.groups()) {
    // Along the way to the pocket: does the ball come near at all?
    const Vec2d d = p - g.center;
    const double reach = g.reach + nose_reach_, far = dot(d, d);
    if (far > reach * reach) {
      const double b = dot(d, v), c = dot(d, h);
      if (b >= 0 && c >= 0) continue;
      const double r = math::sqrt(far);
      if (r * (r - reach) + math::min(b, 0.0) * limit + math::min(c, 0.0) * limit * limit > 0) continue;
    }
    for (const int i : g.edges) edge(i);
    for (const int i : g.jaws) jaw(i);
    const double t = detail::first_contact(d, v, h, table_.pockets()[std::size_t(g.pocket)].radius, limit);
    if (t < limit) take(t, Own::pocket, g.pocket);
  }
}

void Billiards::predict_flight(int ball, Next& next, double limit) const {
  const BilliardMotion& m = motion_[std::size_t(ball)];
  const Vec3d p = m.position, v = m.velocity, h = m.half_acceleration;
  const double r = physics_.ball.radius;
  const auto take = [&](double t, Own kind, int index) {
    limit = t;
    next = {m.start + t, kind, index};
  };
  for (std::size_t i = 0; i < table_.edges().size(); ++i) {
    const double t =
        detail::first_contact(p, v, h, r, limit, [&](Vec3d x) { return x - detail::nearest_on_rail(table_, i, x); });
    if (t < limit) take(t, Own::edge, int(i));
  }
  for (std::size_t i = 0; i < table_.jaws().size(); ++i) {
    const double t =
        detail::first_contact(p, v, h, r, limit, [&](Vec3d x) { return x - detail::nearest_on_jaw(table_, i, x); });
    if (t < limit) take(t, Own::jaw, int(i));
  }
  // It falls into a pocket where it comes below the top of the rail within the pocket's circle: the far side stops it.
  const double top = table_.nose_height() + r;
  for (std::size_t i = 0; i < table_.pockets().size(); ++i) {
    const TablePocket& pocket = table_.pockets()[i];
    const Vec2d d = Vec2d{p.x, p.z} - pocket.center;
    double t = detail::first_contact(d, Vec2d{v.x, v.z}, Vec2d{}, pocket.radius, limit);
    if (dot(d, d) < pocket.radius * pocket.radius) t = 0;
    if (!(t < limit)) continue;
    if (p.y + t * (v.y + t * h.y) > top) {
      const double down = detail::first_descent(p.y - top, v.y, h.y, limit);
      if (!(down < limit && down >= t) ||
          distance(Vec2d{p.x + down * v.x, p.z + down * v.z}, pocket.center) > pocket.radius)
        continue;
      t = down;
    }
    take(t, Own::pocket, int(i));
  }
}

double Billiards::meeting(int a, int b) const {
  const BilliardMotion& one = motion_[std::size_t(a)];
  const BilliardMotion& two = motion_[std::size_t(b)];
  const double limit = math::min(own_[std::size_t(a)].time, own_[std::size_t(b)].time) - time_;
  const double s = time_ - one.start, t = time_ - two.start, reach = 2 * physics_.ball.radius;
  if (one.phase != BallPhase::airborne && two.phase != BallPhase::airborne) {
    // On the bed: seen from above.
    const auto flat = [](Vec3d x) { return Vec2d{x.x, x.z}; };
    const Vec2d h1 = flat(one.half_acceleration), h2 = flat(two.half_acceleration);
    const Vec2d v1 = flat(one.velocity), v2 = flat(two.velocity);
    const Vec2d d = flat(two.position) - flat(one.position) + t * (v2 + t * h2) - s * (v1 + s * h1);
    const Vec2d v = v2 - v1 + (2 * t) * h2 - (2 * s) * h1;
    return time_ + detail::first_contact(d, v, h2 - h1, reach, limit);
  }
  const Vec3d d = two.position_at(time_) - one.position_at(time_), v = two.velocity_at(time_) - one.velocity_at(time_);
  return time_ + detail::first_contact(d, v, two.half_acceleration - one.half_acceleration, reach, limit);
}

void Billiards::predict_pairs(int ball) {
  const std::size_t k = std::size_t(ball);
  const BilliardMotion& m = motion_[k];
  const bool still = m.phase == BallPhase::resting, gone = !in_play(m.phase);
  best_[k] = own_[k].time;
  partner_[k] = -1;
  for (int other = 0; other < balls(); ++other) {
    if (other == ball) continue;
    const std::size_t j = std::size_t(other);
    const BallPhase phase = motion_[j].phase;
    double t = never;
    if (!gone && in_play(phase) && !(still && phase == BallPhase::resting)) t = meeting(ball, other);
    pair_[at(ball, other)] = pair_[at(other, ball)] = t;
    if (t < best_[k]) best_[k] = t, partner_[k] = other;
    if (t < best_[j])
      best_[j] = t, partner_[j] = ball;
    else if (partner_[j] == ball)
      rescan(other);
  }
}

void Billiards::rescan(int ball) {
  const std::size_t k = std::size_t(ball);
  best_[k] = own_[k].time;
  partner_[k] = -1;
  const double* row = &pair_[k * motion_.size()];
  for (int j = 0; j < balls(); ++j)
    if (row[j] < best_[k]) best_[k] = row[j], partner_[k] = j;
}

}  // namespace carom::sports
