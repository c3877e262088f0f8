#include "carom/ballistics/flight.h"

#include "carom/ballistics/detail/flight_air.h"
#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"

namespace carom::ballistics {

using math::Vec3d;

Projectile projectile_from_coefficient(DragFunction function, double ballistic_coefficient,
                                       Interpolation interpolation) {
  constexpr double kg_per_m2 = 0.45359237 / (0.0254 * 0.0254);  // of 1 lb/in²
  return {DragCurve(function, interpolation), math::pi / 4 / (ballistic_coefficient * kg_per_m2)};
}

Projectile projectile_from_size(DragCurve drag, double mass, double diameter, double form_factor) {
  return {std::move(drag), form_factor * math::pi / 4 * diameter * diameter / mass};
}

Projectile projectile_from_terminal_speed(double terminal_speed, double density, double gravity) {
  return {DragCurve(1.0), 2 * gravity / (density * terminal_speed * terminal_speed)};
}

Vec3d earth_rotation_rate(double latitude, double bearing) {
  constexpr double rate = 7.292115e-5;  // rad/s
  const Vec3d north{math::cos(bearing), 0, -math::sin(bearing)};
  return rate * (math::cos(latitude) * north + math::sin(latitude) * Vec3d{0, 1, 0});
}

Vec3d acceleration(const Projectile& projectile, const Conditions& conditions, const State& state, double time) {
  return detail::flight_acceleration(projectile, conditions, state.position, state.velocity, time);
}

Trajectory::Point Trajectory::at(double time) const {
  const Node& last = nodes_.back();
  if (!(time > 0) || nodes_.size() < 2) return {{nodes_.front().position, nodes_.front().velocity}, 0};
  if (time >= last.time) return {{last.position, last.velocity}, last.time};
  std::size_t low = 0, high = nodes_.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (nodes_[middle].time <= time ? low : high) = middle;
  }
  // Hermite's polynomial through position, velocity and acceleration of both nodes, s = 0 … 1.
  const Node &a = nodes_[low], &b = nodes_[high];
  const double h = b.time - a.time, s = (time - a.time) / h;
  const Vec3d v0 = h * a.velocity, v1 = h * b.velocity, a0 = (h * h) * a.acceleration, a1 = (h * h) * b.acceleration;
  const Vec3d d = b.position - a.position;
  const Vec3d c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
  const Vec3d c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
  const Vec3d c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * a0 + 0.5 * a1;
  const Vec3d position = a.position + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))));
  const Vec3d velocity = (1 / h) * (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + (5 * s) * c5))));
  return {{position, velocity}, time};
}

std::optional<Trajectory::Point> Trajectory::first(core::FunctionRef<double(const Point&)> value) const {
  constexpr int samples = 4;  // of each step
  Point before = start();
  double value_before = value(before);
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    for (int k = 1; k <= samples; ++k) {
      const double from = nodes_[i - 1].time, to = nodes_[i].time;
      Point after = at(k == samples ? to : from + (to - from) * k / samples);
      double value_after = value(after);
      if (value_before < 0 ? value_after >= 0 : value_before > 0 && value_after <= 0) {
        const bool rising = value_before < 0;
        for (int n = 0; n < 100; ++n) {
          const double span = after.time - before.time;
          const double guess = before.time + span * (value_before / (value_before - value_after));
          // Regula falsi, with a bisection every third time against slow ends.
          const double time =
              n % 3 == 2 || !(guess > before.time && guess < after.time) ? before.time + 0.5 * span : guess;
          if (time == before.time || time == after.time) break;
          const Point middle = at(time);
          const double v = value(middle);
          if (rising ? v >= 0 : v <= 0) {
            after = middle;
            value_after = v;
          } else {
            before = middle;
            value_before = v;
          }
        }
        return after;
      }
      before = after;
      value_before = value_after;
    }
  }
  return std::nullopt;
}

std::optional<Trajectory::Point> Trajectory::at_distance(double distance) const {
  const Vec3d origin = start().position;
  return first(
      [&](const Point& p) { return math::hypot(p.position.x - origin.x, p.position.z - origin.z) - distance; });
}

std::optional<Trajectory::Point> Trajectory::falling_through(double height) const {
  const double top = apex().time;
  if (at(top).position.y < height) return std::nullopt;
  return first([&](const Point& p) { return p.time <= top ? 1.0 : p.position.y - height; });
}

Trajectory::Point Trajectory::apex() const {
  const std::optional<Point> turn = first([](const Point& p) { return p.velocity.y; });
  const bool climbs = start().velocity.y > 0;
  if (climbs && turn) return *turn;
  return climbs ? end() : start();
}

core::Result<Trajectory> fly(const Projectile& projectile, const Conditions& conditions, const FlightPoint& start,
                             const FlightLimits& limits) {
  const auto finite = [](Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); };
  if (!finite(start.position) || !finite(start.velocity))
    return core::Error{"the start of a flight has a position or velocity that is not finite"};
  if (!math::is_finite(projectile.area_per_mass) || projectile.area_per_mass < 0)
    return core::Error{core::refused("area_per_mass", projectile.area_per_mass, "a finite number >= 0")};
  if (!(limits.time > 0) || !math::is_finite(limits.time))
    return core::Error{core::refused("time limit of a flight", limits.time, "a finite number of seconds > 0")};
  if (!(limits.tolerance > 0) || limits.tolerance > 0.1)
    return core::Error{core::refused("tolerance of a flight", limits.tolerance, "a number in (0, 0.1]")};
  const auto derivative = [&](double t, const State& s) {
    return State{s.velocity, acceleration(projectile, conditions, s, t)};
  };
  const double longest = math::max(1e-3, 0.02 * limits.time);
  ode::DormandPrince<State> solver(
      0, {start.position, start.velocity},
      {.relative_tolerance = limits.tolerance,
       .absolute_tolerance = limits.tolerance,
       .maximum_step = conditions.field ? math::min(longest, detail::longest_field_step) : longest});
  std::vector<Trajectory::Node> nodes;
  const auto add = [&] {
    const State& s = solver.y();
    nodes.push_back({solver.t(), s.position, s.velocity, acceleration(projectile, conditions, s, solver.t())});
  };
  add();
  const auto remaining = [&](const State& s) {
    const double flown = math::hypot(s.position.x - start.position.x, s.position.z - start.position.z);
    const double height = s.velocity.y < 0 ? s.position.y - limits.ground : 1e300;
    return math::min(height, limits.distance - flown);
  };
  while (solver.t() < limits.time) {
    const ode::Outcome outcome = solver.step(derivative, limits.time);
    if (outcome != ode::Outcome::done)
      return core::Error{
          core::text("the flight cannot be integrated beyond ", solver.t(), " s: ", ode::to_string(outcome))};
    add();
    if (remaining(solver.y()) > 0) continue;
    // The last step went beyond a limit: end there.
    const Trajectory whole(nodes);
    const std::optional<Trajectory::Point> end =
        whole.first([&](const Trajectory::Point& p) { return remaining({p.position, p.velocity}); });
    if (end) {
      while (nodes.size() > 1 && nodes.back().time > end->time) nodes.pop_back();
      const State s{end->position, end->velocity};
      if (end->time > nodes.back().time)
        nodes.push_back({end->time, s.position, s.velocity, acceleration(projectile, conditions, s, end->time)});
    }
    break;
  }
  return Trajectory(std::move(nodes));
}

Vec3d direction(double elevation, double azimuth) {
  const math::SinCos<double> e = math::sincos(elevation), a = math::sincos(azimuth);
  return {e.cos * a.cos, e.sin, e.cos * a.sin};
}

}  // namespace carom::ballistics
