#include "carom/ballistics/rocket.h"

#include "carom/ballistics/detail/point_mass.h"
#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {

struct RocketState {
  Vec3d position{}, velocity{}, axis{}, turning{};  // turning: ė
  friend RocketState operator+(const RocketState& a, const RocketState& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.axis + b.axis, a.turning + b.turning};
  }
  friend RocketState operator*(double s, const RocketState& a) {
    return {s * a.position, s * a.velocity, s * a.axis, s * a.turning};
  }
};

}  // namespace detail
}  // namespace carom::ballistics

template <>
inline constexpr int carom::ode::components<carom::ballistics::detail::RocketState> = 12;

namespace carom::ballistics {

const char* to_string(RocketEvent event) {
  constexpr const char* names[] = {"ignition", "rail_exit", "burnout", "separation", "apex", "parachute", "landing"};
  return names[int(event)];
}

Stability barrowman(const Rocket& rocket) {
  // Ogive nose: slope 2 at .466 of its length.
  const double nose = 2, nose_centre = 0.466 * rocket.nose_length, radius = 0.5 * rocket.diameter;
  const Fins& f = rocket.fins;
  if (f.count < 1 || !(f.span > 0)) return {nose, nose_centre};
  const double middle = f.sweep + 0.5 * (f.tip_chord - f.root_chord);
  const double mid_line = math::hypot(f.span, middle);  // along the middles of the chords
  const double chords = f.root_chord + f.tip_chord;
  const double body = 1 + radius / (f.span + radius);
  const double fins = body * 4 * f.count * math::square(f.span / rocket.diameter) /
                      (1 + math::sqrt(1 + math::square(2 * mid_line / chords)));
  const double centre = f.position + f.sweep / 3 * (f.root_chord + 2 * f.tip_chord) / chords +
                        (chords - f.root_chord * f.tip_chord / chords) / 6;
  return {nose + fins, (nose * nose_centre + fins * centre) / (nose + fins)};
}

namespace detail {

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
MassNow mass_at(const Rocket& rocket, const Schedule& schedule, double time) {
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

core::Result<void> check(const Rocket& rocket, const Launch& launch) {
  if (rocket.stages.empty()) return core::Error{"rocket: no stages, expected at least one"};
  const auto positive = [](double x) { return x > 0 && math::is_finite(x); };
  for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
    const Stage& stage = rocket.stages[i];
    const struct {
      const char* name;
      double value;
      bool zero;
    } fields[] = {{"dry_mass", stage.dry_mass, true},
                  {"mass of the motor", stage.motor.mass, true},
                  {"ignition_delay", stage.ignition_delay, true},
                  {"separation_delay", stage.separation_delay, true}};
    for (const auto& field : fields)
      if (!math::is_finite(field.value) || field.value < 0)
        return core::Error{
            core::text("rocket: stage ", i + 1, ": ", core::refused(field.name, field.value, "a finite number >= 0"))};
    if (!(stage.dry_mass + stage.motor.mass - stage.motor.propellant_mass > 0))
      return core::Error{
          core::text("rocket: stage ", i + 1, " has no mass when it has burnt out, expected more than its propellant")};
  }
  if (!positive(rocket.diameter))
    return core::Error{core::text("rocket: ", core::refused("diameter", rocket.diameter, "a finite number > 0"))};
  if (!positive(rocket.length))
    return core::Error{core::text("rocket: ", core::refused("length", rocket.length, "a finite number > 0"))};
  if (!positive(math::length(launch.direction))) return core::Error{"launch: the direction of the rail has no length"};
  if (!(launch.rail_length >= 0))
    return core::Error{core::text("launch: ", core::refused("rail_length", launch.rail_length, "a number >= 0"))};
  return {};
}

class RocketRun {
 public:
  RocketRun(const Rocket& rocket, const Conditions& conditions, const Launch& launch, RocketModel model)
      : rocket_(rocket),
        conditions_(conditions),
        launch_(launch),
        model_(model),
        schedule_(rocket),
        stability_(barrowman(rocket)) {
    rail_ = math::normalize(launch.direction);
  }

