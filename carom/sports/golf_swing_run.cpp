#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"
#include "carom/sports/detail/sport_units.h"
#include "carom/sports/golf_swing.h"

namespace carom::sports {

SwingState SwingResult::at(double time) const {
  if (nodes.empty()) return {};
  if (time <= nodes.front().time) return nodes.front().state;
  if (time >= nodes.back().time) return nodes.back().state;
  std::size_t low = 0, high = nodes.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (nodes[middle].time <= time ? low : high) = middle;
  }
  const Node &a = nodes[low], &b = nodes[high];
  const double h = b.time - a.time;
  if (!(h > 0)) return b.state;
  const double x = (time - a.time) / h, r = 1 - x;
  return (r * r * (1 + 2 * x)) * a.state + (x * x * (1 + 2 * r)) * b.state + (x * r * r * h) * a.rate +
         (-x * x * r * h) * b.rate;
}

core::Result<SwingResult> swing(const Swing& def, double time_limit, double tolerance) {
  if (const core::Status good = check(def); !good) return good.error();
  if (!(time_limit > 0 && time_limit <= 1e4) || !(tolerance > 0 && tolerance < 0.1))
    return core::Error{"a swing needs a time limit in (0, 1e4] s and a tolerance in (0, 0.1)"};
  const std::size_t n = def.links.size();
  bool held[max_swing_links] = {};
  for (std::size_t i = 1; i < n; ++i) held[i] = def.links[i].hold.until != Hold::Until::free;
  SwingResult result;
  SwingState state = swing_start(def);
  double now = 0;
  const auto meets = [&](const SwingState& s) {
    if (def.impact == Swing::ImpactAt::club_vertical) return s.angle[n - 1];
    const Vec2d head = swing_point(def, s, n - 1);
    // Only below the hub, and not on the way back.
    if (head.y >= 0) return -1.0;
    return head.x - (def.impact == Swing::ImpactAt::ball ? def.ball : 0);
  };
  while (now < time_limit) {
    const auto rates = [&](double t, const SwingState& s) { return swing_motion(def, t, s, held).rate; };
    // The next moment at which a curve has a corner or a hold ends ends a stretch of smooth motion.
    double until = time_limit;
    const auto corner = [&](double t) {
      if (t > now + 1e-12) until = math::min(until, t);
    };
    for (std::size_t i = 0; i < n; ++i) {
      for (const Curve::Point& p : def.links[i].torque.points) corner(p.time);
      if (held[i] && def.links[i].hold.until == Hold::Until::time) corner(def.links[i].hold.time);
    }
    for (const Curve::Point& p : def.hub.points) corner(p.time);
    ode::DormandPrince<SwingState> solver(
        now, state, {.relative_tolerance = tolerance, .absolute_tolerance = tolerance, .maximum_step = 0.01});
    result.nodes.push_back({now, state, rates(now, state)});
    // Either the head meets the ball, or a stop would have to pull.
    int opens = -1;
    const auto stop = [&](double t, const SwingState& s) {
      double value = -meets(s);
      const SwingMotion motion = swing_motion(def, t, s, held);
      for (std::size_t i = 1; i < n; ++i)
        if (held[i] && def.links[i].hold.until == Hold::Until::opens) value = math::min(value, motion.hold_torque[i]);
      return value;
    };
    // A stop that would have to pull at once lets go at once.
    for (std::size_t i = 1; i < n; ++i)
      if (held[i] && def.links[i].hold.until == Hold::Until::opens &&
          swing_motion(def, now, state, held).hold_torque[i] <= 0)
        opens = int(i);
    bool found = false;
    if (opens < 0) {
      while (solver.t() < until && !found) {
        const double target = math::min(until, solver.t() + 0.01);
        const ode::Outcome outcome = solver.advance_to_event(
            rates, target, stop, found, {.crossing = ode::Crossing::falling, .time_tolerance = 1e-14});
        if (outcome != ode::Outcome::done)
          return core::Error{
              core::text("the swing cannot be integrated beyond ", solver.t(), " s: ", ode::to_string(outcome))};
        result.nodes.push_back({solver.t(), solver.y(), rates(solver.t(), solver.y())});
      }
      now = solver.t();
      state = solver.y();
      if (found && meets(state) >= -1e-9) {
        result.impact = true;
        break;
      }
      if (found) {
        const SwingMotion motion = swing_motion(def, now, state, held);
        double least = 1e300;
        for (std::size_t i = 1; i < n; ++i)
          if (held[i] && def.links[i].hold.until == Hold::Until::opens && motion.hold_torque[i] < least) {
            least = motion.hold_torque[i];
            opens = int(i);
          }
      }
    }
    if (opens > 0) {
      held[opens] = false;
      result.release[opens] = now;
    }
    for (std::size_t i = 1; i < n; ++i)
      if (held[i] && def.links[i].hold.until == Hold::Until::time && def.links[i].hold.time <= now + 1e-12) {
        held[i] = false;
        result.release[i] = now;
      }
  }
  result.time = now;
  result.velocity = head_velocity(def, now, state);
  result.speed = math::length(result.velocity);
  // The plane rises from the ball toward the player, who stands to its left: up the plane is up and to the left.
  const math::SinCos<double> plane = math::sincos(def.plane);
  const double up = result.velocity.y * plane.sin, right = -result.velocity.y * plane.cos;
  result.attack = math::atan2(up, math::hypot(result.velocity.x, right));
  result.path = math::atan2(right, result.velocity.x);
  result.bend = state.bend;
  result.added_loft = 1.5 * state.bend / def.links.back().length;  // φ′(L) = 3/(2L)
  return result;
}

