#include "carom/scene/detail/flight.h"

#include "carom/math/elementary.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {
namespace {
using rigid::FlightRow;

constexpr FlightField fields_of_flight[] = {
    {"time", "s", [](const FlightRow& r) { return r.time; }},
    {"altitude", "m", [](const FlightRow& r) { return r.altitude; }},
    {"latitude", "rad", [](const FlightRow& r) { return r.latitude; }},
    {"longitude", "rad", [](const FlightRow& r) { return r.longitude; }},
    {"velocity.north", "m/s", [](const FlightRow& r) { return r.velocity_ned.x; }},
    {"velocity.east", "m/s", [](const FlightRow& r) { return r.velocity_ned.y; }},
    {"velocity.down", "m/s", [](const FlightRow& r) { return r.velocity_ned.z; }},
    {"rate.p", "rad/s", [](const FlightRow& r) { return r.body_rates.x; }},
    {"rate.q", "rad/s", [](const FlightRow& r) { return r.body_rates.y; }},
    {"rate.r", "rad/s", [](const FlightRow& r) { return r.body_rates.z; }},
    {"yaw", "rad", [](const FlightRow& r) { return r.angles.yaw; }},
    {"pitch", "rad", [](const FlightRow& r) { return r.angles.pitch; }},
    {"roll", "rad", [](const FlightRow& r) { return r.angles.roll; }},
    {"mach", "", [](const FlightRow& r) { return r.mach; }},
    {"drag", "N", [](const FlightRow& r) { return r.drag; }},
    {"gravity", "m/s^2", [](const FlightRow& r) { return r.gravity; }},
    {"density", "kg/m^3", [](const FlightRow& r) { return r.density; }},
    {"speed_of_sound", "m/s", [](const FlightRow& r) { return r.speed_of_sound; }},
    {"twice_rotational_energy", "J", [](const FlightRow& r) { return r.twice_rotational_energy; }},
    {"angular_momentum", "kg*m^2/s", [](const FlightRow& r) { return r.angular_momentum; }},
};

math::Vec3d three(Reader& reader, const Object& o, const char* key) {
  if (!o.has(key)) return {};
  const std::vector<double> v = reader.numbers(o, key, 3);
  return {v[0], v[1], v[2]};
}

}  // namespace

std::span<const FlightField> flight_fields() { return fields_of_flight; }

bool build_flight(Reader& reader, const Scene& scene, SceneWorld& out) {
  reader.dimension = 3;
  Object root, flight, earth, vehicle, initial;
  if (!reader.open(scene.document->main(), "", *tables().scene, root)) return false;
  if (!root.has("flight"))
    return reader.fail(*root.node, "", "the key \"flight\" is missing in a scene of kind flight"), false;
  if (!reader.open(*root.find("flight"), "flight", *tables().flight, flight) ||
      !reader.open(*flight.find("earth"), "flight.earth", *tables().earth, earth) ||
      !reader.open(*flight.find("vehicle"), "flight.vehicle", *tables().vehicle, vehicle) ||
      !reader.open(*flight.find("initial"), "flight.initial", *tables().initial, initial))
    return false;
  out.kind = Kind::flight;
  out.dimension = 3;
  out.dt = reader.number(root, "step", 0.01);
  out.duration = reader.number(root, "duration", 30);
  out.flight = std::make_unique<Flight>();
  rigid::FlightCase& c = out.flight->definition;

  constexpr rigid::FlightWorld worlds[] = {rigid::FlightWorld::flat, rigid::FlightWorld::round,
                                           rigid::FlightWorld::earth};
  c.world = worlds[reader.choice(earth, "model", 0)];
  c.gm = reader.number(earth, "gm", c.gm);
  c.radius = reader.number(earth, "radius", c.radius);
  c.zonal.gm = c.gm;
  if (reader.choice(earth, "gravity", 0) == 1)
    c.gravity = 0;
  else
    c.gravity = reader.number(earth, "uniform_gravity", c.gravity);
  c.ellipsoid.rotation_rate = reader.number(earth, "rotation", c.ellipsoid.rotation_rate);
  if (c.world == rigid::FlightWorld::earth) {
    c.ellipsoid.equatorial_radius = reader.number(earth, "radius", c.ellipsoid.equatorial_radius);
    c.zonal.radius = c.ellipsoid.equatorial_radius;
    c.zonal.j2 = reader.number(earth, "j2", c.zonal.j2);
  }

  c.mass = reader.number(vehicle, "mass", 1);
  c.inertia = math::Mat3d::diagonal(three(reader, vehicle, "inertia"));
  c.drag_coefficient = reader.number(vehicle, "drag_coefficient", 0);
  c.reference_area = reader.number(vehicle, "reference_area", 0);

  c.place.latitude = reader.number(initial, "latitude", 0);
  c.place.longitude = reader.number(initial, "longitude", 0);
  c.place.altitude = reader.number(initial, "altitude", 0);
  c.velocity_ned = three(reader, initial, "velocity");
  c.angles.yaw = reader.number(initial, "yaw", 0);
  c.angles.pitch = reader.number(initial, "pitch", 0);
  c.angles.roll = reader.number(initial, "roll", 0);
  c.body_rates = three(reader, initial, "rates");
  const bool over_ground = reader.choice(initial, "rates_relative_to", 0) == 1;
  if (reader.failed()) return false;
  if (over_ground && c.world == rigid::FlightWorld::earth) {
    // The ground turns with the Earth: Ω in north-east-down, then in body axes.
    const math::SinCos<double> latitude = math::sincos(c.place.latitude);
    const math::Vec3d omega = math::Vec3d{latitude.cos, 0, -latitude.sin} * c.ellipsoid.rotation_rate;
    c.body_rates += math::inverse_rotate(rigid::to_attitude(c.angles), omega);
  }
  constexpr ode::Method methods[] = {ode::Method::rk4, ode::Method::heun, ode::Method::midpoint, ode::Method::euler,
                                     ode::Method::dormand_prince};
  c.method = methods[reader.choice(flight, "method", 0)];
  c.dt = out.dt;
  c.duration = out.duration;
  c.output_interval = out.dt;
  if (!(c.dt > 0) || !(c.duration >= 0) || !(c.duration / c.dt <= 1e6)) {
    reader.fail(
        *root.node, "step",
        "found " + shortest(c.duration) + " s in steps of " + shortest(c.dt) + " s, expected at most a million steps");
    return false;
  }
  std::vector<FlightRow>& rows = out.flight->rows;
  rows.reserve(std::size_t(c.duration / c.dt) + 3);
  const auto keep = [&rows](const FlightRow& row) { rows.push_back(row); };
  if (!reader.accept(rigid::simulate(c, keep), *flight.node, "flight")) return false;
  if (rows.empty()) return reader.fail(*flight.node, "flight", "the flight gave no state"), false;
  out.bodies.push_back({"vehicle"});
  return true;
}

}  // namespace carom::scene::detail
