#include "carom/sports/golf_swing.h"

#include "carom/core/string.h"

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

}  // namespace carom::sports
