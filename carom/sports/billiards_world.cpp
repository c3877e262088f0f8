#include "carom/sports/billiards_world.h"

#include "carom/math/elementary.h"

namespace carom::sports {

using math::Vec2d;
using math::Vec3d;

namespace {
/// Of the radius: a ball that is no higher than this above its place on the bed lies on it.
constexpr double near_bed = 0.02;
/// Of the speed: bodies sink into their contacts by a thousandth of a radius, so that they roll on a shorter arm.
constexpr double rolling_slip = 0.01;
}  // namespace

rigid::CustomEffector<rigid::Dim3> cloth_effector(const BilliardPhysics& physics, rigid::BodyId body, double step,
                                                  double bed) {
  rigid::CustomEffector<rigid::Dim3> effector;
  effector.body = body;
  effector.model = [physics, step, bed](const rigid::EffectorInput<rigid::Dim3>& input) {
    const double r = physics.ball.radius, m = physics.ball.mass, g = physics.gravity, inertia = 0.4 * m * r * r;
    const Cloth& cloth = physics.cloth;
    rigid::Wrench<rigid::Dim3> load;
    if (input.state.center_of_mass.y - bed > (1 + near_bed) * r) return load;
    const BilliardState ball{{}, Vec3d(input.state.linear_velocity), Vec3d(input.state.angular_velocity)};
    const double speed = math::hypot(ball.velocity.x, ball.velocity.z);
    // What the contact's friction stops in this step rolls.
    const double slip = 3.5 * cloth.sliding_friction * g * step + rolling_slip * speed;
    if (speed > 0 && math::length(bed_slip(ball, r)) < slip) {
      const double rate = math::min(cloth.rolling_friction * g, speed / step) / speed;
      const Vec3d brake{-rate * ball.velocity.x, 0, -rate * ball.velocity.z}, turn = rolling_spin(brake, r);
      load.force = math::Vec3f(m * brake);
      load.torque.x = float(inertia * turn.x);
      load.torque.z = float(inertia * turn.z);
    }
    return load;
  };
  return effector;
}

double meet_cushions(BilliardState& s, const BilliardTable& table, const BilliardPhysics& physics) {
  const double r = physics.ball.radius, up = table.nose_height() - r;
  if (!in_play(s.phase) || s.position.y > (1 + near_bed) * r || !(up >= 0 && up < r)) return 0;
  const double sine = up / r, cosine = math::sqrt(1 - sine * sine), reach = cosine * r;
  const Vec2d place{s.position.x, s.position.z}, velocity{s.velocity.x, s.velocity.z};
  // The piece that was reached first: the one that it has been beyond for the longest time.
  double longest = 0;
  Vec2d outward{};
  const auto meet = [&](Vec2d out, double depth) {
    const double approach = dot(velocity, out);
    if (depth > 0 && approach > 0 && depth > longest * approach) {
      longest = depth / approach;
      outward = out;
    }
  };
  for (const BilliardTable::Edge& edge : table.edges()) {
    const Vec2d from = place - edge.from;
    const double along = dot(from, edge.along), depth = reach - dot(from, edge.inward);
    if (along >= 0 && along <= edge.length && depth < 2 * r) meet(-1.0 * edge.inward, depth);
  }
  for (const BilliardTable::Jaw& jaw : table.jaws()) {
    const Vec2d way = jaw.center - place;
    const double far = length(way);
    if (far > 0) meet(way / far, jaw.radius + reach - far);
  }
  if (!(longest > 0)) return 0;
  const Vec3d before = s.velocity;
  const double speed = strike_cushion(s, {cosine * outward.x, sine, cosine * outward.y}, true, physics);
  s.position += longest * Vec3d{s.velocity.x - before.x, 0, s.velocity.z - before.z};
  return speed;
}

}  // namespace carom::sports
