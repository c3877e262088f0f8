#include "carom/ballistics/body_rocket.h"

#include "carom/ballistics/detail/rocket_run.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::ballistics {

using math::Vec3d;
using math::Vec3f;
using rigid::Dim3;

struct BodyRocket::Flight {
  BodyRocketDef definition;
  detail::RocketRun run;
  struct Extent {
    double top, bottom;  // m from the nose
  };
  std::vector<Extent> stages;

  explicit Flight(const BodyRocketDef& d)
      : definition(d), run(definition.rocket, definition.conditions, definition.launch, RocketModel::six_degrees) {
    definition.conditions.field_time += d.start;
    const Rocket& rocket = definition.rocket;
    double bottom = rocket.length;
    for (std::size_t i = 0; i < rocket.stages.size(); ++i) {
      // A stage reaches as far up as down from the centre of its dry mass.
      const std::size_t left = rocket.stages.size() - i;
      double top = 2 * rocket.stages[i].dry_centre - bottom;
      if (left == 1)
        top = 0;
      else if (!(top > 0.05 * bottom && top < 0.95 * bottom))
        top = bottom * double(left - 1) / double(left);
      stages.push_back({top, bottom});
      bottom = top;
    }
  }
  Flight(const Flight&) = delete;  // the run refers to the definition
  Flight& operator=(const Flight&) = delete;
};

namespace {

/// The shortest turn of one unit vector to another.
math::Quatf turn_from(Vec3d from, Vec3d to) {
  if (dot(from, to) < -0.999999) return {0, Vec3f(normalize(perpendicular(from)))};
  return math::Quatf(normalize(math::Quatd(1 + dot(from, to), cross(from, to))));
}

using Pieces = std::vector<std::pair<geometry::Shape3, math::Transform3f>>;

/// Tube, nose and fins of a stage, in the body's frame.
Pieces pieces_of(const Rocket& rocket, double top, double bottom) {
  Pieces pieces;
  const float radius = float(0.5 * rocket.diameter), gap = float(0.01 * rocket.diameter);
  const math::Quatf forward = turn_from({0, 1, 0}, {1, 0, 0});
  const auto at = [&](double from_nose) { return Vec3f{float(rocket.length - from_nose), 0, 0}; };
  double tube = top;
  if (top <= 0 && rocket.nose_length > 0) {
    tube = math::min(rocket.nose_length, 0.9 * bottom);
    pieces.push_back({geometry::Cone{float(0.5 * tube), radius}, {at(0.5 * tube), forward}});
  }
  const float half = math::max(float(0.5 * (bottom - tube)) - gap, gap);
  pieces.push_back({geometry::Cylinder{half, radius}, {at(0.5 * (tube + bottom)), forward}});
  const Fins& fins = rocket.fins;
  const double chord = 0.5 * (fins.root_chord + fins.tip_chord), middle = fins.position + 0.5 * (fins.sweep + chord);
  if (fins.count < 1 || !(fins.span > 0 && chord > 0) || middle < top || middle >= bottom) return pieces;
  for (int k = 0; k < fins.count; ++k) {
    const double angle = 2 * math::pi * k / fins.count;
    const Vec3f out{0, float(math::cos(angle)), float(math::sin(angle))};
    const Vec3f half_extents{float(0.5 * chord), float(0.5 * fins.span), float(math::max(0.001, 0.02 * fins.span))};
    pieces.push_back({geometry::Box{half_extents},
                      {at(middle) + (radius + half_extents.y) * out,
                       math::Quatf(float(math::cos(0.5 * angle)), Vec3f{float(math::sin(0.5 * angle)), 0, 0})}});
  }
  return pieces;
}

/// About the centre of mass: along x, and across.
math::Mat3d about_axis(double along, double across) { return {{along, 0, 0}, {0, across, 0}, {0, 0, across}}; }

core::Status add_pieces(rigid::World3& world, rigid::BodyId body, const Pieces& pieces, rigid::ShapeDef<Dim3> shape,
                        std::vector<rigid::ShapeId>& shapes) {
  for (const auto& [geometry, place] : pieces) {
    shape.local = place;
    const auto added = world.add_shape(body, geometry, shape);
    if (!added.ok()) return added.error();
    shapes.push_back(*added);
  }
  return {};
}

core::Error unfit(std::string_view what) { return core::Error{core::text("rocket: ", what)}; }

}  // namespace