  RocketState derivative(double time, const RocketState& s) const {
    const MassNow now = mass_at(rocket_, schedule_, time);
    const Vec3d g = point_mass_acceleration({}, conditions_, s.position, s.velocity);
    const environment::AirColumn::Air air = conditions_.air.at(s.position.y);
    const Vec3d w = s.velocity - conditions_.wind.at(s.position.y);
    const double speed = math::length(w), area = math::pi / 4 * rocket_.diameter * rocket_.diameter;
    const double q = 0.5 * air.density * speed * speed;
    if (under_parachute) {
      const Vec3d drag = (-0.5 * air.density * rocket_.parachute.drag_area * speed / now.mass) * w;
      return {s.velocity, g + drag, {}, {}};
    }
    const DragCurve& curve = now.thrust > 0 ? rocket_.drag : rocket_.coasting_drag;
    const double cd = curve(speed / air.speed_of_sound);
    Vec3d e = s.axis / math::length(s.axis);
    if (on_rail)
      e = rail_;
    else if (model_ == RocketModel::point_mass)
      e = speed > 1e-6 ? w / speed : rail_;
    Vec3d force = now.thrust * e - (q * area * cd) * (speed > 0 ? w / speed : Vec3d{});
    RocketState out{s.velocity, {}, {}, {}};
    if (!on_rail && model_ == RocketModel::six_degrees) {
      // The air meets the centre of pressure with the turning of the axis: that damps.
      const double arm = stability_.centre_of_pressure - now.centre;  // > 0: behind the centre of mass
      const Vec3d at_fins = w - arm * s.turning;
      const double fast = math::length(at_fins);
      const Vec3d across = at_fins - math::dot(at_fins, e) * e;
      const Vec3d normal = (-0.5 * air.density * fast * area * stability_.normal_slope) * across;
      force += normal;
      // The force acts `arm` behind the centre of mass, along −e.
      Vec3d swing = (-arm / now.inertia) * (normal - math::dot(normal, e) * e);
      // The jet takes along the sideways motion of what it leaves.
      const double flow = mass_flow(time);
      const double tail = rocket_.length - now.centre;
      swing -= (flow * tail * tail / now.inertia) * s.turning;
      out.axis = s.turning;
      out.turning = swing - math::length_squared(s.turning) * e;
    }
    out.velocity = g + force / now.mass;
    if (on_rail) {
      const double along = math::dot(out.velocity, rail_);
      out.velocity = (s.velocity == Vec3d{} && along < 0 ? 0.0 : along) * rail_;
      if (math::dot(s.velocity, rail_) < 0) out.velocity = {};
    }
    return out;
  }

  double mass_flow(double time) const {
    double flow = 0;
    for (std::size_t i = 0; i < rocket_.stages.size(); ++i) {
      const Motor& motor = rocket_.stages[i].motor;
      const double burning = time - schedule_.stages[i].ignition;
      if (burning >= 0 && motor.exhaust_speed() > 0) flow += motor.curve.thrust(burning) / motor.exhaust_speed();
    }
    return flow;
  }
  double mass(double time) const { return mass_at(rocket_, schedule_, time).mass; }
  double angle_of_attack(const RocketState& s) const {
    const Vec3d w = s.velocity - conditions_.wind.at(s.position.y);
    return math::atan2(math::length(math::cross(s.axis, w)), math::dot(s.axis, w));
  }

