// From definitions to the law of a coordinate: its spring, motor and limits in a substep.
#pragma once

#include "carom/rigid/detail/joint_axis.h"
#include "carom/rigid/detail/joint_store.h"

namespace carom::rigid::detail {

/// The substep, and how fast the time of what is joined goes (BodyDef::time_scale).
struct Clock {
  float h = 0;                                      ///< s
  float pace = 1;                                   ///< s of its own in a second
  bool in_tree = false;                             ///< tell_spring says how springs respond
  float push() const { return h * (pace * pace); }  ///< impulse in the world's time of a force of 1 N
};
/// Of the two bodies' clocks the geometric mean; the ground has none.
template <class D>
Clock clock_of(const BodyStore<D>& bodies, const JointHeader& header, float h) {
  if (bodies.time_scale.empty()) return {h};
  const auto pace = [&](std::int32_t body) { return body != none && bodies.is_dynamic(body) ? bodies.pace(body) : 0; };
  const float a = pace(header.body[0]), b = pace(header.body[1]);
  if (a == b) return {h, a > 0 ? a : 1};
  return {h, a > 0 && b > 0 ? math::sqrt(a * b) : a + b};
}

inline void fill_limit(AxisLaw& law, const JointLimit& limit) {
  if (!limit.enabled) return;
  law.flags |= AxisLaw::lower | AxisLaw::upper;
  law.low = limit.lower;
  law.high = limit.upper;
}
inline void fill_motor(AxisLaw& law, const JointMotor& motor, const Clock& t) {
  if (!motor.enabled) return;
  law.flags |= AxisLaw::motor;
  law.speed = t.pace * motor.speed;
  law.max_motor_impulse = motor.max_force * t.push();
}

/// √(mass that moves with a coordinate once the rest of the joint holds / mass of its row alone). A user's frequency is
/// that of the whole joint: a rod on a hinge swings about the hinge, not about its own centre.
inline float mass_ratio_root(float row_mobility, float held_mobility) {
  if (!(row_mobility > 0)) return 1;
  return math::sqrt(row_mobility / max(held_mobility, 0.01f * row_mobility));
}
/// `stiffer`: mass_ratio_root.
inline Response stiffened_response(const JointSpring& spring, const Clock& t, float stiffer) {
  if (t.in_tree) return {t.pace * stiffer * spring.hertz, stiffer * spring.damping_ratio};
  return spring_response(t.pace * stiffer * spring.hertz, stiffer * spring.damping_ratio, t.h);
}
inline void fill_spring(AxisLaw& law, const JointSpring& spring, float rest, const Clock& t, float stiffer = 1) {
  if (!(spring.hertz > 0)) return;
  law.flags |= AxisLaw::spring;
  law.rest = rest;
  law.response = stiffened_response(spring, t, stiffer);
}

/// The spring of a joint in a tree, once it is known what moves on it: its stiffness is that for the two bodies by
/// themselves (1/`own`), and the motion that of 1/`mobility`.
inline void tell_spring(Response& response, float mobility, float own, float h) {
  const float slower = own > 0 ? math::sqrt(max(mobility, 0.0f) / own) : 1;
  response = spring_response(slower * response.velocity, slower * response.position, h);
}

template <class Axis>
void remember(AxisLaw& law, const Axis& memory) {
  law.spring_impulse = law.has(AxisLaw::spring) ? memory.spring : 0;
  law.motor_impulse = law.has(AxisLaw::motor) ? memory.motor : 0;
  law.lower_impulse = law.has(AxisLaw::lower) ? memory.lower : 0;
  law.upper_impulse = law.has(AxisLaw::upper) ? memory.upper : 0;
}

/// Which of JointMemory::turn is that of the twist.
template <class D>
inline constexpr int last_turn = D::dimension == 2 ? 0 : 1;

/// Null: none.
template <class D>
const JointSpring* spring_of_twist(const JointData<D>& data) {
  const auto* hinge = data.template get<HingeJointDef>();
  return hinge != nullptr && hinge->spring.hertz > 0 ? &hinge->spring : nullptr;
}
/// The turn of a hinge or a ball's twist, but for how its spring responds: that goes by the bodies.
template <class D>
void fill_twist(AxisLaw& law, const JointData<D>& data, const Clock& t) {
  law.flags = AxisLaw::periodic;
  if (const auto* hinge = data.template get<HingeJointDef>()) {
    if (spring_of_twist(data) != nullptr) {
      law.flags |= AxisLaw::spring;
      law.rest = hinge->target_angle;
    }
    law.max_spring_impulse = hinge->max_spring_torque * t.push();
    fill_motor(law, hinge->motor, t);
    fill_limit(law, hinge->limit);
  } else if (const auto* ball = data.template get<BallJointDef>()) {
    fill_limit(law, ball->twist);
  }
  remember(law, data.memory.turn[last_turn<D>]);
}

}  // namespace carom::rigid::detail