core::Result<BodyRocket> BodyRocket::make(rigid::World3& world, const BodyRocketDef& d) {
  if (auto s = detail::check(d.rocket, d.launch); !s) return s.error();
  if (!math::is_finite(d.start) || d.start < 0)
    return unfit(core::refused("start", d.start, "a finite number of seconds >= 0"));
  const Stability stability = barrowman(d.rocket);
  if (!math::is_finite(stability.normal_slope) || !math::is_finite(stability.centre_of_pressure))
    return unfit("its fins have no chord, expected more than 0 m at the root or the tip");
  for (std::size_t i = 0; i < d.rocket.stages.size(); ++i) {
    const Stage& stage = d.rocket.stages[i];
    for (const double centre : {stage.dry_centre, stage.motor_centre})
      if (!(centre >= 0 && centre <= d.rocket.length))
        return unfit(
            core::text("stage ", i + 1, ": ",
                       core::refused("a centre of mass", centre, "0 to the rocket's length, m from the nose")));
    if (!(stage.dry_mass + stage.motor.mass <= 1e9))
      return unfit(core::text("stage ", i + 1, ": ",
                              core::refused("mass", stage.dry_mass + stage.motor.mass, "at most 1e9 kg")));
  }
  if (d.rocket.length > 1000 || d.rocket.diameter > 1000)
    return unfit("expected at most 1000 m of length and diameter");
  auto flight = std::make_shared<const Flight>(d);
  BodyRocket made;
  made.flight_ = flight;
  const Rocket& rocket = flight->definition.rocket;
  rigid::ShapeDef<Dim3> shape = d.shape;
  shape.density = 0;
  rigid::BodyDef<Dim3> body;
  body.position = d.launch.position;
  body.rotation = turn_from({1, 0, 0}, flight->run.rail);
  body.name = d.name;
  const auto id = world.create_body(body);
  if (!id.ok()) return id.error();
  made.body_ = *id;
  if (shape.filter.group == 0) shape.filter.group = -1000 - int(id->index);
  made.shape_ = shape;
  for (const Flight::Extent& extent : flight->stages)
    if (auto s = add_pieces(world, *id, pieces_of(rocket, extent.top, extent.bottom), shape,
                            made.stage_shapes_.emplace_back());
        !s)
      return s.error();
  if (auto s = made.set_mass(world, -d.start); !s) return s.error();
  const auto state = world.state(made.body_);
  if (!state.ok()) return state.error();
  made.first_height_ = state->center_of_mass.y;
  const Parachute& parachute = rocket.parachute;
  if (parachute.drag_area > 0 && parachute.deploy_height < 1e299) made.deploy_at_ = 1e300;
  return made;
}

void BodyRocket::set_conditions(const Conditions& conditions) {
  BodyRocketDef definition = flight_->definition;
  definition.conditions = conditions;
  flight_ = std::make_shared<const Flight>(definition);
}

core::Status BodyRocket::set_mass(rigid::World3& world, double time) {
  const Rocket& rocket = flight_->definition.rocket;
  const detail::MassNow now = detail::mass_at(rocket, flight_->run.schedule, time);
  if (now.mass == mass_ && now.centre == centre_) return {};
  mass_ = now.mass, centre_ = now.centre, inertia_ = now.inertia;
  const double along = now.mass * math::square(rocket.diameter) / 8;
  return world.set_mass_properties(
      body_, {now.mass, {rocket.length - now.centre, 0, 0}, about_axis(along, along / 2 + now.inertia)});
}

core::Status BodyRocket::drop(rigid::World3& world, const rigid::BodyState<Dim3>& state) {
  const BodyRocketDef& d = flight_->definition;
  const Rocket& rocket = d.rocket;
  const std::size_t index = dropped_.size();
  const Stage& stage = rocket.stages[index];
  const Flight::Extent& extent = flight_->stages[index];
  for (const rigid::ShapeId shape : stage_shapes_[index])
    if (auto s = world.destroy_shape(shape); !s) return s;
  const double burnt = stage.dry_mass + stage.motor.mass - stage.motor.propellant_mass,
               length = extent.bottom - extent.top, along = burnt * math::square(rocket.diameter) / 8;
  const Vec3d middle{rocket.length - stage.dry_centre, 0, 0};
  const std::string name = d.name + " stage " + std::to_string(index + 1);
  rigid::BodyDef<Dim3> body;
  body.position = state.pose.position;
  body.rotation = state.pose.rotation;
  body.name = name;
  const auto made = world.create_body(body);
  if (!made.ok()) return made.error();
  dropped_.push_back(*made);
  std::vector<rigid::ShapeId> shapes;
  if (auto s = add_pieces(world, *made, pieces_of(rocket, extent.top, extent.bottom), shape_, shapes); !s) return s;
  if (auto s = world.set_mass_properties(*made,
                                         {burnt, middle, about_axis(along, along / 2 + burnt * length * length / 12)});
      !s)
    return s;
  const Vec3d arm = rotate(math::Quatd(state.pose.rotation), middle) - (state.center_of_mass - state.pose.position);
  const Vec3d velocity = Vec3d(state.linear_velocity) + cross(Vec3d(state.angular_velocity), arm);
  if (auto s = world.set_velocity(*made, Vec3f(velocity), state.angular_velocity); !s) return s;
  rigid::QuadraticDrag<Dim3> drag;
  drag.body = *made;
  drag.density = d.conditions.air.at(state.center_of_mass.y).density;
  drag.drag_coefficient = 1.1;  // a cylinder across the air
  drag.area = length * rocket.diameter;
  drag.point = Vec3f(middle);
  drag.angular_coefficient = drag.density * rocket.diameter * math::square(math::square(length)) / 64;
  const auto added = world.add_effector(drag);
  return added.ok() ? core::Status{} : core::Status{added.error()};
}

