#include "carom/scene/detail/projectile.h"

#include "carom/ballistics/body_flight.h"

namespace carom::scene::detail {

template <class D>
rigid::EffectorDef<D> read_projectile(Reader& reader, const Object& o, rigid::BodyId body) {
  ballistics::BodyFlight flight;
  flight.dt = reader.step;
  const auto missing = [&](std::string_view what) { reader.fail(*o.node, o.path, what); };
  if (!o.has("body")) missing("the key \"body\" is missing in a projectile");
  // Gravity as a world's by default; what a scene's world pulls with the effector leaves alone.
  flight.own_air = o.has("density");
  flight.own_wind = o.has("velocity");
  flight.conditions.wind = environment::WindColumn(reader.vector(o, "velocity"));
  if (o.has("density")) flight.conditions.air = environment::AirColumn::uniform(reader.number(o, "density", 1.225));
  if (o.has("latitude"))
    flight.conditions.rotation =
        ballistics::earth_rotation_rate(reader.number(o, "latitude", 0), reader.number(o, "bearing", 0));
  ballistics::DragCurve drag(reader.number(o, "drag_coefficient", 0.47));
  if (o.has("drag_function"))
    drag = ballistics::DragCurve(ballistics::DragFunction(reader.choice(o, "drag_function", 0)));
  if (o.has("table")) {
    if (o.has("drag_function") || o.has("drag_coefficient"))
      missing("a projectile has one of \"table\", \"drag_function\" and \"drag_coefficient\"");
    const std::vector<double> table = reader.numbers(o, "table");
    if (!reader.failed() && (table.empty() || table.size() % 2 != 0))
      reader.expected(*o.find("table"), o.path_of("table"), "pairs of Mach number and C_d, one after another");
    std::vector<ballistics::DragPoint> points;
    for (std::size_t i = 0; i + 1 < table.size(); i += 2) points.push_back({table[i], table[i + 1]});
    if (!reader.failed()) {
      auto curve = ballistics::DragCurve::from_points(points);
      if (curve)
        drag = std::move(*curve);
      else
        reader.fail(*o.find("table"), o.path_of("table"), curve.error().message);
    }
  }
  const double form = reader.number(o, "form_factor", 1);
  if (!(form > 0)) reader.expected(*o.find("form_factor"), o.path_of("form_factor"), "a number above zero");
  if (o.has("ballistic_coefficient")) {
    const double coefficient = reader.number(o, "ballistic_coefficient", 1);
    if (!o.has("drag_function")) missing("the key \"drag_function\" is missing beside a ballistic coefficient");
    if (!(coefficient > 0))
      reader.expected(*o.find("ballistic_coefficient"), o.path_of("ballistic_coefficient"), "a number above zero");
    flight.projectile = ballistics::projectile_from_coefficient(ballistics::DragFunction::g1, coefficient);
    flight.projectile.drag = drag;
    flight.projectile.area_per_mass *= form;
  } else {
    const double mass = reader.number(o, "mass", 0), diameter = reader.number(o, "diameter", 0);
    if (!(mass > 0 && diameter > 0))
      missing("a projectile has a \"ballistic_coefficient\", or a \"diameter\" and a \"mass\" above zero");
    else
      flight.projectile = ballistics::projectile_from_size(drag, mass, diameter, form);
  }
  if (reader.failed()) return rigid::LinearDrag<D>{};
  auto effector = ballistics::flight_effector<D>(body, flight);
  if (effector.ok()) return std::move(effector).value();
  missing(effector.error().message);
  return rigid::LinearDrag<D>{};
}

template rigid::EffectorDef<rigid::Dim2> read_projectile<rigid::Dim2>(Reader&, const Object&, rigid::BodyId);
template rigid::EffectorDef<rigid::Dim3> read_projectile<rigid::Dim3>(Reader&, const Object&, rigid::BodyId);

}  // namespace carom::scene::detail
