#include "carom/sports/bounce.h"

#include <optional>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/ode/dormand_prince.h"
#include "carom/sports/detail/number_fields.h"

namespace carom::sports {
namespace {

constexpr double stimp_speed = 1.83;  // m/s
constexpr double slip_end = 0.01;     // m/s: slower slip counts as rolling

Vec3d tangent(Vec3d v, Vec3d normal) { return v - math::dot(v, normal) * normal; }

/// Velocity of the point of contact over the ground.
Vec3d slip(const Ball& ball, Vec3d normal, const BallState& s) {
  return tangent(s.velocity, normal) - ball.radius * math::cross(s.spin, normal);
}

Surface penner(double rolling) {
  // A. R. Penner, Can. J. Phys. 80 (2002) 931: restitution and lean of turf under a golf ball.
  return {.friction = .4,
          .restitution = .510,
          .restitution_slope = .0375,
          .restitution_curve = .000903,
          .restitution_floor = .120,
          .restitution_speed = 20,
          .tilt = 15.4 * math::pi / 180,
          .rolling = rolling};
}

}  // namespace

core::Status check(const Surface& s) { return detail::check_fields(s, "a surface"); }

std::span<const SurfacePreset> surface_presets() {
  static const std::vector<SurfacePreset> list = [] {
    Surface rough = penner(.35), bunker = penner(1.2);
    rough.restitution = .40;
    rough.friction = .6;
    bunker.restitution = .15;
    bunker.restitution_slope = bunker.restitution_curve = bunker.restitution_floor = 0;
    bunker.friction = .8;
    const Surface fairway = penner(rolling_of_stimp(1.5)), green = penner(rolling_of_stimp(3.05));
    return std::vector<SurfacePreset>{
        {"fairway", "Penner, Can. J. Phys. 80 (2002) 931; rolls as a green of 1.5 m (5 ft) on the Stimpmeter", fairway},
        {"green", "Penner 2002; 3.05 m (10 ft) on the Stimpmeter", green},
        {"rough", "Penner 2002 with a softer, longer grass (designer values)", rough},
        {"bunker", "dry sand (designer values)", bunker},
        {"hard_court",
         "e .75: middle of what the ITF's approval rebound gives (.729 to .761); mu .6: Cross (class value)",
         {.friction = .60, .restitution = .745, .tangential_restitution = .1, .rolling = .03}},
        {"clay_court",
         "class values (Cross: mu near .8, slower and higher)",
         {.friction = .80, .restitution = .80, .tangential_restitution = .1, .rolling = .06}},
        {"grass_court",
         "class values (Cross: mu near .5, e near .70)",
         {.friction = .50, .restitution = .70, .tangential_restitution = .1, .rolling = .08}},
        {"wood_floor",
         "e .76: middle of what the basketball's drop rule gives (.731 to .795); mu class value",
         {.friction = .5, .restitution = .763, .tangential_restitution = .1, .rolling = .02}},
        {"table",
         "table tennis: 30 cm to 23 cm by the rules' drop test, e .876; mu class value",
         {.friction = .25, .restitution = .876, .rolling = .01}},
        {"pitch",
         "bounce of a ball dropped 16 ft on a fast pitch 25 to 30 in, e .36 to .40 at 9.8 m/s: V. I. Stewart & W. A. "
         "Adams, J. Sports Turf Res. Inst. 44 (1968) 49 (from memory); it leans as soil does under a fast ball, so "
         "that a bouncer comes to a batter's shoulder: designer value, as friction is",
         {.friction = .45,
          .restitution = .55,
          .restitution_slope = .0175,
          .restitution_floor = .35,
          .tilt = .026,
          .rolling = .06}},
        {"soccer_grass",
         "FIFA quality test: a ball dropped from 2 m rises .6 to 1.0 m (from memory), e .63",
         {.friction = .5, .restitution = .63, .rolling = .08}},
        {"outfield",
         "baseball on grass (designer values)",
         {.friction = .5, .restitution = .50, .restitution_slope = .006, .restitution_floor = .3, .rolling = .10}},
        {"ash_board",
         "a baseball against a board of northern white ash at 60 mph: .546 +- .032, the test of the major leagues "
         "(from "
         "memory); friction: designer value",
         {.friction = .5, .restitution = .546, .rolling = .02}},
    };
  }();
  return list;
}

core::Result<Surface> surface_preset(std::string_view name) {
  std::string known;
  for (const SurfacePreset& preset : surface_presets()) {
    if (preset.name == name) return preset.surface;
    known += core::text(known.empty() ? "" : ", ", preset.name);
  }
  return core::Error{core::text("the surface ", core::quoted(name), " is not known, expected one of ", known)};
}

double restitution(const Surface& surface, double normal_speed) {
  if (normal_speed >= surface.restitution_speed) return surface.restitution_floor;
  return math::max(
      surface.restitution_floor,
      surface.restitution - normal_speed * (surface.restitution_slope - normal_speed * surface.restitution_curve));
}

double rolling_of_stimp(double stimp) { return stimp_speed * stimp_speed / (2 * stimp * 9.80665); }

Bounce bounce(const Ball& ball, const Surface& surface, Vec3d normal, const BallState& before) {
  Bounce result{.after = before};
  if (!(math::dot(before.velocity, normal) < 0)) return result;
  Vec3d n = normal;
  if (surface.tilt > 0) {
    const double speed = math::length(before.velocity);
    const Vec3d along = tangent(before.velocity, normal);
    const double level = math::length(along);
    if (level > 1e-9) {
      const double angle = math::atan2(level, -math::dot(before.velocity, normal));  // from the normal
      const double lean = math::min(angle, surface.tilt * (speed / surface.tilt_speed) * (angle / surface.tilt_angle));
      const math::SinCos<double> t = math::sincos(lean);
      n = t.cos * normal - (t.sin / level) * along;
    }
  }
  const double approach = -math::dot(before.velocity, n);
  const double e = restitution(surface, approach), beta = ball.inertia_factor;
  const double normal_change = (1 + e) * approach;  // J_n/m
  const Vec3d u = slip(ball, n, before);
  const double speed = math::length(u);
  double grip = (1 + surface.tangential_restitution) * speed * beta / (1 + beta);
  const double limit = surface.friction * normal_change;
  result.slides = grip > limit;
  if (result.slides) grip = limit;
  const Vec3d tangent_change = speed > 0 ? (-grip / speed) * u : Vec3d{};
  result.after.velocity += normal_change * n + tangent_change;
  result.after.spin += (-1 / (beta * ball.radius)) * math::cross(n, tangent_change);
  // What leaned ground would throw into the ground itself stays on it.
  const double leaves = math::dot(result.after.velocity, normal);
  if (leaves < 0) result.after.velocity -= leaves * normal;
  result.normal_impulse = ball.mass * normal_change;
  result.tangent_impulse = ball.mass * tangent_change;
  return result;
}

BallState Shot::at(double time) const {
  std::size_t leg = 0;
  while (leg + 1 < legs_.size() && legs_[leg + 1].start <= time) ++leg;
  return legs_.empty() ? BallState{} : BallState(legs_[leg].path.at(time - legs_[leg].start));
}

Shot::Phase Shot::phase_at(double time) const {
  if (time >= end_) return Phase::rest;
  Phase phase = Phase::flight;
  for (const Leg& leg : legs_)
    if (leg.start <= time) phase = leg.phase;
  return phase;
}

core::Result<Shot> play(const Ball& ball, const Conditions& conditions, const BallState& start, GroundAt ground,
                        const PlayLimits& limits) {
  if (!(limits.time > 0 && limits.time <= 1e6) || limits.bounces < 0 || !(limits.roll_speed >= 0) ||
      !(limits.rest_speed > 0))
    return core::Error{"limits of a shot must be: time in (0, 1e6] s, bounces >= 0, roll_speed >= 0, rest_speed > 0"};
  if (const core::Status good = check(ground(start.position.x, start.position.z).surface); !good) return good.error();
  const double g = conditions.gravity;
  Shot shot;
  BallState state = start;
  double now = 0;
  const auto gap = [&](const BallState& s) {
    const Ground at = ground(s.position.x, s.position.z);
    return math::dot(s.velocity, at.normal) < 0 ? (s.position.y - at.height) * at.normal.y - ball.radius : 1.0;
  };
  const Ground first = ground(start.position.x, start.position.z);
  bool on_ground = (start.position.y - first.height) * first.normal.y - ball.radius <= 1e-9 &&
                   math::dot(start.velocity, first.normal) <= 1e-9;
  std::optional<Conditions> later;  // the time of a field of wind goes on from leg to leg
  for (int i = 0; !on_ground && now < limits.time; ++i) {
    if (conditions.field && i > 0) {
      if (!later) later = conditions;
      later->field_time = conditions.field_time + now;
    }
    auto leg = fly_until(ball, later ? *later : conditions, state, [&](double, const BallState& s) { return gap(s); },
                         {.time = limits.time - now, .tolerance = limits.tolerance});
    if (!leg) return leg.error();
    shot.legs_.push_back({now, Shot::Phase::flight, std::move(*leg)});
    now += shot.legs_.back().path.duration();
    state = shot.legs_.back().path.end();
    if (now >= limits.time) break;
    const Ground at = ground(state.position.x, state.position.z);
    const Bounce impact = bounce(ball, at.surface, at.normal, state);
    shot.contacts_.push_back({now, state, impact.after, impact.slides});
    state = impact.after;
    const double leaves = math::dot(state.velocity, at.normal);
    on_ground = leaves < limits.roll_speed || i >= limits.bounces;
    if (on_ground) state.velocity -= leaves * at.normal;
  }
  shot.roll_start_ = now;
  bool rolling = false;
  for (int i = 0; on_ground && now < limits.time && i < 40; ++i) {
    // Rates on the ground. Rolling: without slip, so spin follows the velocity.
    const auto rates = [&](double, const BallState& s) {
      const Ground at = ground(s.position.x, s.position.z);
      const Vec3d n = at.normal, v = tangent(s.velocity, n);
      const Vec3d pull = tangent(Vec3d{0, -g, 0}, n);
      const double press = g * n.y, beta = ball.inertia_factor;
      BallState rate;
      rate.position = v;
      if (rolling) {
        const double speed = math::sqrt(math::dot(v, v) + math::square(limits.rest_speed / 5));
        rate.velocity = pull / (1 + beta) - (at.surface.rolling * press / speed) * v;
        rate.spin = math::cross(n, rate.velocity) / ball.radius;
      } else {
        const Vec3d u = slip(ball, n, s);
        const Vec3d friction = (-at.surface.friction * press / math::max(math::length(u), 1e-9)) * u;
        rate.velocity = pull + friction;
        rate.spin = (-1 / (beta * ball.radius)) * math::cross(n, friction);
      }
      rate.turned = math::length(s.spin);
      return rate;
    };
    const Vec3d n = ground(state.position.x, state.position.z).normal;
    if (!rolling && !(math::length(slip(ball, n, state)) > slip_end)) {
      rolling = true;
      state.spin = math::cross(n, state.velocity) / ball.radius + math::dot(state.spin, n) * n;
    }
    const auto holds = [&](const BallState& s) {
      const Ground at = ground(s.position.x, s.position.z);
      const double steep = math::length(tangent(Vec3d{0, -g, 0}, at.normal)) / (1 + ball.inertia_factor);
      return steep <= at.surface.rolling * g * at.normal.y;
    };
    if (rolling && math::length(state.velocity) <= limits.rest_speed && holds(state)) break;
    const auto stop = [&](double, const BallState& s) {
      if (rolling) return math::length(s.velocity) - limits.rest_speed;
      return math::length(slip(ball, ground(s.position.x, s.position.z).normal, s)) - 0.5 * slip_end;
    };
    ode::DormandPrince<BallState> solver(
        0, state, {.relative_tolerance = 1e-7, .absolute_tolerance = 1e-7, .maximum_step = 0.25});
    std::vector<BallFlight::Node> nodes{{0, state, rates(0, state)}};
    bool found = false;
    const double left = limits.time - now;
    while (solver.t() < left && !found) {
      const double until = math::min(left, solver.t() + 0.25);
      const ode::Outcome outcome = solver.advance_to_event(
          rates, until, stop, found, {.crossing = ode::Crossing::falling, .time_tolerance = 1e-9});
      if (outcome != ode::Outcome::done)
        return core::Error{core::text("the ball's roll cannot be integrated beyond ", now + solver.t(),
                                      " s: ", ode::to_string(outcome))};
      nodes.push_back({solver.t(), solver.y(), rates(solver.t(), solver.y())});
    }
    state = solver.y();
    shot.legs_.push_back({now, Shot::Phase::roll, BallFlight(std::move(nodes))});
    now += solver.t();
    if (!found) break;
    if (rolling) {
      if (holds(state)) break;  // the slope holds it
    } else {
      const Vec3d up = ground(state.position.x, state.position.z).normal;
      rolling = true;
      state.spin = math::cross(up, state.velocity) / ball.radius + math::dot(state.spin, up) * up;
    }
  }
  shot.end_ = now;
  if (!on_ground) shot.roll_start_ = now;
  if (shot.legs_.empty()) shot.legs_.push_back({0, Shot::Phase::roll, BallFlight({{0, state, {}}})});
  return shot;
}

core::Result<Shot> play(const Ball& ball, const Conditions& conditions, const BallState& start, const Surface& surface,
                        const PlayLimits& limits) {
  return play(ball, conditions, start, [&](double, double) { return Ground{0, {0, 1, 0}, surface}; }, limits);
}

}  // namespace carom::sports
