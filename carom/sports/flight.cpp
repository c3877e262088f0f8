#include "carom/sports/flight.h"

#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"

namespace carom::sports {

BallState derivative(const Ball& ball, const Conditions& conditions, double time, const BallState& state) {
  const double height = state.position.y;
  const Air air{conditions.air.at(height).density, conditions.viscosity};
  const forces::Wrench3 load =
      air_load(ball, air, {state.velocity - wind_at(conditions, state.position, time), state.spin, state.turned, time});
  return {state.velocity, load.force / ball.mass - Vec3d{0, conditions.gravity, 0}, load.moment / inertia(ball),
          math::length(state.spin)};
}

BallState launch_state(const Launch& launch, Vec3d position) {
  const math::SinCos<double> e = math::sincos(launch.elevation), a = math::sincos(launch.azimuth),
                             t = math::sincos(launch.tilt);
  const Vec3d along{e.cos * a.cos, e.sin, e.cos * a.sin}, right{-a.sin, 0, a.cos};
  // Backspin lifts along `right` × `along`; the tilt turns that lift to the right.
  const Vec3d up = math::cross(right, along);
  return {position, launch.speed * along, launch.spin * (t.cos * right - t.sin * up) + launch.gyro * along, 0};
}

Launch launch_of(const BallState& state) {
  Launch launch;
  launch.speed = math::length(state.velocity);
  if (!(launch.speed > 0)) return launch;
  const Vec3d along = state.velocity / launch.speed;
  const double level = math::hypot(along.x, along.z);
  launch.elevation = math::atan2(along.y, level);
  launch.azimuth = level > 0 ? math::atan2(along.z, along.x) : 0;
  const math::SinCos<double> a = math::sincos(launch.azimuth);
  const Vec3d right{-a.sin, 0, a.cos}, up = math::cross(right, along);
  const double back = math::dot(state.spin, right), side = -math::dot(state.spin, up);
  launch.gyro = math::dot(state.spin, along);
  launch.spin = math::hypot(back, side);
  launch.tilt = launch.spin > 0 ? math::atan2(side, back) : 0;
  return launch;
}

BallFlight::Point BallFlight::at(double time) const {
  if (nodes_.empty()) return {};
  const Node& last = nodes_.back();
  if (!(time > nodes_.front().time)) return {nodes_.front().state, nodes_.front().time};
  if (time >= last.time) return {last.state, last.time};
  std::size_t low = 0, high = nodes_.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (nodes_[middle].time <= time ? low : high) = middle;
  }
  return between(nodes_[low], nodes_[high], time);
}

BallFlight::Point BallFlight::between(const Node& a, const Node& b, double time) {
  const double h = b.time - a.time, s = (time - a.time) / h;
  // Position: Hermite's fifth-order polynomial through positions, velocities and accelerations, and its derivative.
  const Vec3d v0 = h * a.state.velocity, v1 = h * b.state.velocity;
  const Vec3d a0 = (h * h) * a.rate.velocity, a1 = (h * h) * b.rate.velocity;
  const Vec3d d = b.state.position - a.state.position;
  const Vec3d c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
  const Vec3d c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
  const Vec3d c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * a0 + 0.5 * a1;
  Point p;
  p.time = time;
  p.position = a.state.position + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))));
  p.velocity = (1 / h) * (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + (5 * s) * c5))));
  // Spin and its angle: cubic.
  const double r = 1 - s, f0 = r * r * (1 + 2 * s), f1 = s * s * (1 + 2 * r), g0 = s * r * r * h, g1 = -s * s * r * h;
  p.spin = f0 * a.state.spin + f1 * b.state.spin + g0 * a.rate.spin + g1 * b.rate.spin;
  p.turned = f0 * a.state.turned + f1 * b.state.turned + g0 * a.rate.turned + g1 * b.rate.turned;
  return p;
}

std::optional<BallFlight::Point> BallFlight::first(core::FunctionRef<double(const Point&)> value) const {
  constexpr int samples = 4;  // of each step
  Point before = start();
  double value_before = value(before);
  for (std::size_t i = 1; i < nodes_.size(); ++i)
    for (int k = 1; k <= samples; ++k) {
      const double from = nodes_[i - 1].time, to = nodes_[i].time;
      Point after = at(k == samples ? to : from + (to - from) * k / samples);
      const double value_after = value(after);
      if (value_before < 0 ? value_after >= 0 : value_before > 0 && value_after <= 0) {
        const bool rising = value_before < 0;
        for (int n = 0; n < 60 && after.time - before.time > 1e-14; ++n) {
          const Point middle = at(0.5 * (before.time + after.time));
          const double v = value(middle);
          ((rising ? v >= 0 : v <= 0) ? after : before) = middle;
        }
        return after;
      }
      before = after;
      value_before = value_after;
    }
  return std::nullopt;
}

