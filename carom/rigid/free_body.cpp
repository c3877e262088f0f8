#include "carom/rigid/free_body.h"

#include "carom/core/string.h"
#include "carom/environment/atmosphere.h"
#include "carom/forces/drag.h"
#include "carom/math/elementary.h"

namespace carom::rigid {
using core::Error;
using core::Result;
using core::Status;
using math::Mat3d;
using math::Quatd;
using math::Vec3d;

FreeBodyState derivative(const FreeBody& body, const FreeBodyState& state, const FreeBodyLoad& load) {
  const Vec3d w = state.angular_velocity;
  const Vec3d momentum = body.inertia * w;
  return {state.velocity, load.force / body.mass, 0.5 * (state.attitude * w),
          body.inverse_inertia * (load.moment - math::cross(w, momentum))};
}

double twice_rotational_energy(const FreeBody& body, const FreeBodyState& state) {
  return math::dot(state.angular_velocity, body.inertia * state.angular_velocity);
}
Vec3d angular_momentum(const FreeBody& body, const FreeBodyState& state) {
  return math::rotate(state.attitude, body.inertia * state.angular_velocity);
}

namespace free_body_detail {

Quatd turn_about(int axis, double angle) {
  const math::SinCos<double> half = math::sincos(0.5 * angle);
  return {half.cos, axis == 0 ? half.sin : 0, axis == 1 ? half.sin : 0, axis == 2 ? half.sin : 0};
}

/// North-east-down at a place → Earth-fixed axes: east by the longitude, then z tipped from the pole to the ground.
Quatd ned_attitude(double latitude, double longitude) {
  return turn_about(2, longitude) * turn_about(1, -latitude - 0.5 * math::pi);
}

/// The three minors of a symmetric matrix are positive exactly where its eigenvalues are (Sylvester).
bool positive_definite(const Mat3d& m) {
  const double second = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  return m(0, 0) > 0 && second > 0 && math::determinant(m) > 0;
}

}  // namespace free_body_detail

Result<FreeBody> make_free_body(double mass, const Mat3d& inertia) {
  if (!math::is_finite(mass) || !(mass > 0)) return Error{core::refused("mass", mass, "a finite number > 0 (kg)")};
  double size = 0;
  for (int column = 0; column < 3; ++column) {
    if (!math::is_finite(inertia.column(column))) return Error{"inertia has an element that is not finite"};
    for (int row = 0; row < 3; ++row) size = math::max(size, math::abs(inertia(row, column)));
  }
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < column; ++row)
      if (math::abs(inertia(row, column) - inertia(column, row)) > 1e-9 * size)
        return Error{"inertia is not symmetric, expected I_xy = I_yx and so on"};
  // ½ tr(I) E − I is the tensor of second moments: it must not be negative, which is the triangle inequality for the
  // principal moments. A millionth is allowed for tensors given with few digits.
  const Mat3d second = (0.5 + 1e-6) * math::trace(inertia) * Mat3d::identity() - inertia;
  if (!free_body_detail::positive_definite(inertia) || !free_body_detail::positive_definite(second))
    return Error{
        "inertia is not that of a body, expected positive principal moments, none above the sum of the others"};
  return FreeBody{mass, inertia, math::inverse(inertia)};
}

Quatd to_attitude(const FlightAngles& angles) {
  const Quatd yaw = free_body_detail::turn_about(2, angles.yaw), pitch = free_body_detail::turn_about(1, angles.pitch),
              roll = free_body_detail::turn_about(0, angles.roll);
  return yaw * pitch * roll;
}

FlightAngles to_flight_angles(const Quatd& attitude) {
  const Mat3d r = math::to_matrix(attitude);
  const double sine = math::clamp(-r(2, 0), -1.0, 1.0), cosine = math::hypot(r(0, 0), r(1, 0));
  if (cosine < 1e-12) return {math::atan2(-r(0, 1), r(1, 1)), math::copysign(0.5 * math::pi, sine), 0};
  return {math::atan2(r(1, 0), r(0, 0)), math::atan2(sine, cosine), math::atan2(r(2, 1), r(2, 2))};
}

