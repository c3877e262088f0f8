#include "carom/sports/effector.h"

#include "carom/math/elementary.h"

namespace carom::sports {

rigid::CustomEffector<rigid::Dim3> flight_effector(const Ball& ball, const Conditions& conditions, rigid::BodyId body,
                                                   double step) {
  rigid::CustomEffector<rigid::Dim3> effector;
  effector.body = body;
  effector.model = [ball, conditions, step](const rigid::EffectorInput<rigid::Dim3>& input) {
    const double height = input.state.center_of_mass.y;
    BallMotion motion;
    motion.velocity = Vec3d(input.state.linear_velocity) - conditions.wind.at(height);
    motion.spin = Vec3d(input.state.angular_velocity);
    motion.time = input.time;
    if (ball.side.kind == SideForce::Kind::turning_seam) {
      const math::Quatf q = input.state.pose.rotation;
      const double turn = math::dot(Vec3d{q.x, q.y, q.z}, motion.spin);
      const double rate = math::length(motion.spin);
      if (rate > 0) motion.turned = 2 * math::atan2(turn / rate, double(q.w));
    }
    const Air air{conditions.air.at(height).density, conditions.viscosity};
    forces::Wrench3 load = air_load(ball, air, motion);
    if (step > 0) {
      motion.velocity += (0.5 * step) * (load.force / ball.mass - Vec3d{0, conditions.gravity, 0});
      motion.spin += (0.5 * step / inertia(ball)) * load.moment;
      motion.turned += 0.5 * step * math::length(motion.spin);
      motion.time += 0.5 * step;
      load = air_load(ball, air, motion);
    }
    return rigid::Wrench<rigid::Dim3>{math::Vec3f(load.force), math::Vec3f(load.moment)};
  };
  return effector;
}

}  // namespace carom::sports
