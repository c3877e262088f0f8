// Friction between two balls.
#pragma once

#include "carom/sports/billiards.h"

namespace carom::sports::detail {

/// The impulse of friction that goes with a normal impulse `push` (per mass), against the slip of a over b before the
/// impact: Coulomb, and no more than stops the slip, which is u/7 for equal solid spheres.
inline void rub_balls(BilliardState& a, BilliardState& b, math::Vec3d normal, double push, math::Vec3d slip,
                      const BilliardPhysics& p) {
  const double speed = math::length(slip);
  if (!(speed > 1e-14)) return;
  const math::Vec3d f = (-math::min(ball_friction(p.balls, speed) * push, speed / 7) / speed) * slip;
  a.velocity += f;
  b.velocity -= f;
  const math::Vec3d turn = (2.5 / p.ball.radius) * cross(normal, f);
  a.angular_velocity += turn;
  b.angular_velocity += turn;
}

}  // namespace carom::sports::detail
