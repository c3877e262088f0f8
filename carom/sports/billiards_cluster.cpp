// Balls that touch when one of them is struck: a rack, a cradle, two frozen balls.
//
// One pair has its closed form. In a cluster all contacts are compressed at once, and who gets what follows from their
// compression: each is an elastic contact after Hertz, F ∝ δ^(3/2), that gives back e² of the work done on it, with
// Coulomb friction, integrated through the impact while the places stay as they are. Since all contacts are alike,
// their stiffness drops out where they touch: it only scales the time. Where a small gap must close first (a loose
// rack) it counts by how deep the blow presses two balls together. (E. J. Hinch, S. Saint-Jean, "The fragmentation of a
// line of balls by an impact", Proc. R. Soc. A 455, 1999.) What still approaches slowly afterwards is solved pair by
// pair, the fastest first.
#include <algorithm>

#include "carom/sports/billiards_engine.h"
#include "carom/sports/detail/billiards_pieces.h"
#include "carom/sports/detail/billiards_rub.h"

namespace carom::sports {

using math::Vec3d;

void Billiards::meet_balls(int first, int second) {
  const double reach = 2 * physics_.ball.radius;
  const auto join = [&](int ball) {
    const std::size_t k = std::size_t(ball);
    states_[k] = motion_[k].at(time_);
    touched_[k] = 1;
    members_.push_back(ball);
  };
  members_.clear();
  pairs_.clear();
  join(first);
  join(second);
  // How far the blow presses two balls into each other (half a millimetre in a break): a gap that this closes belongs
  // to the same impact.
  const Vec3d between = states_[std::size_t(second)].position - states_[std::size_t(first)].position;
  const double blow =
      math::max(0.0, dot(states_[std::size_t(first)].velocity - states_[std::size_t(second)].velocity, between) /
                         math::length(between));
  const double depth = blow > 0.05 ? detail::pressed_depth(blow, physics_.balls.contact_time) : 0;
  const double near = reach + math::max(1e-10, 0.5 * depth);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const int a = members_[m];
    for (int b = 0; b < balls(); ++b) {
      const std::size_t j = std::size_t(b);
      if (b == a || !in_play(motion_[j].phase)) continue;
      const Vec3d p = touched_[j] != 0 ? states_[j].position : motion_[j].position_at(time_);
      const Vec3d d = p - states_[std::size_t(a)].position;
      const double squared = length_squared(d);
      const bool struck = math::min(a, b) == first && math::max(a, b) == second;
      if (squared > near * near && !struck) continue;
      if (touched_[j] == 0) join(b);
      if (b < a) continue;
      const bool on_bed =
          states_[std::size_t(a)].phase != BallPhase::airborne && states_[j].phase != BallPhase::airborne;
      const double far = math::sqrt(squared);
      pairs_.push_back({a, b, d / far, on_bed, struck ? 0 : math::max(0.0, far - reach)});
    }
  }
  // Each pair once: it was found from both sides only where the lower number came first.
  std::sort(pairs_.begin(), pairs_.end(),
            [](const Touching& x, const Touching& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  for (const int k : members_) touched_[std::size_t(k)] = 0;

  if (pairs_.size() > 1 && depth > 0) compress(blow, depth);
  for (int round = 0; round < 4000; ++round) {
    double fastest = 0;
    int which = -1;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const Touching& t = pairs_[i];
      if (t.gap > 1e-10) continue;
      // What is slower than this parts at the next event of its own.
      const double least = pairs_.size() == 1 && round == 0 ? 0 : 1e-9;
      const double speed = dot(states_[std::size_t(t.a)].velocity - states_[std::size_t(t.b)].velocity, t.normal);
      if (speed > least && speed > fastest) fastest = speed, which = int(i);
    }
    if (which < 0) break;
    solve_pair(which);
  }
  for (const int k : members_) {
    BilliardState& s = states_[std::size_t(k)];
    if (touched_[std::size_t(k)] == 0) continue;
    touched_[std::size_t(k)] = 0;
    if (s.phase != BallPhase::airborne) {
      // From above: the bed answers.
      if (s.velocity.y < 0) drop_on_bed(s, physics_);
      if (s.velocity.y <= physics_.cloth.bounce_threshold) s.velocity.y = 0;
    }
    apply(k, s);
  }
}

void Billiards::solve_pair(int index) {
  const Touching& t = pairs_[std::size_t(index)];
  BilliardState& a = states_[std::size_t(t.a)];
  BilliardState& b = states_[std::size_t(t.b)];
  const double speed = strike_balls(a, b, t.normal, t.on_bed, physics_);
  double& last = last_hit(t.a, t.b);
  if (time_ - last < detail::chatter_time && last >= 0 && speed < detail::chatter_speed) {
    const double parting = dot(b.velocity - a.velocity, t.normal);
    if (parting < detail::chatter_speed) {
      const Vec3d push = (0.5 * (detail::chatter_speed - parting)) * t.normal;
      a.velocity -= push;
      b.velocity += push;
    }
  }
  last = time_;
  touched_[std::size_t(t.a)] = touched_[std::size_t(t.b)] = 1;
  note(BilliardEvent::Kind::ball, t.a, t.b, speed);
}

double Billiards::motion_energy() const {
  double sum = 0;
  for (const int k : members_) {
    const BilliardState& s = states_[std::size_t(k)];
    sum += 0.5 * length_squared(s.velocity) +
           0.2 * math::square(physics_.ball.radius) * length_squared(s.angular_velocity);
  }
  return sum;
}

void Billiards::compress(double blow, double depth) {
  const double r = physics_.ball.radius, e = physics_.balls.restitution, spring_back = math::max(e * e, 1e-6);
  const auto state = [&](int ball) -> BilliardState& { return states_[std::size_t(ball)]; };
  start_.clear();
  for (const int k : members_) start_.push_back(state(k));
  const double before = motion_energy();
  // Masses and stiffness are 1: the blow alone would be pressed in by `deepest` and last 2.94 deepest/v.
  const double deepest = math::pow(0.625 * blow * blow, 0.4);
  for (Touching& t : pairs_) t.depth = -t.gap * (deepest / depth);
  constexpr int steps_of_a_contact = 50;
  const double dt = 2.94 * deepest / blow / steps_of_a_contact;
  for (int step = 0; step < 12 * steps_of_a_contact; ++step) {
    bool pressed = false;
    for (Touching& t : pairs_) {
      const BilliardState& a = state(t.a);
      const BilliardState& b = state(t.b);
      const Vec3d relative = a.velocity - b.velocity;
      const double speed = dot(relative, t.normal);
      t.depth += dt * speed;
      t.now = 0;
      const double left = t.depth - (1 - spring_back) * t.deepest;
      if (left <= 0) {
        if (t.depth <= 0) t.deepest = 0;
        if (t.gap <= 1e-10 && speed > 0.02 * blow) pressed = true;
        continue;
      }
      double force;
      if (t.depth >= t.deepest) {
        t.deepest = t.depth;
        force = t.depth * math::sqrt(t.depth);
      } else {  // back along a softer path, which returns e² of the work
        const double part = left / (spring_back * t.deepest);
        force = t.deepest * part * math::sqrt(t.deepest * part);
      }
      pressed = true;
      t.now = dt * force;
      t.push += t.now;
      Vec3d u = relative - speed * t.normal + r * cross(a.angular_velocity + b.angular_velocity, t.normal);
      const double slip = math::length(u);
      if (t.friction < 0 || step % 16 == 0) t.friction = ball_friction(physics_.balls, slip);
      t.rub = slip > 1e-12 ? (-math::min(t.friction * t.now, slip / 7) / slip) * u : Vec3d{};
    }
    if (!pressed) break;
    for (const Touching& t : pairs_) {
      if (!(t.now > 0)) continue;
      BilliardState& a = state(t.a);
      BilliardState& b = state(t.b);
      const Vec3d push = t.rub - t.now * t.normal;
      a.velocity += push;
      b.velocity -= push;
      const Vec3d turn = (2.5 / r) * cross(t.normal, t.rub);
      a.angular_velocity += turn;
      b.angular_velocity += turn;
    }
  }
  for (const Touching& t : pairs_) {
    if (!(t.push > 0)) continue;
    touched_[std::size_t(t.a)] = touched_[std::size_t(t.b)] = 1;
    last_hit(t.a, t.b) = time_;
    note(BilliardEvent::Kind::ball, t.a, t.b, 2 * t.push / (1 + e));
    if (t.on_bed) state(t.a).velocity.y = state(t.b).velocity.y = 0;
  }
  // Where nothing is lost, the steps may leave a trace more energy than there was: take back that part of the change.
  const double gained = motion_energy() - before;
  if (!(gained > 0)) return;
  double linear = 0, quadratic = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const BilliardState& s = state(members_[i]);
    const Vec3d dv = s.velocity - start_[i].velocity, dw = r * (s.angular_velocity - start_[i].angular_velocity);
    linear += dot(start_[i].velocity, dv) + 0.4 * r * dot(start_[i].angular_velocity, dw);
    quadratic += 0.5 * length_squared(dv) + 0.2 * length_squared(dw);
  }
  const double part = -linear / quadratic;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    BilliardState& s = state(members_[i]);
    s.velocity = start_[i].velocity + part * (s.velocity - start_[i].velocity);
    s.angular_velocity = start_[i].angular_velocity + part * (s.angular_velocity - start_[i].angular_velocity);
  }
}

}  // namespace carom::sports
