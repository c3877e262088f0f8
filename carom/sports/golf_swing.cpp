#include "carom/sports/golf_swing.h"

#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"
#include "carom/sports/detail/sport_units.h"

namespace carom::sports {
namespace {

constexpr std::size_t most = max_swing_links + 1;  // and the bend

/// The integrals of the mode over the last link: ∫φ dm, ∫s φ dm, ∫φ² dm, and its spring and damper.
struct Mode {
  double first = 0, moment = 0, square = 0, spring = 0, damper = 0;
};
Mode mode_of(const Swing& swing) {
  const FlexibleShaft& shaft = swing.shaft;
  if (!(shaft.frequency > 0)) return {};
  const double length = swing.links.back().length, rate = 2 * math::pi * shaft.frequency;
  // Of a uniform beam: ∫φ = 3/8, ∫xφ = 11/40, ∫φ² = 33/140 over x = s/L.
  Mode m;
  m.first = shaft.head_mass + 3.0 / 8 * shaft.shaft_mass;
  m.moment = length * (shaft.head_mass + 11.0 / 40 * shaft.shaft_mass);
  m.square = shaft.head_mass + 33.0 / 140 * shaft.shaft_mass;
  m.spring = m.square * rate * rate;
  m.damper = 2 * shaft.damping_ratio * m.square * rate;
  return m;
}

/// Mass that hangs from the end of link i.
double hanging(const Swing& swing, std::size_t i) {
  double mass = 0;
  for (std::size_t k = i + 1; k < swing.links.size(); ++k) mass += swing.links[k].mass;
  return mass;
}

struct System {
  std::size_t n = 0;
  double m[most][most] = {}, force[most] = {};
};

/// M q̈ = force of all links as if none were held.
System assemble(const Swing& swing, double time, const SwingState& s) {
  System out;
  const std::size_t n = swing.links.size();
  const Mode mode = mode_of(swing);
  const bool bends = mode.spring > 0;
  out.n = n + (bends ? 1 : 0);
  const double g = swing.gravity * math::sin(swing.plane), a = swing.hub.at(time);
  math::SinCos<double> t[max_swing_links];
  double statics[max_swing_links] = {};  // S_i: first moment of all that link i carries
  for (std::size_t i = 0; i < n; ++i) {
    const SwingLink& link = swing.links[i];
    const double behind = hanging(swing, i);
    t[i] = math::sincos(s.angle[i]);
    statics[i] = link.mass * link.centre + link.length * behind;
    out.m[i][i] = link.inertia + link.mass * link.centre * link.centre + link.length * link.length * behind;
    out.force[i] = link.torque.at(time) - (i + 1 < n ? swing.links[i + 1].torque.at(time) : 0) -
                   statics[i] * (g * t[i].sin + a * t[i].cos);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double k = swing.links[i].length * statics[j];
      const double cosine = t[i].cos * t[j].cos + t[i].sin * t[j].sin,
                   sine = t[i].sin * t[j].cos - t[i].cos * t[j].sin;  // of θ_i − θ_j
      out.m[i][j] = out.m[j][i] = k * cosine;
      out.force[i] -= k * sine * s.rate[j] * s.rate[j];
      out.force[j] += k * sine * s.rate[i] * s.rate[i];
    }
  if (!bends) return out;
  // The bent club: its elements lie at s e_r + q φ e_t from its joint, e_r(ψ) = (sin ψ, −cos ψ), e_t = (cos ψ, sin ψ).
  const std::size_t c = n - 1, b = n;
  const double q = s.bend, w = s.rate[c], dq = s.bend_rate;
  out.m[c][c] += q * q * mode.square;
  out.force[c] -= 2 * mode.square * q * dq * w;
  out.m[c][b] = out.m[b][c] = mode.moment;
  out.m[b][b] = mode.square;
  out.force[b] = q * mode.square * w * w - mode.spring * q - mode.damper * dq;
  // Pull of gravity and of the hub on what is bent: along e_t for q, and −q A₁ e_r for ψ. (gx, gy) is what a body in
  // the hub's frame feels.
  const double gx = -a, gy = -g;
  out.force[b] += mode.first * (gx * t[c].cos + gy * t[c].sin);
  out.force[c] += -q * mode.first * (gx * t[c].sin - gy * t[c].cos);
  for (std::size_t i = 0; i < c; ++i) {
    const double l = swing.links[i].length;
    const double cosine = t[i].cos * t[c].cos + t[i].sin * t[c].sin, sine = t[i].sin * t[c].cos - t[i].cos * t[c].sin;
    // e_ti·e_tc = cos, e_ti·e_rc = −sin(θ_i − θ_c)… with e_ri·e_tc = sin, e_ri·e_rc = cos.
    out.m[i][b] = out.m[b][i] = out.m[i][b] + l * mode.first * cosine;
    out.m[i][c] += l * q * mode.first * sine;
    out.m[c][i] = out.m[i][c];
    const double wi = s.rate[i];
    out.force[b] += l * mode.first * wi * wi * sine;
    out.force[c] -= l * q * mode.first * wi * wi * cosine;
    out.force[i] += l * mode.first * (q * w * w * cosine - 2 * dq * w * sine);
  }
  return out;
}

/// Gauss's elimination; the matrices are symmetric and positive, so that no pivot is needed.
void solve(std::size_t n, double (&m)[most][most], double (&x)[most]) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double f = m[j][i] / m[i][i];
      for (std::size_t k = i; k < n; ++k) m[j][k] -= f * m[i][k];
      x[j] -= f * x[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= m[i][k] * x[k];
    x[i] /= m[i][i];
  }
}

}  // namespace

