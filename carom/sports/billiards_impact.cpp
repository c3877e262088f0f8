// Balls on balls, balls on the bed.
#include "carom/sports/billiards.h"
#include "carom/sports/detail/billiards_rub.h"

namespace carom::sports {

using math::Vec3d;

namespace {

/// Mathavan et al. 2014: both balls on the bed, which carries and rubs the one that friction presses down.
void integrate_balls(BilliardState& a, BilliardState& b, Vec3d n, double approach, const BilliardPhysics& p) {
  const double r = p.ball.radius, spin = 2.5 / r, bed = p.cloth.sliding_friction;
  const BallContact& c = p.balls;
  Vec3d va = a.velocity, vb = b.velocity, wa = a.angular_velocity, wb = b.angular_velocity;
  const auto rub = [&](Vec3d& v, Vec3d& w, double load) {
    if (!(load > 0)) return;
    const Vec3d slip{v.x + r * w.z, 0, v.z - r * w.x};
    const Vec3d f = (-bed * load) * normalize_or(slip, Vec3d{}, 1e-14);
    v += f;
    w += spin * Vec3d{-f.z, 0, f.x};
  };
  const auto advance = [&](double impulse) {
    Vec3d u = va - vb + r * cross(wa + wb, n);
    u -= dot(u, n) * n;
    const double speed = math::length(u);
    const Vec3d f = speed > 1e-14 ? (-ball_friction(c, speed) * impulse / speed) * u : Vec3d{};
    va += Vec3d{f.x, 0, f.z} - impulse * n;
    vb += impulse * n - Vec3d{f.x, 0, f.z};
    const Vec3d turn = spin * cross(n, f);
    wa += turn;
    wb += turn;
    rub(va, wa, -f.y);
    rub(vb, wb, f.y);
  };
  const double step = 0.5 * approach / c.steps;
  double work = 0, before = approach;
  int guard = 64 * c.steps;
  while (before > 0 && guard-- > 0) {
    advance(step);
    const double now = dot(va - vb, n);
    work += 0.5 * step * (now + before);
    before = now;
  }
  double left = work * math::square(c.restitution);
  while (left > 0 && guard-- > 0) {
    const Vec3d keep[4] = {va, vb, wa, wb};
    advance(step);
    const double now = dot(va - vb, n), done = -0.5 * step * (now + before);
    if (done > left) {
      va = keep[0], vb = keep[1], wa = keep[2], wb = keep[3];
      advance(step * left / done);
      break;
    }
    left -= done;
    before = now;
  }
  a.velocity = va, b.velocity = vb;
  a.angular_velocity = wa, b.angular_velocity = wb;
}

void meet_bed(BilliardState& s, const BilliardPhysics& p, double restitution) {
  const double r = p.ball.radius, down = -s.velocity.y;
  if (!(down > 0)) return;
  const double up = restitution * down;
  const bool bounces = up > p.cloth.bounce_threshold;
  const Vec3d slip = bed_slip(s, r);
  const double speed = math::length(slip);
  if (speed > 1e-14) {
    const double push = math::min(p.cloth.sliding_friction * (down + (bounces ? up : 0)), speed * (2.0 / 7));
    const Vec3d f = (-push / speed) * slip;
    s.velocity += f;
    s.angular_velocity += (2.5 / r) * Vec3d{-f.z, 0, f.x};
  }
  s.velocity.y = bounces ? up : 0;
  s.phase = bounces ? BallPhase::airborne : BallPhase::sliding;
}

}  // namespace

double strike_balls(BilliardState& a, BilliardState& b, Vec3d n, bool on_bed, const BilliardPhysics& p) {
  const double approach = dot(a.velocity - b.velocity, n);
  if (!(approach > 0)) return 0;
  const BallContact& c = p.balls;
  if (c.model == BallContact::Model::mathavan && on_bed) {
    integrate_balls(a, b, n, approach, p);
    return approach;
  }
  const double r = p.ball.radius, push = 0.5 * (1 + c.restitution) * approach;
  Vec3d u = a.velocity - b.velocity + r * cross(a.angular_velocity + b.angular_velocity, n);
  u -= dot(u, n) * n;
  a.velocity -= push * n;
  b.velocity += push * n;
  detail::rub_balls(a, b, n, push, u, p);
  if (on_bed) a.velocity.y = b.velocity.y = 0;
  return approach;
}

void drop_on_bed(BilliardState& s, const BilliardPhysics& p) { meet_bed(s, p, p.cloth.restitution); }
void press_on_bed(BilliardState& s, const BilliardPhysics& p) { meet_bed(s, p, 0); }

}  // namespace carom::sports
