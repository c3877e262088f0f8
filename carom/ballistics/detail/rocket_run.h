// The equations of a rocket's flight, for flights alone (rocket.cpp) and for bodies of a world (body_rocket.cpp).
#pragma once

#include "carom/ballistics/detail/flight_air.h"
#include "carom/ballistics/rocket.h"
#include "carom/ode/state.h"

namespace carom::ballistics::detail {

using math::Vec3d;

struct RocketState {
  Vec3d position{}, velocity{}, axis{}, turning{};  // turning: ė
  friend RocketState operator+(const RocketState& a, const RocketState& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.axis + b.axis, a.turning + b.turning};
  }
  friend RocketState operator*(double s, const RocketState& a) {
    return {s * a.position, s * a.velocity, s * a.axis, s * a.turning};
  }
};

}  // namespace carom::ballistics::detail

template <>
inline constexpr int carom::ode::components<carom::ballistics::detail::RocketState> = 12;

namespace carom::ballistics::detail {

/// What a rocket and its rail must be.
core::Result<void> check(const Rocket& rocket, const Launch& launch);

/// When each stage does what.
struct Schedule {
  struct Entry {
    double ignition, burnout, separation;
  };
  std::vector<Entry> stages;
  explicit Schedule(const Rocket& rocket) {
    double ready = 0;
    for (const Stage& stage : rocket.stages) {
      Entry entry{};
      entry.ignition = ready + stage.ignition_delay;
      entry.burnout = entry.ignition + stage.motor.curve.burn_time();
      entry.separation = entry.burnout + stage.separation_delay;
      // The next one lights after this one's burnout, and not before this one is gone.
      ready = entry.separation;
      stages.push_back(entry);
    }
    if (!stages.empty()) stages.back().separation = 1e300;
  }
};

struct MassNow {
  double mass = 0, centre = 0, inertia = 0, thrust = 0;
};
inline MassNow mass_at(const Rocket& rocket, const Schedule& schedule, double time) {
  MassNow now;
  double moment = 0;
  for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
    if (time >= schedule.stages[i].separation) continue;
    const Stage& stage = rocket.stages[i];
    const double burning = time - schedule.stages[i].ignition, motor = stage.motor.mass_at(burning);
    now.mass += stage.dry_mass + motor;
    moment += stage.dry_mass * stage.dry_centre + motor * stage.motor_centre;
    if (burning >= 0) now.thrust += stage.motor.curve.thrust(burning);
  }
  now.centre = moment / now.mass;
  now.inertia = now.mass * rocket.length * rocket.length / 12;  // a slender rod about its middle
  for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
    if (time >= schedule.stages[i].separation) continue;
    const Stage& stage = rocket.stages[i];
    const double motor = stage.motor.mass_at(time - schedule.stages[i].ignition);
    now.inertia += motor * math::square(stage.motor_centre - now.centre);
  }
  return now;
}

/// What moves a rocket; what it refers to must outlive it.
struct RocketRun {
  RocketRun(const Rocket& r, const Conditions& c, const Launch& l, RocketModel m)
      : rocket(r), conditions(c), model(m), schedule(r), stability(barrowman(r)), rail(math::normalize(l.direction)) {}

  RocketState derivative(double time, const RocketState& s, bool on_rail, bool under_parachute) const {
    const MassNow now = mass_at(rocket, schedule, time);
    const Vec3d g = beside_drag(conditions, s.position, s.velocity);
    const environment::AirColumn::Air air = conditions.air.at(s.position.y);
    const Vec3d w = s.velocity - wind_of(conditions, s.position, time);
    const double speed = math::length(w), area = math::pi / 4 * rocket.diameter * rocket.diameter;
    const double q = 0.5 * air.density * speed * speed;
    if (under_parachute) {
      const Vec3d drag = (-0.5 * air.density * rocket.parachute.drag_area * speed / now.mass) * w;
      return {s.velocity, g + drag, {}, {}};
    }
    const DragCurve& curve = now.thrust > 0 ? rocket.drag : rocket.coasting_drag;
    const double cd = curve(speed / air.speed_of_sound);
    Vec3d e = s.axis / math::length(s.axis);
    if (on_rail)
      e = rail;
    else if (model == RocketModel::point_mass)
      e = speed > 1e-6 ? w / speed : rail;
    Vec3d force = now.thrust * e - (q * area * cd) * (speed > 0 ? w / speed : Vec3d{});
    RocketState out{s.velocity, {}, {}, {}};
    if (!on_rail && model == RocketModel::six_degrees) {
      // The air meets the centre of pressure with the turning of the axis: that damps.
      const double arm = stability.centre_of_pressure - now.centre;  // > 0: behind the centre of mass
      const Vec3d at_fins = w - arm * s.turning;
      const double fast = math::length(at_fins);
      const Vec3d across = at_fins - math::dot(at_fins, e) * e;
      const Vec3d normal = (-0.5 * air.density * fast * area * stability.normal_slope) * across;
      force += normal;
      // The force acts `arm` behind the centre of mass, along −e.
      Vec3d swing = (-arm / now.inertia) * (normal - math::dot(normal, e) * e);
      // The jet takes along the sideways motion of what it leaves.
      const double flow = mass_flow(time);
      const double tail = rocket.length - now.centre;
      swing -= (flow * tail * tail / now.inertia) * s.turning;
      out.axis = s.turning;
      out.turning = swing - math::length_squared(s.turning) * e;
    }
    out.velocity = g + force / now.mass;
    if (on_rail) {
      // It stands on the pad while the thrust is too weak; what rounding leaves of a velocity back holds nothing.
      const double along = math::dot(out.velocity, rail);
      out.velocity = (math::dot(s.velocity, rail) <= 0 ? math::max(along, 0.0) : along) * rail;
    }
    return out;
  }

  double mass_flow(double time) const {
    double flow = 0;
    for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
      const Motor& motor = rocket.stages[i].motor;
      const double burning = time - schedule.stages[i].ignition;
      if (burning >= 0 && motor.exhaust_speed() > 0) flow += motor.curve.thrust(burning) / motor.exhaust_speed();
    }
    return flow;
  }
  double mass(double time) const { return mass_at(rocket, schedule, time).mass; }
  double angle_of_attack(double time, const RocketState& s) const {
    const Vec3d w = s.velocity - wind_of(conditions, s.position, time);
    return math::atan2(math::length(math::cross(s.axis, w)), math::dot(s.axis, w));
  }

  const Rocket& rocket;
  const Conditions& conditions;
  RocketModel model;
  Schedule schedule;
  Stability stability;
  Vec3d rail;  ///< unit
};

}  // namespace carom::ballistics::detail