double Curve::at(double time) const {
  if (points.empty()) return 0;
  if (time <= points.front().time) return points.front().value;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (time < points[i].time) {
      const Point &a = points[i - 1], &b = points[i];
      return a.value + (b.value - a.value) * ((time - a.time) / (b.time - a.time));
    }
  return points.back().value;
}

double Curve::integral(double time) const {
  double sum = 0, from = 0;
  for (const Point& p : points) {
    if (p.time <= from) continue;
    const double to = math::min(p.time, time);
    if (to <= from) break;
    sum += 0.5 * (to - from) * (at(from) + at(to));
    from = to;
  }
  return time > from ? sum + (time - from) * at(time) : sum;
}

SwingMotion swing_motion(const Swing& swing, double time, const SwingState& s, const bool (&held)[max_swing_links]) {
  const std::size_t n = swing.links.size();
  const System system = assemble(swing, time, s);
  // A held link turns with the one before it: its row and column are added to that one's.
  std::size_t group[most] = {}, groups = 0;
  for (std::size_t i = 0; i < system.n; ++i) group[i] = i > 0 && i < n && held[i] ? group[i - 1] : groups++;
  double m[most][most] = {}, x[most] = {};
  for (std::size_t i = 0; i < system.n; ++i) {
    x[group[i]] += system.force[i];
    for (std::size_t j = 0; j < system.n; ++j) m[group[i]][group[j]] += system.m[i][j];
  }
  solve(groups, m, x);
  SwingMotion out;
  for (std::size_t i = 0; i < n; ++i) {
    out.rate.angle[i] = s.rate[i];
    out.rate.rate[i] = x[group[i]];
  }
  if (system.n > n) {
    out.rate.bend = s.bend_rate;
    out.rate.bend_rate = x[group[n]];
  }
  // What holds a link makes up what its own row lacks; from the end of the chain, since it pushes back on the one
  // before.
  double behind = 0;
  for (std::size_t i = n; i-- > 1;) {
    double lack = -system.force[i] + behind;
    for (std::size_t j = 0; j < system.n; ++j) lack += system.m[i][j] * x[group[j]];
    out.hold_torque[i] = held[i] ? lack : 0;
    behind = out.hold_torque[i];
  }
  return out;
}

SwingState swing_start(const Swing& swing) {
  SwingState s;
  for (std::size_t i = 0; i < swing.links.size() && i < max_swing_links; ++i) {
    s.angle[i] = swing.links[i].angle;
    s.rate[i] = swing.links[i].rate;
  }
  return s;
}

double swing_energy(const Swing& swing, const SwingState& s) {
  const System system = assemble(swing, 0, s);
  const std::size_t n = swing.links.size();
  double v[most] = {}, energy = 0;
  for (std::size_t i = 0; i < n; ++i) v[i] = s.rate[i];
  v[n] = s.bend_rate;
  for (std::size_t i = 0; i < system.n; ++i)
    for (std::size_t j = 0; j < system.n; ++j) energy += 0.5 * v[i] * system.m[i][j] * v[j];
  const double g = swing.gravity * math::sin(swing.plane);
  for (std::size_t i = 0; i < n; ++i) {
    const SwingLink& link = swing.links[i];
    energy += g * (link.mass * link.centre + link.length * hanging(swing, i)) * (1 - math::cos(s.angle[i]));
  }
  if (system.n > n) {
    const Mode mode = mode_of(swing);
    energy += 0.5 * mode.spring * s.bend * s.bend + g * mode.first * s.bend * math::sin(s.angle[n - 1]);
  }
  return energy;
}