core::Result<Swing> swing_for_speed(const Swing& def, double speed) {
  if (!(speed > 0 && speed < 1000)) return core::Error{core::refused("speed of a swing", speed, "m/s in (0, 1000)")};
  const auto scaled = [&](double factor) {
    Swing out = def;
    for (SwingLink& link : out.links)
      for (Curve::Point& p : link.torque.points) p.value *= factor;
    return out;
  };
  core::Error error{"no scale of the torques gives this speed"};
  const auto excess = [&](double factor) {
    const auto result = swing(scaled(factor), 4, 1e-8);
    if (!result) error = result.error();
    return result && result->impact ? result->speed - speed : -speed;
  };
  double low = 0.1, high = 10;
  if (excess(low) > 0 || excess(high) < 0)
    return core::Error{
        core::text("the swing does not reach ", speed, " m/s with a tenth to ten times its torques: ", error.message)};
  for (int i = 0; i < 40 && high - low > 1e-9; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0 ? low : high) = middle;
  }
  return scaled(0.5 * (low + high));
}

Swing textbook_swing() {
  Swing s;
  s.plane = math::pi / 2;
  s.impact = Swing::ImpactAt::club_vertical;
  s.links = {{.mass = 7,
              .length = 0.66,
              .centre = 0.33,
              .inertia = 7 * 0.66 * 0.66 / 12,
              .angle = -135 * detail::degree,
              .torque = Curve::constant(100)},
             {.mass = 0.34,
              .length = 1.10,
              .centre = 0.297 / 0.34,
              .inertia = 0.20 * 1.21 + 0.14 * 1.21 / 3 - 0.297 * 0.297 / 0.34,
              .angle = -225 * detail::degree,
              .hold = {.until = Hold::Until::opens}}};
  return s;
}

Swing three_link_swing() {
  Swing s;
  s.plane = 60 * detail::degree;
  s.impact = Swing::ImpactAt::head_below_hub;
  // The shoulders turn about the spine and carry the lead arm; designer values.
  s.links = {{.mass = 12,
              .length = 0.18,
              .centre = 0.05,
              .inertia = 0.25,
              .angle = -75 * detail::degree,
              .torque = {{{0, 40}, {0.12, 130}, {0.30, 130}}}},
             {.mass = 5.5,
              .length = 0.60,
              .centre = 0.28,
              .inertia = 0.17,
              .angle = -140 * detail::degree,
              .torque = {{{0, 10}, {0.10, 50}, {0.30, 50}}},
              .hold = {.until = Hold::Until::opens}},
             {.mass = 0.30,
              .length = 1.10,
              .centre = (0.20 + 0.05) * 1.10 / 0.30,
              .inertia = (0.20 + 0.10 / 3) * 1.21 - 0.25 * 0.25 * 1.21 / 0.30,
              .angle = -235 * detail::degree,
              .torque = {{{0, 0}, {0.24, 0}, {0.27, 10}}},
              .hold = {.until = Hold::Until::opens}}};
  s.shaft = {.frequency = 4.2, .head_mass = 0.20, .shaft_mass = 0.10};
  return s;
}

}  // namespace carom::sports