namespace free_body_detail {

/// Everything about the surroundings that depends on where the body is and when.
struct Surroundings {
  double altitude, latitude, longitude;
  Quatd ned;              // local north-east-down → inertial
  Vec3d ground_velocity;  // of the turning ground (and still air) at the body, inertial axes
  Vec3d gravitation;      // m/s², inertial axes
};

Surroundings surroundings(const FlightCase& flight, double time, Vec3d position) {
  Surroundings s{};
  switch (flight.world) {
    case FlightWorld::flat: {
      s.altitude = -position.z;
      s.latitude = flight.place.latitude;
      s.longitude = flight.place.longitude;
      const double r = flight.radius + s.altitude;
      s.gravitation = {0, 0, flight.gravity > 0 ? flight.gravity : flight.gm / (r * r)};
      break;
    }
    case FlightWorld::round: {
      const double r = math::length(position);
      s.altitude = r - flight.radius;
      s.latitude = math::atan2(position.z, math::hypot(position.x, position.y));
      s.longitude = math::atan2(position.y, position.x);
      s.ned = ned_attitude(s.latitude, s.longitude);
      s.gravitation = environment::spherical_gravity(position, flight.gm);
      break;
    }
    case FlightWorld::earth: {
      const double turned = flight.ellipsoid.rotation_rate * time;
      const Quatd to_inertial = turn_about(2, turned);
      const environment::Geodetic place =
          environment::to_geodetic(math::inverse_rotate(to_inertial, position), flight.ellipsoid);
      s.altitude = place.altitude;
      s.latitude = place.latitude;
      s.longitude = place.longitude;
      s.ned = to_inertial * ned_attitude(place.latitude, place.longitude);
      s.ground_velocity = math::cross(Vec3d{0, 0, flight.ellipsoid.rotation_rate}, position);
      s.gravitation = environment::zonal_gravity(position, flight.zonal);
      break;
    }
  }
  return s;
}

struct Air {
  environment::AirState state;
  Vec3d velocity;  // of the body through it, inertial axes
  Vec3d drag;      // N
};

Air air(const FlightCase& flight, const Surroundings& s, Vec3d velocity) {
  Air a{};
  a.state = environment::standard_atmosphere(s.altitude);
  a.velocity = velocity - s.ground_velocity - math::rotate(s.ned, flight.wind_ned);
  a.drag = forces::quadratic_drag(a.state.density, flight.drag_coefficient, flight.reference_area, a.velocity);
  return a;
}

Status check(const FlightCase& flight) {
  const auto not_finite = [](const char* field) {
    return Error{core::text("flight: ", field, " is not finite, expected a number")};
  };
  if (!math::is_finite(flight.velocity_ned)) return not_finite("velocity_ned");
  if (!math::is_finite(flight.wind_ned)) return not_finite("wind_ned");
  if (!math::is_finite(flight.body_rates)) return not_finite("body_rates");
  const struct {
    const char* name;
    double value, low, high;
  } ranges[] = {{"gravity", flight.gravity, 0, 1e6},
                {"gm", flight.gm, 0, 1e30},
                {"radius", flight.radius, 1, 1e15},
                {"place.latitude", flight.place.latitude, -0.5 * math::pi, 0.5 * math::pi},
                {"place.longitude", flight.place.longitude, -4 * math::pi, 4 * math::pi},
                {"place.altitude", flight.place.altitude, -5000, 1e10},
                {"angles.yaw", flight.angles.yaw, -1e6, 1e6},
                {"angles.pitch", flight.angles.pitch, -1e6, 1e6},
                {"angles.roll", flight.angles.roll, -1e6, 1e6},
                {"drag_coefficient", flight.drag_coefficient, 0, 1e6},
                {"reference_area", flight.reference_area, 0, 1e12},
                {"dt", flight.dt, 1e-9, 1e6},
                {"duration", flight.duration, 0, 1e12},
                {"output_interval", flight.output_interval, 0, 1e12},
                {"ellipsoid.equatorial_radius", flight.ellipsoid.equatorial_radius, 1, 1e15},
                {"ellipsoid.flattening", flight.ellipsoid.flattening, 0, 0.99},
                {"ellipsoid.rotation_rate", flight.ellipsoid.rotation_rate, -1e3, 1e3},
                {"zonal.gm", flight.zonal.gm, 0, 1e30},
                {"zonal.radius", flight.zonal.radius, 0, 1e15},
                {"zonal.j2", flight.zonal.j2, -1, 1}};
  for (const auto& range : ranges)
    if (!(range.value >= range.low && range.value <= range.high))
      return Error{core::refused(core::text("flight: ", range.name), range.value,
                                 core::text("a number from ", range.low, " to ", range.high))};
  if (flight.duration / flight.dt > 1e9)
    return Error{
        core::refused("flight: duration", flight.duration, core::text("at most 1e9 steps of ", flight.dt, " s"))};
  return {};
}

FreeBodyState start(const FlightCase& flight) {
  FreeBodyState state;
  const Quatd local = to_attitude(flight.angles);
  state.angular_velocity = flight.body_rates;
  if (flight.world == FlightWorld::flat) {
    state.position = {0, 0, -flight.place.altitude};
    state.velocity = flight.velocity_ned;
    state.attitude = local;
    return state;
  }
  environment::Ellipsoid shape = flight.ellipsoid;
  if (flight.world == FlightWorld::round) shape = {flight.radius, 0, 0};
  state.position = environment::to_cartesian(flight.place, shape);
  const Quatd ned = ned_attitude(flight.place.latitude, flight.place.longitude);
  state.velocity =
      math::rotate(ned, flight.velocity_ned) + math::cross(Vec3d{0, 0, shape.rotation_rate}, state.position);
  state.attitude = math::normalize(ned * local);
  return state;
}

FlightRow make_row(const FlightCase& flight, const FreeBody& body, double time, const FreeBodyState& state) {
  const Surroundings s = surroundings(flight, time, state.position);
  const Air a = air(flight, s, state.velocity);
  FlightRow row;
  row.time = time;
  row.altitude = s.altitude;
  row.latitude = s.latitude;
  row.longitude = s.longitude;
  row.velocity_ned = math::inverse_rotate(s.ned, state.velocity - s.ground_velocity);
  row.body_rates = state.angular_velocity;
  row.angles = to_flight_angles(math::conjugate(s.ned) * state.attitude);
  row.speed_of_sound = a.state.speed_of_sound;
  row.density = a.state.density;
  row.mach = math::length(a.velocity) / a.state.speed_of_sound;
  row.drag = math::length(a.drag);
  row.drag_body = math::inverse_rotate(state.attitude, a.drag);
  row.gravity = math::length(s.gravitation);
  row.twice_rotational_energy = twice_rotational_energy(body, state);
  row.angular_momentum = math::length(angular_momentum(body, state));
  row.state = state;
  return row;
}

}  // namespace free_body_detail