Vec2d swing_point(const Swing& swing, const SwingState& s, std::size_t joint) {
  Vec2d p{};
  const std::size_t n = swing.links.size();
  for (std::size_t i = 0; i <= joint && i < n; ++i) {
    const math::SinCos<double> t = math::sincos(s.angle[i]);
    p += swing.links[i].length * Vec2d{t.sin, -t.cos};
    if (i + 1 == n) p += s.bend * Vec2d{t.cos, t.sin};
  }
  return p;
}

Vec2d head_velocity(const Swing& swing, double time, const SwingState& s) {
  Vec2d v{swing.hub.integral(time), 0};
  const std::size_t n = swing.links.size();
  for (std::size_t i = 0; i < n; ++i) {
    const math::SinCos<double> t = math::sincos(s.angle[i]);
    const Vec2d across{t.cos, t.sin}, along{t.sin, -t.cos};
    v += (swing.links[i].length * s.rate[i]) * across;
    if (i + 1 == n) v += s.bend_rate * across - (s.bend * s.rate[i]) * along;
  }
  return v;
}

core::Status check(const Swing& swing) {
  if (swing.links.size() < 2 || swing.links.size() > max_swing_links)
    return core::Error{core::refused("number of links of a swing", swing.links.size(), "2 to 4")};
  core::Status status;
  const auto number = [&](std::string_view name, std::size_t i, double value, double low, double high) {
    if (status.ok() && !(value >= low && value <= high))
      status = core::Error{core::text(name, " of link ", i + 1, " of a swing is ", value, ", expected a number in [",
                                      low, ", ", high, "]")};
  };
  const auto curve = [&](std::string_view name, const Curve& c) {
    for (std::size_t k = 0; k < c.points.size() && status.ok(); ++k)
      if (!math::is_finite(c.points[k].time) || !math::is_finite(c.points[k].value) ||
          (k > 0 && !(c.points[k].time > c.points[k - 1].time)))
        status = core::Error{
            core::text("point ", k + 1, " of the ", name, " of a swing must be finite and later than the one before")};
  };
  for (std::size_t i = 0; i < swing.links.size(); ++i) {
    const SwingLink& link = swing.links[i];
    number("mass", i, link.mass, 1e-6, 1e4);
    number("length", i, link.length, 1e-3, 100);
    number("centre", i, link.centre, 0, 100);
    number("inertia", i, link.inertia, 0, 1e6);
    number("angle", i, link.angle, -100, 100);
    number("rate", i, link.rate, -1e4, 1e4);
    number("time of the hold", i, link.hold.time, 0, 1e4);
    curve("torque", link.torque);
  }
  curve("hub's acceleration", swing.hub);
  const SwingLink& club = swing.links.back();
  if (status.ok() && !(club.inertia + club.mass * club.centre * club.centre > 0))
    status = core::Error{"the last link of a swing has no inertia about its joint"};
  if (status.ok() && !(swing.plane >= 0 && swing.plane <= math::pi))
    status = core::Error{core::refused("plane of a swing", swing.plane, "rad in [0, pi]")};
  if (status.ok() && !math::is_finite(swing.gravity)) status = core::Error{"gravity of a swing is not finite"};
  if (status.ok() && swing.shaft.frequency != 0) {
    const FlexibleShaft& shaft = swing.shaft;
    if (!(shaft.frequency > 0 && shaft.frequency < 1000))
      status = core::Error{core::refused("frequency of a shaft", shaft.frequency, "Hz in (0, 1000), or 0")};
    else if (!(shaft.head_mass > 0 && shaft.shaft_mass >= 0 &&
               shaft.head_mass + shaft.shaft_mass <= club.mass * (1 + 1e-9)))
      status =
          core::Error{core::text("head_mass and shaft_mass of a shaft are ", shaft.head_mass, " and ", shaft.shaft_mass,
                                 ", expected together at most the last link's mass ", club.mass)};
    else if (const Mode mode = mode_of(swing);
             !(mode.moment * mode.moment < mode.square * (club.inertia + club.mass * club.centre * club.centre)))
      status = core::Error{
          "head_mass and shaft_mass of a shaft have more inertia about the hands than the last link itself"};
    else if (!(shaft.damping_ratio >= 0 && shaft.damping_ratio < 10))
      status = core::Error{core::refused("damping_ratio of a shaft", shaft.damping_ratio, "a number in [0, 10)")};
  }
  return status;
}

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
