#include "carom/ballistics/rocket.h"

#include "carom/ballistics/detail/number_checks.h"
#include "carom/ballistics/detail/rocket_run.h"
#include "carom/ode/dormand_prince.h"

namespace carom::ballistics {

using math::Vec3d;

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

core::Result<void> check(const Rocket& rocket, const Launch& launch) {
  if (rocket.stages.empty()) return core::Error{"rocket: no stages, expected at least one"};
  const auto positive = [](double x) { return x > 0 && math::is_finite(x); };
  for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
    const Stage& stage = rocket.stages[i];
    const core::Status numbers = check_numbers({{"dry_mass", stage.dry_mass, true},
                                                {"mass of the motor", stage.motor.mass, true},
                                                {"ignition_delay", stage.ignition_delay, true},
                                                {"separation_delay", stage.separation_delay, true}});
    if (!numbers) return core::Error{core::text("rocket: stage ", i + 1, ": ", numbers.error().message)};
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

}  // namespace detail

core::Result<RocketFlight> fly_rocket(const Rocket& rocket, const Conditions& conditions, const Launch& launch,
                                      RocketModel model, const FlightLimits& limits) {
  const core::Result<void> checked = detail::check(rocket, launch);
  if (!checked.ok()) return checked.error();
  if (!(limits.time > 0) || !math::is_finite(limits.time))
    return core::Error{core::refused("time limit of a flight", limits.time, "a finite number of seconds > 0")};
  const detail::RocketRun run(rocket, conditions, launch, model);
  bool on_rail = true, under_parachute = false;
  using State = detail::RocketState;
  State state{launch.position, {}, run.rail, {}};
  std::vector<Trajectory::Node> nodes;
  std::vector<double> masses;
  std::vector<RocketMoment> events;
  double time = 0, largest_angle = 0;
  const auto derivative = [&](double t, const State& s) { return run.derivative(t, s, on_rail, under_parachute); };
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
    const auto& entry = run.schedule.stages[i];
    for (const ThrustPoint& p : rocket.stages[i].motor.curve.points()) stops.push_back(entry.ignition + p.time);
    stops.push_back(entry.separation);
  }
  double deploy_at = rocket.parachute.drag_area > 0 && rocket.parachute.deploy_height < 1e299 ? 1e300 : -1;
  bool apex_passed = false, landed = false;
  add_node();
  std::vector<char> ignited(rocket.stages.size(), 0), burnt(rocket.stages.size(), 0), dropped(rocket.stages.size(), 0);
  const double leg = model == RocketModel::six_degrees || conditions.field ? detail::longest_field_step : 0.25;
  while (time < limits.time && !landed) {
    for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
      const auto& entry = run.schedule.stages[i];
      const int stage = int(i) + 1;
      if (!ignited[i] && time >= entry.ignition) ignited[i] = 1, tell(RocketEvent::ignition, stage);
      if (!burnt[i] && time >= entry.burnout) burnt[i] = 1, tell(RocketEvent::burnout, stage);
      if (!dropped[i] && time >= entry.separation) dropped[i] = 1, tell(RocketEvent::separation, stage);
    }
    if (deploy_at >= 0 && time >= deploy_at && !under_parachute) {
      under_parachute = true;
      tell(RocketEvent::parachute);
    }
    double until = math::min(limits.time, time + leg);
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
      if (on_rail) consider(launch.rail_length - math::dot(s.position - launch.position, run.rail), rail);
      if (!on_rail && !apex_passed) consider(s.velocity.y, apex);
      if (apex_passed && deploy_at >= 1e299) consider(s.position.y - rocket.parachute.deploy_height, height);
      if (!on_rail && s.velocity.y < 0) consider(s.position.y - limits.ground, ground);
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
    if (!on_rail && model == RocketModel::six_degrees && !under_parachute && math::length(state.velocity) > 5)
      largest_angle = math::max(largest_angle, run.angle_of_attack(time, state));
    if (found) {
      event(time, state);
      if (what == rail) {
        on_rail = false;
        state.axis = run.rail;
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