Status simulate(const FlightCase& flight, core::FunctionRef<void(const FlightRow&)> row) {
  namespace detail = free_body_detail;
  if (Status status = detail::check(flight); !status.ok()) return status;
  const Result<FreeBody> made = make_free_body(flight.mass, flight.inertia);
  if (!made.ok()) return Error{core::text("flight: ", made.error().message)};
  const FreeBody& body = *made;
  FreeBodyState state = detail::start(flight);
  const bool drags = flight.drag_coefficient > 0 && flight.reference_area > 0;
  const auto load = [&](double time, const FreeBodyState& y) {
    const detail::Surroundings s = detail::surroundings(flight, time, y.position);
    FreeBodyLoad result{body.mass * s.gravitation, {}};
    if (drags) result.force += detail::air(flight, s, y.velocity).drag;
    return result;
  };
  const auto whole_steps = [&](double seconds) {
    return std::int64_t(math::round(math::min(seconds / flight.dt, 2e9)));
  };
  const std::int64_t steps = whole_steps(flight.duration);
  const std::int64_t interval = math::max(std::int64_t{1}, whole_steps(flight.output_interval));
  row(detail::make_row(flight, body, 0, state));
  for (std::int64_t i = 0; i < steps; ++i) {
    const double time = double(i) * flight.dt;
    const ode::Outcome outcome = step(flight.method, body, load, time, state, flight.dt);
    if (outcome != ode::Outcome::done)
      return Error{core::text("flight: the integrator ", ode::to_string(flight.method), " at t = ", time, " s ",
                              ode::to_string(outcome))};
    if (!math::is_finite(state.position) || !math::is_finite(state.velocity) ||
        !math::is_finite(state.angular_velocity) || !math::is_finite(state.attitude))
      return Error{core::text("flight: the state is not finite after t = ", time, " s; take a shorter dt than ",
                              flight.dt, " s")};
    if ((i + 1) % interval == 0 || i + 1 == steps)
      row(detail::make_row(flight, body, double(i + 1) * flight.dt, state));
  }
  return {};
}

}  // namespace carom::rigid
