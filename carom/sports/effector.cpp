#include "carom/sports/effector.h"

#include "carom/environment/environment.h"
#include "carom/math/elementary.h"

namespace carom::sports {

rigid::CustomEffector<rigid::Dim3> flight_effector(const Ball& ball, const Conditions& conditions, rigid::BodyId body,
                                                   double step, bool own_air, bool own_wind, Vec3d held_spin) {
  rigid::CustomEffector<rigid::Dim3> effector;
  effector.body = body;
  Ball scrambled = ball;
  scrambled.side = {};
  effector.model = [whole = ball, scrambled, conditions, step, own_air, own_wind,
                    held_spin](const rigid::EffectorInput<rigid::Dim3>& input) {
    const environment::Environment* const around = input.around;
    const Vec3d place = input.state.center_of_mass, velocity(input.state.linear_velocity);
    BallMotion motion;
    motion.spin = Vec3d(input.state.angular_velocity);
    const double held = math::dot(motion.spin, held_spin);
    const Ball& ball = held < 0.5 * math::length(motion.spin) * math::length(held_spin) ? scrambled : whole;
    if (ball.side.kind == SideForce::Kind::turning_seam) {
      const math::Quatf q = input.state.pose.rotation;
      const double turn = math::dot(Vec3d{q.x, q.y, q.z}, motion.spin);
      const double rate = math::length(motion.spin);
      if (rate > 0) motion.turned = 2 * math::atan2(turn / rate, double(q.w));
    }
    // With what has changed of the velocity, `after` s from the beginning of the step.
    const auto load_after = [&](double after, Vec3d change) {
      const Vec3d there = place + after * velocity;
      motion.time = input.time + after;
      Vec3d wind =
          around != nullptr && !own_wind ? around->wind(there, motion.time) : wind_at(conditions, there, motion.time);
      if (!own_wind) wind += input.wind;
      motion.velocity = velocity + change - wind;
      if (around == nullptr || own_air)
        return air_load(ball, {conditions.air.at(there.y).density, conditions.viscosity}, motion);
      const environment::AirState air = around->air(there);
      return air_load(ball, {air.density, air.viscosity}, motion);
    };
    forces::Wrench3 load = load_after(0, {});
    if (step > 0) {
      motion.spin += (0.5 * step / inertia(ball)) * load.moment;
      motion.turned += 0.5 * step * math::length(motion.spin);
      load = load_after(0.5 * step, (0.5 * step) * (load.force / ball.mass - Vec3d{0, conditions.gravity, 0}));
    }
    return rigid::Wrench<rigid::Dim3>{math::Vec3f(load.force), math::Vec3f(load.moment)};
  };
  return effector;
}

}  // namespace carom::sports
