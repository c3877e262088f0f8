#include "carom/core/string.h"
#include "carom/scene/detail/destruction.h"
#include "carom/scene/detail/destruction_fields.h"

namespace carom::scene::detail {
namespace {

/// A number that cannot be below zero; `positive`: nor zero, and it must be there.
double size(Reader& r, const Object& o, const char* key, double fallback, bool positive = false) {
  if (positive && !o.has(key)) return r.fail(*o.node, o.path, core::text("the key \"", key, "\" is missing")), 0;
  const double x = r.number(o, key, fallback);
  if (!r.failed() && o.has(key) && !(x >= 0 && math::is_finite(x) && !(positive && x == 0)))
    r.expected(*o.find(key), o.path_of(key), positive ? "a number above zero" : "a number of zero or more");
  return x;
}

ballistics::Motor read_motor(Reader& r, const Object& o) {
  ballistics::Motor motor;
  motor.name = r.text(o, "name");
  motor.mass = size(r, o, "mass", 0, true);
  motor.propellant_mass = size(r, o, "propellant_mass", 0);
  const std::vector<double> numbers = r.numbers(o, "thrust");
  if (r.failed()) return motor;
  if (motor.propellant_mass > motor.mass) {
    r.expected(*o.find("propellant_mass"), o.path_of("propellant_mass"), "no more than the motor's mass");
    return motor;
  }
  std::vector<ballistics::ThrustPoint> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
  if (points.empty() || numbers.size() % 2 != 0) {
    r.expected(*o.find("thrust"), o.path_of("thrust"), "pairs of time and thrust, one after another");
    return motor;
  }
  auto curve = ballistics::ThrustCurve::from_points(std::move(points));
  if (curve.ok())
    motor.curve = std::move(*curve);
  else
    r.fail(*o.find("thrust"), o.path_of("thrust"), curve.error().message);
  return motor;
}

/// C_D at every speed, or by Mach number.
ballistics::DragCurve read_drag(Reader& r, const Object& o, const char* number, const char* table,
                                ballistics::DragCurve otherwise) {
  if (!o.has(table)) return o.has(number) ? ballistics::DragCurve(size(r, o, number, 0)) : otherwise;
  if (o.has(number))
    r.fail(*o.find(table), o.path_of(table), core::text("found it beside ", number, ", expected one of them"));
  const std::vector<double> numbers = r.numbers(o, table);
  if (r.failed()) return otherwise;
  std::vector<ballistics::DragPoint> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
  if (points.empty() || numbers.size() % 2 != 0) {
    r.expected(*o.find(table), o.path_of(table), "pairs of Mach number and C_D, one after another");
    return otherwise;
  }
  auto curve = ballistics::DragCurve::from_points(points);
  if (!curve) return r.fail(*o.find(table), o.path_of(table), curve.error().message), otherwise;
  return std::move(*curve);
}

ballistics::Rocket read_rocket_itself(Reader& r, const Object& o) {
  ballistics::Rocket rocket;
  rocket.diameter = size(r, o, "diameter", 0, true);
  rocket.length = size(r, o, "length", 0, true);
  rocket.nose_length = size(r, o, "nose_length", 0);
  rocket.drag = read_drag(r, o, "drag_coefficient", "drag_table", ballistics::DragCurve(0.5));
  rocket.coasting_drag = read_drag(r, o, "coasting_drag_coefficient", "coasting_drag_table", rocket.drag);
  rocket.fins.count = r.integer(o, "fin_count", 0, 0, 16);
  rocket.fins.root_chord = size(r, o, "fin_root_chord", rocket.fins.root_chord);
  rocket.fins.tip_chord = size(r, o, "fin_tip_chord", rocket.fins.tip_chord);
  rocket.fins.span = size(r, o, "fin_span", rocket.fins.span);
  rocket.fins.sweep = size(r, o, "fin_sweep", rocket.fins.sweep);
  rocket.fins.position = size(r, o, "fin_position", rocket.fins.position);
  rocket.parachute.drag_area = size(r, o, "parachute_drag_area", 0);
  rocket.parachute.deploy_height = size(r, o, "parachute_height", rocket.parachute.deploy_height);
  rocket.parachute.deploy_delay = size(r, o, "parachute_delay", 0);
  const auto stage = [&](const Object& s) {
    Object motor;
    if (!r.open(*s.find("motor"), s.path_of("motor"), rocket_motor_kind, motor)) return;
    ballistics::Stage read;
    read.motor = read_motor(r, motor);
    read.dry_mass = size(r, s, "dry_mass", 0, true);
    read.dry_centre = size(r, s, "dry_centre", 0.5 * rocket.length);
    read.motor_centre = size(r, s, "motor_centre", 0.9 * rocket.length);
    read.ignition_delay = size(r, s, "ignition_delay", 0);
    read.separation_delay = size(r, s, "separation_delay", 0);
    rocket.stages.push_back(std::move(read));
  };
  const Node* const list = o.find("stages");
  if (!r.failed() && (list == nullptr || !list->is_array() || list->children.empty() || list->children.size() > 10))
    r.expected(list != nullptr ? *list : *o.node, o.path_of("stages"), "a list of 1 to 10 stages");
  each_entry(r, o, "stages", stage_kind, stage);
  return rocket;
}

}  // namespace

ballistics::Conditions own_flight_conditions(math::Vec3d point, const rigid::World3& world,
                                             const std::shared_ptr<const environment::Environment>& around,
                                             bool turning) {
  ballistics::Conditions out = conditions_at(point, -double(world.definition().gravity.y), 3, around.get());
  if (!turning) out.rotation = {};
  if (around != nullptr && around->has_wind())
    out.field = [around](math::Vec3d place, double time) { return around->wind(place, time); };
  return out;
}

void read_rocket(DestructionPlace<rigid::Dim3>& place, const Object& o) {
  Reader& r = place.reader;
  std::string name;
  std::uint32_t color = 0;
  auto& list = place.out.of<rigid::Dim3>().rockets;
  if (!name_flying_body(place, o, "rocket", list, name, color)) return;
  ballistics::BodyRocketDef def;
  def.rocket = read_rocket_itself(r, o);
  def.launch.position = r.vector(o, "position");
  def.launch.direction = r.vector(o, "direction", {0, 1, 0});
  def.launch.rail_length = size(r, o, "rail_length", 1);
  def.start = size(r, o, "start", 0);
  const SurfaceDefaults surface = read_surface(r, place.library, o, {});
  const auto argb = r.color(o, "color");
  const bool trail = r.flag(o, "trail", false);
  if (r.failed()) return;
  if (!(math::length(def.launch.direction) > 1e-9))
    return r.expected(*o.find("direction"), o.path_of("direction"), "a direction that is not zero");
  def.shape.material = surface.material;
  def.shape.filter = surface.filter;
  def.conditions = own_flight_conditions(def.launch.position, place.world, place.around, false);
  def.name = name;
  auto made = ballistics::BodyRocket::make(place.world, def);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  place.scene.bodies.push_back({name, made->body(), argb.value_or(0), argb.has_value(), trail});
  list.push_back({std::move(name), color, std::move(*made)});
}

}  // namespace carom::scene::detail
