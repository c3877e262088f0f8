#include "carom/sports/cue.h"

#include "carom/core/string.h"

namespace carom::sports {

using math::Vec3d;

double squirt_angle(double a, double mass_ratio) {
  const double b = 1 - a * a;
  return math::atan(2.5 * a * math::sqrt(b) / (1 + mass_ratio + 2.5 * b));
}

core::Result<CueImpact> strike_cue(const Stroke& stroke, const Cue& cue, const BilliardBall& ball) {
  const struct {
    const char* name;
    double value, low, high;
    const char* expected;
  } fields[] = {
      {"cue mass", cue.mass, 1e-6, 1e6, "a mass in kg > 0"},
      {"cue end_mass", cue.end_mass, 0, 1e6, "a mass in kg, 0 for none"},
      {"cue tip_friction", cue.tip_friction, 0, 100, "a number from 0 to 100"},
      {"cue restitution", cue.restitution, 0, 1, "a number from 0 to 1"},
      {"stroke direction", stroke.direction, -1e9, 1e9, "an angle in rad"},
      {"stroke speed", stroke.speed, 0, 1e3, "a speed from 0 to 1000 m/s"},
      {"stroke side", stroke.side, -1, 1, "an offset within the ball"},
      {"stroke height", stroke.height, -1, 1, "an offset within the ball"},
      {"stroke elevation", stroke.elevation, 0, 1.5708, "an angle from 0 to 90°"},
  };
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || field.value < field.low || field.value > field.high)
      return core::Error{core::refused(field.name, field.value, field.expected)};
  const double a = stroke.side, b = stroke.height, off = a * a + b * b;
  if (!(off < 1)) return core::Error{core::refused("stroke offset", math::sqrt(off), "less than the ball's radius")};

  const math::SinCos<double> turn = math::sincos(stroke.direction), rise = math::sincos(stroke.elevation);
  const Vec3d ahead{turn.cos, 0, -turn.sin};
  const Vec3d right{turn.sin, 0, turn.cos};
  const Vec3d along = rise.cos * ahead - Vec3d{0, rise.sin, 0};
  const Vec3d up = rise.sin * ahead + Vec3d{0, rise.cos, 0};
  const Vec3d contact = a * right + b * up - math::sqrt(1 - off) * along;  // in R
  CueImpact result;
  // Within the tip's cone of friction the impulse is along the cue; beyond it, along the cone's edge.
  Vec3d push = along;
  const double hold = 1 / math::sqrt(1 + cue.tip_friction * cue.tip_friction), lean = math::sqrt(1 - off);
  if (lean < hold) {
    result.miscue = true;
    const Vec3d across = normalize(along + lean * contact);
    push = hold * -contact + math::sqrt(1 - hold * hold) * across;
  }
  const Vec3d arm = cross(contact, push);
  const double given = (1 + cue.restitution) * stroke.speed * dot(along, push) /
                       (1 + 2.5 * length_squared(arm) + ball.mass / cue.mass * math::square(dot(along, push)));
  result.velocity = given * push;
  result.angular_velocity = (2.5 * given / ball.radius) * arm;
  if (cue.end_mass > 0 && !result.miscue) {
    // The ball is pushed to the other side than the one that is struck.
    result.squirt = squirt_angle(a, ball.mass / cue.end_mass);
    const math::SinCos<double> s = math::sincos(result.squirt);
    const Vec3d v = result.velocity;
    result.velocity = {s.cos * v.x + s.sin * v.z, v.y, s.cos * v.z - s.sin * v.x};
  }
  return result;
}

}  // namespace carom::sports
