#include "carom/sports/cushion.h"

#include "carom/math/elementary.h"
#include "carom/sports/billiards.h"

namespace carom::sports {

using math::Vec3d;

namespace {

/// Velocity of the contact point across `toward`.
Vec3d cushion_slip(const BilliardState& s, Vec3d toward, double radius) {
  const Vec3d u = s.velocity + radius * cross(s.angular_velocity, toward);
  return u - dot(u, toward) * toward;
}

/// An impulse per mass along −toward and one across it, at the contact.
void push_off(BilliardState& s, Vec3d toward, double normal, Vec3d across, bool on_bed, double radius) {
  s.velocity += across - normal * toward;
  s.angular_velocity += (2.5 / radius) * cross(toward, across);
  if (on_bed) s.velocity.y = 0;
}

/// Mathavan et al. 2010. Impulses per mass; the work of the normal impulse decides where restitution ends.
void integrate_cushion(BilliardState& s, Vec3d toward, const BilliardPhysics& physics) {
  const double radius = physics.ball.radius, mu = physics.cushion.friction, bed = physics.cloth.sliding_friction;
  const double spin = 2.5 / radius;
  Vec3d v = s.velocity, w = s.angular_velocity;
  const auto advance = [&](double impulse) {
    Vec3d u = v + radius * cross(w, toward);
    u -= dot(u, toward) * toward;
    const Vec3d friction = (-mu * impulse) * normalize_or(u, Vec3d{}, 1e-14);
    const Vec3d push = friction - impulse * toward;
    // The bed carries what presses the ball down, and rubs.
    const double load = math::max(0.0, -push.y);
    const Vec3d slip{v.x + radius * w.z, 0, v.z - radius * w.x};
    const Vec3d rub = (-bed * load) * normalize_or(slip, Vec3d{}, 1e-14);
    v += Vec3d{push.x, 0, push.z} + rub;
    w += spin * (cross(toward, friction) + Vec3d{-rub.z, 0, rub.x});
  };
  const double level = dot(v, toward);
  const double step = level / physics.cushion.steps;
  double work = 0, before = level;
  int guard = 64 * physics.cushion.steps;
  while (before > 0 && guard-- > 0) {
    advance(step);
    const double now = dot(v, toward);
    work += 0.5 * step * (now + before);
    before = now;
  }
  double left = work * math::square(physics.cushion.restitution);
  while (left > 0 && guard-- > 0) {
    const Vec3d old_v = v, old_w = w;
    advance(step);
    const double now = dot(v, toward), done = -0.5 * step * (now + before);
    if (done > left) {  // the last step only as far as the energy reaches
      v = old_v, w = old_w;
      advance(step * left / done);
      break;
    }
    left -= done;
    before = now;
  }
  s.velocity = v;
  s.angular_velocity = w;
}

}  // namespace

CompliantImpact stronge_impact(double tangential, double normal, double restitution, double friction,
                               double frequency_ratio, double beta_tangential, double beta_normal) {
  const double approach = -normal;
  if (!(approach > 0)) return {tangential, normal};
  // Time in units of 1/ω, speeds in units of the approach; s(t) is the normal force, p(t) its impulse.
  const double e = restitution, r = frequency_ratio, q = beta_tangential / beta_normal, limit = friction * q;
  const double sign = tangential < 0 ? -1 : 1, x = sign * tangential / approach;
  const double half = math::pi / 2, last = half * (1 + e);
  const auto restored = [&](double t) { return t / e + half * (1 - 1 / e); };
  const auto force = [&](double t) { return t <= half ? math::sin(t) : math::sin(restored(t)); };
  const auto impulse = [&](double t) { return t <= half ? 1 - math::cos(t) : 1 - e * math::cos(restored(t)); };
  if (!(e > 0)) return {sign * approach * math::max(0.0, x - limit), 0};
  if (!(limit > 0)) return {tangential, e * approach};
  double t = 0, speed = x, stretch = 0, way = 1;  // way: of the slip
  bool slips = x > limit / (r * r);
  for (int phase = 0; phase < 16; ++phase) {
    if (slips) {
      // Until the contact point is no faster than the end of its spring: speed = limit ds/dt/r².
      const double k = 1 - impulse(t) - way * speed / limit;
      const double in_compression = k / (1 - 1 / (r * r)), in_restitution = k / (e - 1 / (e * r * r));
      double until = last;
      if (in_compression >= 0 && in_compression <= 1) until = math::acos(in_compression);
      if (!(until > t + 1e-9) || until > half) {
        until = last;
        if (in_restitution <= 0 && in_restitution >= -1) until = half + e * (math::acos(in_restitution) - half);
        if (!(until > t + 1e-9)) until = last;
      }
      speed -= way * limit * (impulse(until) - impulse(t));
      if (until >= last) break;
      t = until;
      stretch = way * limit * force(t) / (r * r);
      slips = false;
      continue;
    }
    // It sticks and the spring swings, until friction can no longer hold it.
    const auto held = [&](double at) {
      const math::SinCos<double> turn = math::sincos(r * (at - t));
      return stretch * turn.cos + speed / r * turn.sin;
    };
    const auto spare = [&](double at) { return limit * force(at) - r * r * math::abs(held(at)); };
    const int scan = r < 2 ? 12 : 12 + int(math::min(8 * r, 200.0));
    double low = t, high = last;
    for (int i = 1; i < scan; ++i) {
      const double at = t + (last - t) * i / scan;
      if (spare(at) <= 0 && (i > 1 || at > half)) {
        high = at;
        break;
      }
      low = at;
    }
    double at_low = low == t ? 0 : spare(low), at_high = spare(high);
    for (int i = 0; i < 60 && high - low > 1e-13; ++i) {  // Illinois
      double at = at_low > 0 && at_high < 0 ? low + (high - low) * at_low / (at_low - at_high) : 0.5 * (low + high);
      if (!(at > low && at < high)) at = 0.5 * (low + high);
      const double left = spare(at);
      if (left > 0) {
        low = at, at_low = left;
        at_high *= 0.5;
      } else {
        high = at, at_high = left;
        at_low *= 0.5;
      }
      if (left == 0) break;
    }
    const math::SinCos<double> turn = math::sincos(r * (high - t));
    way = held(high) < 0 ? -1 : 1;
    speed = speed * turn.cos - stretch * r * turn.sin;
    t = high;
    slips = true;
  }
  return {sign * approach * speed, e * approach};
}

double strike_cushion(BilliardState& s, Vec3d toward, bool on_bed, const BilliardPhysics& physics) {
  const CushionContact& c = physics.cushion;
  const double radius = physics.ball.radius, approach = dot(s.velocity, toward);
  if (!(approach > 0)) return 0;
  if (c.model == CushionModel::mathavan && on_bed) {
    integrate_cushion(s, toward, physics);
    return approach;
  }
  const Vec3d slip = cushion_slip(s, toward, radius);
  const double speed = math::length(slip);
  Vec3d across{};
  if (speed > 1e-14) {
    double change = 0;
    if (c.model == CushionModel::stronge)
      change =
          (stronge_impact(speed, -approach, c.restitution, c.friction, c.frequency_ratio, 3.5, 1).tangential - speed) /
          3.5;
    else
      change = -math::min(c.friction * (1 + c.restitution) * approach, speed * (2.0 / 7));
    across = (change / speed) * slip;
  }
  push_off(s, toward, (1 + c.restitution) * approach, across, on_bed, radius);
  return approach;
}

}  // namespace carom::sports
