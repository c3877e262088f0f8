#include "carom/sports/baseball.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/ode/dormand_prince.h"
#include "carom/sports/detail/number_fields.h"
#include "carom/sports/detail/sport_units.h"

namespace carom::sports {
namespace {

/// The calculator's equation, in feet: x to the right, y to centre field, z up.
struct Sheet {
  double rpm = 0, rim = 0;  // rim: r ω, ft/s
  Vec3d axis{};
  explicit Sheet(const CalculatorInput& in) {
    const double s = in.right_handed ? 1 : -1, phi = in.spray_angle * detail::degree;
    const double back = -763 + 120 * in.launch_angle + 21 * in.spray_angle * s,
                 side = -849 * s - 94 * in.spray_angle;  // rpm
    const math::SinCos<double> f = math::sincos(phi), t = math::sincos(in.launch_angle * detail::degree);
    const Vec3d spin{back * f.cos - side * t.sin * f.sin, -back * f.sin - side * t.sin * f.cos, side * t.cos};
    rpm = math::length(spin);
    axis = rpm > 0 ? spin / rpm : Vec3d{};
    rim = 9.125 / 12 / (2 * math::pi) * rpm * math::pi / 30;
  }
  Vec3d acceleration(Vec3d v) const {
    constexpr double k = 0.005316103027433, g = 32.174;
    const double speed = math::length(v), s = rim / speed;
    const double drag = 0.3008 + 0.0292 * rpm / 1000, lift = 1.12 * s / (0.583 + 2.333 * s);
    return (-k * drag * speed) * v + (k * lift * speed) * math::cross(axis, v) - Vec3d{0, 0, g};
  }
};

}  // namespace

core::Result<CalculatorResult> trajectory_calculator(const CalculatorInput& in, CalculatorMode mode) {
  const struct {
    const char* name;
    double value, low, high;
  } rules[] = {{"exit_speed", in.exit_speed, 1, 1000},
               {"launch_angle", in.launch_angle, -89, 89},
               {"spray_angle", in.spray_angle, -180, 180},
               {"height", in.height, 0, 1000}};
  for (const auto& rule : rules)
    if (!(rule.value >= rule.low && rule.value <= rule.high))
      return core::Error{core::text(rule.name, " of a hit is ", rule.value, ", expected a number in [", rule.low, ", ",
                                    rule.high, "]")};
  const Sheet sheet(in);
  const math::SinCos<double> t = math::sincos(in.launch_angle * detail::degree),
                             f = math::sincos(in.spray_angle * detail::degree);
  const double v0 = 1.467 * in.exit_speed;
  Vec3d p{0, 2, in.height}, v = v0 * Vec3d{t.cos * f.sin, t.cos * f.cos, t.sin};
  CalculatorResult result;
  if (mode == CalculatorMode::sheet) {
    constexpr double dt = 0.01;
    for (int i = 0; i < 6000; ++i) {
      const Vec3d a = sheet.acceleration(v), next = p + dt * v + (0.5 * dt * dt) * a;
      if (next.z < 0) {
        const double part = p.z / (p.z - next.z);
        const Vec3d end = p + part * (next - p);
        return CalculatorResult{math::hypot(end.x, end.y), dt * (i + part), end.x, end.y};
      }
      p = next;
      v += dt * a;
    }
    return core::Error{"the ball does not come down within 60 s"};
  }
  using State = ode::Motion<Vec3d>;
  const auto rates = [&](double, const State& s) { return State{s.velocity, sheet.acceleration(s.velocity)}; };
  ode::DormandPrince<State> solver(0, {p, v},
                                   {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11, .maximum_step = 0.05});
  bool found = false;
  const ode::Outcome outcome = solver.advance_to_event(rates, 60.0, [](double, const State& s) { return s.position.z; },
                                                       found, {.crossing = ode::Crossing::falling});
  if (outcome != ode::Outcome::done)
    return core::Error{core::text("the hit cannot be integrated: ", ode::to_string(outcome))};
  if (!found) return core::Error{"the ball does not come down within 60 s"};
  const Vec3d end = solver.y().position;
  return CalculatorResult{math::hypot(end.x, end.y), solver.t(), end.x, end.y};
}

core::Result<PitchResult> pitch(const Ball& ball, const Conditions& conditions, const Pitch& p, double distance) {
  if (const core::Status good = detail::check_fields(p, "a pitch"); !good) return good.error();
  const auto thrown = [&](double spin) {
    return fly_until(ball, conditions,
                     launch_state({.speed = p.speed,
                                   .elevation = p.elevation,
                                   .azimuth = p.azimuth,
                                   .spin = spin,
                                   .tilt = p.tilt,
                                   .gyro = spin == 0 ? 0 : p.gyro},
                                  p.release),
                     [&](double, const BallState& s) { return p.release.x + distance - s.position.x; }, {.time = 10});
  };
  auto path = thrown(p.spin);
  if (!path) return path.error();
  const auto straight = thrown(0);
  if (!straight) return straight.error();
  const auto end = path->end(), plain = straight->end();
  if (end.time >= 10 || plain.time >= 10) return core::Error{"the pitch does not reach the plate within 10 s"};
  return PitchResult{.path = std::move(*path),
                     .time = end.time,
                     .speed = math::length(end.velocity),
                     .height = end.position.y,
                     .side = end.position.z,
                     .rise = end.position.y - plain.position.y,
                     .run = end.position.z - plain.position.z};
}

core::Result<Pitch> aimed(const Ball& ball, const Conditions& conditions, const Pitch& start, double height,
                          double side, double distance) {
  Pitch p = start;
  for (int i = 0; i < 30; ++i) {
    const auto path = pitch(ball, conditions, p, distance);
    if (!path) return path.error();
    const double up = height - path->height, right = side - path->side;
    if (math::abs(up) < 1e-3 && math::abs(right) < 1e-3) return p;
    p.elevation = math::clamp(p.elevation + up / distance, -1.0, 1.0);
    p.azimuth = math::clamp(p.azimuth + right / distance, -1.0, 1.0);
  }
  return core::Error{core::text("no pitch of ", p.speed, " m/s was found that crosses the plate ", height, " m high")};
}

core::Result<BallState> hit(const Ball& ball, const Bat& bat, const BatSwing& swing, const BallState& pitch) {
  if (const core::Status good = check(ball); !good) return good.error();
  if (const core::Status good = detail::check_fields(bat, "a bat"); !good) return good.error();
  const double reach = bat.radius + ball.radius;
  const struct {
    const char* name;
    double value, low, high;
  } rules[] = {{"speed of a swing", swing.speed, 0, 1000},
               {"attack of a swing", swing.attack, -1.5, 1.5},
               {"spray of a swing", swing.spray, -1.5, 1.5},
               {"offset of a swing", swing.offset, -0.999 * reach, 0.999 * reach}};
  for (const auto& rule : rules)
    if (!(rule.value >= rule.low && rule.value <= rule.high))
      return core::Error{
          core::text(rule.name, " is ", rule.value, ", expected a number in [", rule.low, ", ", rule.high, "]")};
  const math::SinCos<double> a = math::sincos(swing.attack), f = math::sincos(swing.spray);
  // The bat comes along `way`; the line of centres leans from it by the offset, up where the bat is below.
  const Vec3d way{-a.cos * f.cos, a.sin, a.cos * f.sin}, side{f.sin, 0, f.cos};
  const Vec3d up = math::cross(way, side);
  const double sine = swing.offset / reach, cosine = math::sqrt(1 - sine * sine);
  const Vec3d n = cosine * way + (up.y >= 0 ? sine : -sine) * up;
  BallState after = pitch;
  const Vec3d u =
      pitch.velocity - swing.speed * way - ball.radius * math::cross(pitch.spin, n);  // ball's point over bat
  const double approach = -math::dot(u, n);
  if (!(approach > 0)) return core::Error{"the bat does not meet the ball: they part already"};
  const double inverse = 1 / ball.mass + 1 / bat.effective_mass, beta = ball.inertia_factor;
  const double normal = (1 + bat.restitution) * approach / inverse;
  const Vec3d slip = u + approach * n;
  const double speed = math::length(slip);
  const double grip = (1 + bat.tangential_restitution) * speed / (inverse + 1 / (beta * ball.mass));
  const double size = math::min(grip, bat.friction * normal);
  const Vec3d rub = speed > 0 ? (-size / speed) * slip : Vec3d{};
  after.velocity += (1 / ball.mass) * (normal * n + rub);
  after.spin += (-1 / (beta * ball.mass * ball.radius)) * math::cross(n, rub);
  return after;
}

}  // namespace carom::sports
