#include "carom/ballistics/body_shell.h"

#include "carom/ballistics/detail/shell_motion.h"
#include "carom/core/string.h"
#include "carom/geometry/hull.h"
#include "carom/math/rotation.h"

namespace carom::ballistics {

using math::Vec3d;
using math::Vec3f;
using rigid::Dim3;

namespace {

double length_of(const Shell& shell) { return shell.length > 0 ? shell.length : 4.5 * shell.diameter; }
double centre_of(const Shell& shell) { return shell.centre > 0 ? shell.centre : 0.65 * length_of(shell); }

/// A boat tail, a cylinder and an ogive, which take a tenth, two fifths and half of the length.
core::Result<std::shared_ptr<const geometry::Hull>> hull_of(const Shell& shell) {
  const double length = length_of(shell), radius = 0.5 * shell.diameter, nose = centre_of(shell);
  struct Ring {
    double from_nose, radius;  // shares of length and radius
  };
  constexpr Ring rings[] = {{0.01, 0.1}, {0.15, 0.5}, {0.3, 0.8}, {0.5, 1}, {0.9, 1}, {1, 0.85}};
  constexpr int sides = 10;
  std::vector<Vec3f> points;
  for (const Ring& ring : rings)
    for (int i = 0; i < sides; ++i) {
      const math::SinCos<double> t = math::sincos(2 * math::pi * i / sides);
      points.push_back(
          Vec3f(Vec3d{nose - ring.from_nose * length, ring.radius * radius * t.cos, ring.radius * radius * t.sin}));
    }
  return geometry::make_hull(points);
}

/// rad, as a vector across both unit vectors.
Vec3d shortest_turn(Vec3d from, Vec3d to) {
  const Vec3d axis = cross(from, to);
  const double sine = length(axis), cosine = dot(from, to);
  if (sine > 1e-12) return (math::atan2(sine, cosine) / sine) * axis;
  return cosine > 0 ? Vec3d{} : math::pi * normalize(perpendicular(from));
}

Vec3d axis_of(const rigid::BodyState<Dim3>& state) { return rotate(math::Quatd(state.pose.rotation), Vec3d{1, 0, 0}); }

}  // namespace

core::Result<BodyShell> BodyShell::make(rigid::World3& world, const BodyShellDef& d) {
  if (auto s = check(d.shell); !s) return s.error();
  const double speed = length(d.start.velocity);
  if (!(speed > 0) || !math::is_finite(speed))
    return core::Error{core::text("shell: ", core::refused("speed at the muzzle", speed, "a finite number > 0"))};
  for (const auto& [name, value] : {std::pair{"spin", d.spin}, {"tip", length(d.tip)}})
    if (!math::is_finite(value) || math::abs(value) > 1e6)
      return core::Error{core::text("shell: ", core::refused(name, value, "at most 10^6 rad/s"))};
  if (!math::is_finite(d.fired_at) || d.fired_at < 0)
    return core::Error{core::text("shell: ", core::refused("fired_at", d.fired_at, "a finite number of seconds >= 0"))};
  const auto hull = hull_of(d.shell);
  if (!hull) return core::Error{core::text("shell: ", hull.error().message)};
  BodyShell made;
  made.definition_ = std::make_shared<const BodyShellDef>(d);
  made.motion_ = launched(d.shell, d.start, d.spin != 0 ? d.spin : muzzle_spin(d.shell, speed), d.model, d.tip);
  rigid::BodyDef<Dim3> body;
  body.position = d.start.position;
  body.rotation = math::Quatf(math::from_to(Vec3d{1, 0, 0}, made.motion_.axis));
  body.gravity_scale = 0;
  body.bullet = true;
  body.enabled = false;
  body.name = d.name;
  const auto id = world.create_body(body);
  if (!id) return id.error();
  made.body_ = *id;
  rigid::ShapeDef<Dim3> shape = d.shape;
  shape.density = 0;
  if (const auto added = world.add_shape(*id, *hull, shape); !added) return added.error();
  const double along = d.shell.axial_inertia, across = d.shell.transverse_inertia;
  if (auto s = world.set_mass_properties(*id, {d.shell.mass, {}, {{along, 0, 0}, {0, across, 0}, {0, 0, across}}}); !s)
    return s.error();
  return made;
}

void BodyShell::set_conditions(const Conditions& conditions) {
  BodyShellDef definition = *definition_;
  definition.conditions = conditions;
  definition_ = std::make_shared<const BodyShellDef>(std::move(definition));
}

bool BodyShell::touches(const rigid::World3& world, Vec3d& point) {
  std::vector<rigid::ContactView<Dim3>> contacts;
  world.contacts(body_, contacts);
  for (const rigid::ContactView<Dim3>& contact : contacts)
    for (int i = 0; i < contact.count; ++i)
      if (contact.points[i].normal_impulse > 0) return point = contact.points[i].point, true;
  return false;
}

/// What the last step brought that was not the model's.
void BodyShell::take_over(const rigid::BodyState<Dim3>& state) {
  const Shell& shell = definition_->shell;
  motion_.position = state.center_of_mass;
  motion_.velocity += Vec3d(state.linear_velocity) - Vec3d(given_velocity_);
  const Vec3d turned = Vec3d(state.angular_velocity) - Vec3d(given_turn_);
  const double along = dot(turned, motion_.axis);
  motion_.spin += along;
  if (definition_->model == ShellModel::six_degrees)
    motion_.momentum +=
        shell.transverse_inertia * turned + ((shell.axial_inertia - shell.transverse_inertia) * along) * motion_.axis;
}

core::Status BodyShell::land(rigid::World3& world, const rigid::BodyState<Dim3>& state, Vec3d point) {
  phase_ = Phase::landed;
  const double whole = length(way_), nose = centre_of(definition_->shell);
  const double share = whole > 0 ? math::clamp((dot(point - from_, way_) / whole - nose) / whole, 0.0, 1.0) : 0;
  impact_ = {stopped_at_ >= 0 ? stopped_at_ : world.time() - (1 - share) * step_, point, Vec3d(given_velocity_),
             motion_.spin};
  if (definition_->sticks) {
    if (auto s = world.set_velocity(body_, {}, {}); !s) return s;
    const math::Quatf along(math::from_to(Vec3d{1, 0, 0}, motion_.axis));
    if (auto s = world.set_pose(body_, from_ + share * way_, along); !s) return s;
    return world.set_type(body_, rigid::BodyType::fixed);
  }
  if (auto s = world.set_gravity_scale(body_, 1); !s) return s;
  const Shell& shell = definition_->shell;
  rigid::CylinderDrag<Dim3> drag;
  drag.body = body_;
  drag.diameter = shell.diameter;
  drag.length = length_of(shell);
  drag.density = definition_->conditions.air.at(state.center_of_mass.y).density;
  drag.point.x = float(centre_of(shell) - 0.5 * drag.length);
  if (drag.density > 0)
    if (const auto added = world.add_effector(drag); !added) return added.error();
  return world.set_velocity(body_, state.linear_velocity,
                            state.angular_velocity + Vec3f(motion_.spin * axis_of(state)));
}

/// The body is sent where the model goes in the next step.
core::Status BodyShell::lead(rigid::World3& world, const rigid::BodyState<Dim3>& state, double dt) {
  const BodyShellDef& d = *definition_;
  const double time = world.time();
  motion_ = flown(d.shell, d.conditions, d.model, motion_, time, dt);
  if (!math::is_finite(length(motion_.position) + length(motion_.velocity) + length(motion_.axis) + motion_.spin))
    return core::Error{core::text(d.name, ": its flight cannot be computed beyond ", time,
                                  " s, expected coefficients under which it stays finite")};
  yaw_ = yaw_of(d.conditions, motion_, time + dt);
  const environment::AirColumn::Air air = d.conditions.air.at(motion_.position.y);
  const double speed = length(motion_.velocity - detail::wind_of(d.conditions, motion_.position, time + dt));
  stability_ = air.density > 0 && speed > 0
                   ? gyroscopic_stability(d.shell, motion_.spin, air.density, speed, speed / air.speed_of_sound)
                   : 0;
  from_ = state.center_of_mass, way_ = motion_.position - from_, step_ = dt;
  given_velocity_ = Vec3f(way_ / dt);
  given_turn_ = Vec3f(shortest_turn(axis_of(state), motion_.axis) / dt);
  if (d.world_turns) {
    const Vec3d turning = 2 * d.shell.mass * cross(d.conditions.rotation, Vec3d(given_velocity_));
    if (auto s = world.add_force(body_, Vec3f(turning)); !s) return s;
  }
  return world.set_velocity(body_, given_velocity_, given_turn_);
}

core::Status BodyShell::before_step(rigid::World3& world, double dt) {
  if (!(dt > 0) || !math::is_finite(dt))
    return core::Error{core::refused("BodyShell::before_step: dt", dt, "a finite number of seconds > 0")};
  const auto state = world.state(body_);
  if (!state || phase_ == Phase::landed) return {};  // gone, or a body like others
  if (phase_ == Phase::waits) {
    if (world.time() < definition_->fired_at - 1e-9) return {};
    phase_ = Phase::flies;
    if (auto s = world.set_enabled(body_, true); !s) return s;
    return lead(world, *state, dt);
  }
  if (Vec3d point; touches(world, point)) return land(world, *state, point);
  // Held at the surface of what it would have gone into, it touches that in the next step.
  const double whole = length_squared(way_), share = whole > 0 ? dot(state->center_of_mass - from_, way_) / whole : 1;
  stopped_at_ = share < 0.999 ? world.time() - (1 - share) * step_ : -1;
  take_over(*state);
  return lead(world, *state, dt);
}

}  // namespace carom::ballistics