std::optional<BallFlight::Point> BallFlight::at_x(double x) const {
  return first([&](const Point& p) { return p.position.x - x; });
}

BallFlight::Point BallFlight::apex() const {
  if (nodes_.empty()) return {};
  Point top = start(), last = end();
  if (last.position.y > top.position.y) top = last;
  if (const auto turn = first([](const Point& p) { return p.velocity.y; }); turn && turn->position.y > top.position.y)
    top = *turn;
  return top;
}

core::Result<BallFlight> fly_until(const Ball& ball, const Conditions& conditions, const BallState& start,
                                   core::FunctionRef<double(double, const BallState&)> stop,
                                   const FlightLimits& limits) {
  if (const core::Status good = check(ball); !good) return good.error();
  const auto finite = [](Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); };
  if (!finite(start.position)) return core::Error{"the position at the start of a flight is not finite"};
  if (!finite(start.velocity)) return core::Error{"the velocity at the start of a flight is not finite"};
  if (!finite(start.spin) || !math::is_finite(start.turned))
    return core::Error{"the spin at the start of a flight is not finite"};
  if (!(limits.time > 0 && limits.time <= 1e6))
    return core::Error{core::refused("time limit of a flight", limits.time, "seconds in (0, 1e6]")};
  if (!(limits.tolerance > 0 && limits.tolerance <= 0.1))
    return core::Error{core::refused("tolerance of a flight", limits.tolerance, "a number in (0, 0.1]")};
  if (!math::is_finite(conditions.gravity) || !(conditions.viscosity > 0) || !math::is_finite(conditions.viscosity))
    return core::Error{"gravity and viscosity of a flight must be finite, and viscosity above 0"};

  const auto rates = [&](double t, const BallState& s) { return derivative(ball, conditions, t, s); };
  const double longest = math::max(1e-3, 0.02 * limits.time);
  // The angle turned may be large and matters least; it is an integral of the rest and follows from its accuracy.
  ode::DormandPrince<BallState> solver(0, start,
                                       {.relative_tolerance = limits.tolerance,
                                        .absolute_tolerance = limits.tolerance,
                                        .maximum_step = conditions.field ? math::min(longest, 0.05) : longest});
  std::vector<BallFlight::Node> nodes;
  nodes.reserve(64);
  const auto add = [&] { nodes.push_back({solver.t(), solver.y(), rates(solver.t(), solver.y())}); };
  add();
  while (solver.t() < limits.time) {
    bool stopped = false;
    const double before = solver.t();
    const ode::Outcome outcome = solver.step(rates, limits.time);
    if (outcome != ode::Outcome::done)
      return core::Error{
          core::text("the flight cannot be integrated beyond ", before, " s: ", ode::to_string(outcome))};
    add();
    // Where within the step it stops, if it does.
    constexpr int samples = 4;
    const BallFlight::Node first = nodes[nodes.size() - 2], last = nodes.back();
    const auto at = [&](double t) { return BallFlight::between(first, last, t); };
    double left = before, value = stop(before, first.state);
    for (int i = 1; i <= samples && !stopped; ++i) {
      double right = i == samples ? last.time : before + (last.time - before) * i / samples;
      const double after = stop(right, i == samples ? last.state : at(right));
      if (value > 0 && after <= 0) {
        for (int n = 0; n < 60 && right - left > 1e-13; ++n) {
          const double middle = 0.5 * (left + right);
          (stop(middle, at(middle)) <= 0 ? right : left) = middle;
        }
        const BallState end = right == last.time ? last.state : BallState(at(right));
        nodes.back() = {right, end, rates(right, end)};
        stopped = true;
      }
      left = right;
      value = after;
    }
    if (stopped) break;
  }
  return BallFlight(std::move(nodes));
}

core::Result<BallFlight> fly(const Ball& ball, const Conditions& conditions, const BallState& start, double ground,
                             const FlightLimits& limits) {
  if (start.position.y <= ground && !(start.velocity.y > 0))
    return core::Error{
        core::text("a flight starts at the height ", start.position.y, " and goes down, expected above ", ground)};
  return fly_until(
      ball, conditions, start,
      [&](double, const BallState& s) { return s.velocity.y < 0 ? s.position.y - ground : 1.0; }, limits);
}

Landing landing(const BallFlight& flight) {
  const BallFlight::Point start = flight.start(), end = flight.end();
  const Vec3d v = end.velocity;
  return {.carry = end.position.x - start.position.x,
          .side = end.position.z - start.position.z,
          .apex = flight.apex().position.y - start.position.y,
          .time = end.time,
          .angle = math::atan2(-v.y, math::hypot(v.x, v.z)),
          .speed = math::length(v),
          .spin = math::length(end.spin)};
}

}  // namespace carom::sports