core::Status BodyRocket::before_step(rigid::World3& world, double dt) {
  if (!(dt > 0) || !math::is_finite(dt))
    return core::Error{core::refused("BodyRocket::before_step: dt", dt, "a finite number of seconds > 0")};
  auto state = world.state(body_);
  if (!state.ok()) return {};  // it is gone
  const BodyRocketDef& d = flight_->definition;
  const Rocket& rocket = d.rocket;
  const detail::RocketRun& run = flight_->run;
  double time = world.time() - d.start;
  just_dropped_ = false;
  while (time >= run.schedule.stages[dropped_.size()].separation - 1e-9) {  // the last one's is never
    if (auto s = drop(world, *state); !s) return s;
    just_dropped_ = true;
  }
  const Vec3d center = state->center_of_mass;
  if (auto s = set_mass(world, time + 0.5 * dt); !s) return s;
  state = world.state(body_);
  if (!state.ok()) return state.error();
  const Vec3d spin(state->angular_velocity);
  Vec3d velocity(state->linear_velocity);
  if (just_dropped_) {  // what is left goes on with the velocity of its own centre
    velocity += cross(spin, state->center_of_mass - center);
    if (auto s = world.set_velocity(body_, Vec3f(velocity), state->angular_velocity); !s) return s;
  }
  const Vec3d axis = rotate(math::Quatd(state->pose.rotation), Vec3d{1, 0, 0});
  detail::RocketState s{state->center_of_mass, velocity, axis, cross(spin, axis)};
  thrust_ = detail::mass_at(rocket, run.schedule, time).thrust;
  const double tail = dot(state->pose.position - d.launch.position, run.rail);
  constexpr int parts = 8;
  const double h = dt / parts;
  Vec3d turned = spin;
  for (int k = 0; k < parts; ++k, time += h) {
    if (on_rail_ && tail + dot(s.position - state->center_of_mass, run.rail) >= d.launch.rail_length) on_rail_ = false;
    if (!on_rail_ && !apex_passed_ && s.velocity.y < 0) {
      apex_passed_ = true;
      if (rocket.parachute.drag_area > 0 && deploy_at_ < 0) deploy_at_ = time + rocket.parachute.deploy_delay;
    }
    if (apex_passed_ && deploy_at_ >= 1e299 && s.position.y < rocket.parachute.deploy_height)
      deploy_at_ = time + rocket.parachute.deploy_delay;
    if (deploy_at_ >= 0 && time >= deploy_at_) under_parachute_ = true;
    if (under_parachute_) {
      // Drag that would stop it within a fraction of a step is taken at the end of the part.
      const environment::AirColumn::Air air = d.conditions.air.at(s.position.y);
      const Vec3d wind = detail::wind_of(d.conditions, s.position, time);
      const Vec3d pulled = s.velocity - wind + h * detail::beside_drag(d.conditions, s.position, s.velocity);
      const double drag = 0.5 * air.density * rocket.parachute.drag_area / mass_ * length(s.velocity - wind);
      s.velocity = wind + pulled / (1 + h * drag);
      s.position += h * s.velocity;
      // The lines carry its weight at the nose; it swings out as fast as it can.
      const Vec3d w = s.velocity - wind;
      const double fast = length(w), lift = mass_ * d.conditions.gravity * centre_ / inertia_;
      if (fast > 1e-6) turned = (turned - (h * lift / fast) * cross(axis, w)) / (1 + 2 * h * math::sqrt(lift));
      continue;
    }
    const auto slope = [&](double t, const detail::RocketState& y) {
      return run.derivative(t, y, on_rail_, under_parachute_);
    };
    const detail::RocketState k1 = slope(time, s), k2 = slope(time + 0.5 * h, s + (0.5 * h) * k1),
                              k3 = slope(time + 0.5 * h, s + (0.5 * h) * k2), k4 = slope(time + h, s + h * k3);
    s = s + (h / 6) * (k1 + 2.0 * (k2 + k3) + k4);
    s.axis = s.axis / length(s.axis);
    turned = cross(s.axis, s.turning);
  }
  apex_ = math::max(apex_, state->center_of_mass.y - first_height_);
  // Landed and at rest, it may sleep.
  if (!state->awake && thrust_ == 0 && !on_rail_) return {};
  Vec3d change = (s.velocity - velocity) / dt;
  change.y += d.conditions.gravity;
  const Vec3d turn = under_parachute_ || !on_rail_ ? turned - spin : -spin;
  const Vec3d along = dot(turn, axis) * axis, across = turn - along;
  const double thin = mass_ * math::square(rocket.diameter) / 8;
  // A flight alone knows no roll: what there is of it stays.
  const Vec3d torque = ((thin / 2 + inertia_) / dt) * across + ((under_parachute_ ? thin : 0) / dt) * along;
  if (auto added = world.add_force(body_, Vec3f(mass_ * change)); !added) return added;
  return world.add_torque(body_, Vec3f(torque));
}

}  // namespace carom::ballistics
