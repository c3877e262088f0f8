#include "carom/sports/billiards.h"

#include "carom/core/string.h"

namespace carom::sports {

using math::Vec3d;

BilliardPhysics pool_physics() { return {}; }

BilliardPhysics snooker_physics() {
  BilliardPhysics p;
  p.ball = {.mass = 0.140, .radius = 0.02619375};
  p.cloth.sliding_friction = 0.5;
  p.cloth.spinning_friction = 0.444 * p.ball.radius;
  p.cushion.friction = 0.5;
  return p;
}

BilliardPhysics carom_physics() {
  BilliardPhysics p;
  p.ball = {.mass = 0.210, .radius = 0.03075};
  p.cloth.spinning_friction = 0.444 * p.ball.radius;
  p.cushion.friction = 0.15;
  return p;
}

BilliardPhysics russian_physics() {
  BilliardPhysics p;
  p.ball = {.mass = 0.285, .radius = 0.034};
  p.cloth.spinning_friction = 0.444 * p.ball.radius;
  return p;
}

core::Status validate(const BilliardPhysics& p) {
  const struct {
    const char* name;
    double value, low, high;
    const char* expected;
  } fields[] = {
      {"ball.mass", p.ball.mass, 1e-6, 1e6, "a mass in kg > 0"},
      {"ball.radius", p.ball.radius, 1e-4, 1e2, "a radius in m from 1e-4 to 100"},
      {"cloth.sliding_friction", p.cloth.sliding_friction, 1e-4, 10, "a number from 1e-4 to 10"},
      {"cloth.rolling_friction", p.cloth.rolling_friction, 1e-6, 1, "a number from 1e-6 to 1"},
      {"cloth.spinning_friction", p.cloth.spinning_friction, 1e-8, 1, "a number from 1e-8 to 1"},
      {"cloth.restitution", p.cloth.restitution, 0, 0.99, "a number from 0 to 0.99"},
      {"cloth.bounce_threshold", p.cloth.bounce_threshold, 1e-6, 10, "a speed from 1e-6 to 10 m/s"},
      {"balls.restitution", p.balls.restitution, 0, 1, "a number from 0 to 1"},
      {"balls.friction_floor", p.balls.friction_floor, 0, 10, "a number from 0 to 10"},
      {"balls.friction_range", p.balls.friction_range, 0, 10, "a number from 0 to 10"},
      {"balls.friction_rate", p.balls.friction_rate, 0, 1e3, "a number from 0 to 1000 s/m"},
      {"balls.contact_time", p.balls.contact_time, 1e-7, 1e-2, "a time from 1e-7 to 0.01 s"},
      {"balls.steps", double(p.balls.steps), 10, 1e7, "a number from 10 to 1e7"},
      {"cushion.restitution", p.cushion.restitution, 0, 1, "a number from 0 to 1"},
      {"cushion.friction", p.cushion.friction, 0, 10, "a number from 0 to 10"},
      {"cushion.frequency_ratio", p.cushion.frequency_ratio, 1.001, 100, "a number from 1.001 to 100"},
      {"cushion.steps", double(p.cushion.steps), 10, 1e7, "a number from 10 to 1e7"},
      {"gravity", p.gravity, 1e-3, 1e4, "a number from 1e-3 to 1e4 m/s²"},
  };
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || field.value < field.low || field.value > field.high)
      return core::Error{core::text("billiards: ", core::refused(field.name, field.value, field.expected))};
  return {};
}

double energy(const BilliardState& s, const BilliardPhysics& p) {
  const double m = p.ball.mass, r = p.ball.radius;
  return m * (0.5 * length_squared(s.velocity) + 0.2 * r * r * length_squared(s.angular_velocity) +
              p.gravity * (s.position.y - r));
}

BilliardState BilliardMotion::at(double time) const {
  const double t = time - start;
  BilliardState s{position_at(time), velocity_at(time), angular_velocity + t * angular_acceleration, phase};
  if (phase == BallPhase::airborne || !in_play(phase)) return s;
  s.angular_velocity.y = time >= spin_end ? 0 : angular_velocity.y * ((spin_end - time) / (spin_end - start));
  return s;
}

BilliardState BilliardMotion::at_end(const BilliardPhysics& p) const {
  BilliardState s = at(end);
  if (phase == BallPhase::airborne) {
    s.position.y = p.ball.radius;
    drop_on_bed(s, p);
  } else if (phase == BallPhase::sliding) {
    // Slip is over, to the last bit.
    const Vec3d spin = rolling_spin(s.velocity, p.ball.radius);
    s.angular_velocity = {spin.x, s.angular_velocity.y, spin.z};
  } else if (phase == BallPhase::rolling) {
    s.velocity = {};
    s.angular_velocity = {0, s.angular_velocity.y, 0};
  }
  return s;
}

BilliardMotion motion_from(const BilliardState& s, const BilliardPhysics& p, double time) {
  constexpr double still = 1e-10;  // m/s
  const double r = p.ball.radius, g = p.gravity;
  BilliardMotion m;
  m.start = time;
  m.position = s.position;
  m.phase = s.phase;
  if (!in_play(s.phase)) return m;
  m.velocity = s.velocity;
  m.angular_velocity = s.angular_velocity;
  if (s.phase == BallPhase::airborne || s.position.y > r || s.velocity.y > 0) {
    m.phase = BallPhase::airborne;
    m.half_acceleration = {0, -0.5 * g, 0};
    const double drop = math::max(0.0, s.position.y - r), vy = s.velocity.y;
    const double root = math::sqrt(vy * vy + 2 * g * drop);
    m.end = time + (vy > 0 ? (vy + root) / g : (drop > 0 ? 2 * drop / (root - vy) : 0));
    return m;
  }
  m.position.y = r;
  m.velocity.y = 0;
  m.spin_end = time + math::abs(s.angular_velocity.y) * (2 * r) / (5 * p.cloth.spinning_friction * g);
  const Vec3d slip = bed_slip(s, r);
  const double slip_speed = math::length(slip), speed = math::length(m.velocity);
  if (slip_speed > still) {
    m.phase = BallPhase::sliding;
    const double a = p.cloth.sliding_friction * g;
    const Vec3d u = slip / slip_speed;
    m.half_acceleration = (-0.5 * a) * u;
    m.angular_acceleration = (2.5 * a / r) * Vec3d{u.z, 0, -u.x};
    m.end = time + 2 * slip_speed / (7 * a);
  } else if (speed > still) {
    m.phase = BallPhase::rolling;
    const double a = p.cloth.rolling_friction * g;
    const Vec3d spin = rolling_spin(m.velocity, r), slower = rolling_spin((-a / speed) * m.velocity, r);
    m.half_acceleration = (-0.5 * a / speed) * m.velocity;
    m.angular_velocity = {spin.x, s.angular_velocity.y, spin.z};
    m.angular_acceleration = slower;
    m.end = time + speed / a;
  } else {
    m.phase = BallPhase::resting;
    m.velocity = {};
    m.angular_velocity = {0, s.angular_velocity.y, 0};
  }
  return m;
}

}  // namespace carom::sports