  const Rocket& rocket_;
  const Conditions& conditions_;
  const Launch& launch_;
  RocketModel model_;
  Schedule schedule_;
  Stability stability_;
  Vec3d rail_{};
  bool on_rail = true, under_parachute = false;
};

}  // namespace detail

core::Result<RocketFlight> fly_rocket(const Rocket& rocket, const Conditions& conditions, const Launch& launch,
                                      RocketModel model, const FlightLimits& limits) {
  const core::Result<void> checked = detail::check(rocket, launch);
  if (!checked.ok()) return checked.error();
  if (!(limits.time > 0) || !math::is_finite(limits.time))
    return core::Error{core::refused("time limit of a flight", limits.time, "a finite number of seconds > 0")};
  detail::RocketRun run(rocket, conditions, launch, model);
  using State = detail::RocketState;
  State state{launch.position, {}, run.rail_, {}};
  std::vector<Trajectory::Node> nodes;
  std::vector<double> masses;
  std::vector<RocketMoment> events;
  double time = 0, largest_angle = 0;
  const auto derivative = [&](double t, const State& s) { return run.derivative(t, s); };
  const auto add_node = [&] {
    nodes.push_back({time, state.position, state.velocity, derivative(time, state).velocity});
    masses.push_back(run.mass(time));
  };
  const auto tell = [&](RocketEvent event, int stage = 0) {
    events.push_back({event, stage, time, state.position, state.velocity});
  };
  // Moments at which the equations change, known beforehand; every leg between two of them is smooth but for the
  // corners of the thrust curve, which are stops of their own.
  std::vector<double> stops;
  for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
    const auto& entry = run.schedule_.stages[i];
    for (const ThrustPoint& p : rocket.stages[i].motor.curve.points()) stops.push_back(entry.ignition + p.time);
    stops.push_back(entry.separation);
  }
  double deploy_at = rocket.parachute.drag_area > 0 && rocket.parachute.deploy_height < 1e299 ? 1e300 : -1;
  bool apex_passed = false, landed = false;
  add_node();
  std::vector<char> ignited(rocket.stages.size(), 0), burnt(rocket.stages.size(), 0), dropped(rocket.stages.size(), 0);
  while (time < limits.time && !landed) {
    for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
      const auto& entry = run.schedule_.stages[i];
      const int stage = int(i) + 1;
      if (!ignited[i] && time >= entry.ignition) ignited[i] = 1, tell(RocketEvent::ignition, stage);
      if (!burnt[i] && time >= entry.burnout) burnt[i] = 1, tell(RocketEvent::burnout, stage);
      if (!dropped[i] && time >= entry.separation) dropped[i] = 1, tell(RocketEvent::separation, stage);
    }
    if (deploy_at >= 0 && time >= deploy_at && !run.under_parachute) {
      run.under_parachute = true;
      tell(RocketEvent::parachute);
    }
    double until = math::min(limits.time, time + (model == RocketModel::six_degrees ? 0.02 : 0.25));
    for (const double stop : stops)
      if (stop > time) until = math::min(until, stop);
    if (deploy_at > time) until = math::min(until, deploy_at);
    ode::DormandPrince<State> solver(time, state,
                                     {.relative_tolerance = limits.tolerance, .absolute_tolerance = limits.tolerance});
    enum { rail, apex, height, ground, none };
    int what = none;
    const auto event = [&](double, const State& s) {
      double first = 1;
      const auto consider = [&](double value, int kind) {
        if (value < first) first = value, what = kind;
      };
      if (run.on_rail) consider(launch.rail_length - math::dot(s.position - launch.position, run.rail_), rail);
      if (!run.on_rail && !apex_passed) consider(s.velocity.y, apex);
      if (apex_passed && deploy_at >= 1e299) consider(s.position.y - rocket.parachute.deploy_height, height);
      if (!run.on_rail && s.velocity.y < 0) consider(s.position.y - limits.ground, ground);
      return first;
    };
    bool found = false;
    const ode::Outcome outcome = solver.advance_to_event(derivative, until, event, found,
                                                         {.crossing = ode::Crossing::falling, .time_tolerance = 1e-9});
    if (outcome != ode::Outcome::done)
      return core::Error{
          core::text("the flight cannot be integrated beyond ", solver.t(), " s: ", ode::to_string(outcome))};
    time = solver.t();
    state = solver.y();
    if (math::length(state.axis) > 0) state.axis = state.axis / math::length(state.axis);
    if (!run.on_rail && model == RocketModel::six_degrees && !run.under_parachute && math::length(state.velocity) > 5)
      largest_angle = math::max(largest_angle, run.angle_of_attack(state));
    if (found) {
      event(time, state);
      if (what == rail) {
        run.on_rail = false;
        state.axis = run.rail_;
        tell(RocketEvent::rail_exit);
      } else if (what == apex) {
        apex_passed = true;
        tell(RocketEvent::apex);
        if (rocket.parachute.drag_area > 0 && deploy_at < 0) deploy_at = time + rocket.parachute.deploy_delay;
      } else if (what == height) {
        deploy_at = time + rocket.parachute.deploy_delay;
      } else if (what == ground) {
        landed = true;
        tell(RocketEvent::landing);
      }
    }
    if (time > nodes.back().time) add_node();
  }
  return RocketFlight{Trajectory(std::move(nodes)), std::move(events), std::move(masses), largest_angle};
}

}  // namespace carom::ballistics
