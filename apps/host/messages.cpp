#include "apps/host/messages.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "carom/carom.h"
#include "carom/math/units.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

std::string text_of(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json vector_json(math::Vec3d v) { return Json::array({v.x, v.y, v.z}); }
Json points_json(const std::vector<math::Vec2f>& points) {
  Json out = Json::array();
  for (const math::Vec2f p : points) out.push_back({p.x, p.y});
  return out;
}

Json summary_json(const Declaration& d) {
  return {{"id", d.id},       {"title", d.title},     {"summary", d.summary},
          {"group", d.group}, {"chapter", d.chapter}, {"dimension", d.dimension}};
}

// shown = SI · factor + offset, so that a page needs no table of units. Units that cannot be read are shown in SI.
struct DisplayScale {
  double factor = 1, offset = 0;
};
DisplayScale display_scale(const std::string& unit) {
  const math::QuantityResult zero = math::parse_quantity("0 " + unit), one = math::parse_quantity("1 " + unit);
  if (unit.empty() || !zero.ok || !one.ok || one.si == zero.si) return {};
  const double factor = 1 / (one.si - zero.si);
  return {factor, -zero.si * factor};
}

Json parameter_json(const Parameter& p) {
  const DisplayScale display = display_scale(p.display_unit);
  Json json = {{"name", p.name},
               {"label", p.label},
               {"unit", p.unit},
               {"display_unit", p.display_unit.empty() ? p.unit : p.display_unit},
               {"display_factor", display.factor},
               {"display_offset", display.offset},
               {"description", p.description},
               {"minimum", p.minimum},
               {"maximum", p.maximum},
               {"step", p.step},
               {"value", p.value},
               {"live", p.live}};
  if (!p.choices.empty()) json["choices"] = p.choices;
  return json;
}

std::string color_text(std::uint32_t rgb) {
  char text[8];
  std::snprintf(text, sizeof text, "#%06x", unsigned(rgb & 0xffffff));
  return text;
}

Json plot_json(const Plot& plot) {
  Json series = Json::array();
  for (const Series& s : plot.series) {
    Json entry = {{"name", s.name}, {"style", s.style == Series::Style::line ? "line" : "points"}};
    if (s.color) entry["color"] = color_text(s.color);
    if (s.latest) entry["latest"] = true;
    if (!s.points.empty()) {
      Json points = Json::array();
      for (const Vec2d p : s.points) points.push_back({p.x, p.y});
      entry["points"] = std::move(points);
    }
    series.push_back(std::move(entry));
  }
  return {{"title", plot.title},
          {"x", {{"label", plot.x.label}, {"unit", plot.x.unit}}},
          {"y", {{"label", plot.y.label}, {"unit", plot.y.unit}}},
          {"series", std::move(series)}};
}

Json declaration_fields(const Declaration& d) {
  Json camera = {{"position", vector_json(d.camera.position)}, {"target", vector_json(d.camera.target)}};
  if (d.dimension == 2) {
    camera["height"] = d.camera.height;
  } else {
    camera["field_of_view"] = d.camera.field_of_view;
  }
  if (d.camera.width > 0) camera["width"] = d.camera.width;
  if (d.camera.follow >= 0) camera["follow"] = d.camera.follow;
  Json parameters = Json::array(), plots = Json::array(), inputs = Json::array();
  for (const Parameter& p : d.parameters) parameters.push_back(parameter_json(p));
  for (const Plot& p : d.plots) plots.push_back(plot_json(p));
  for (const Input& i : d.inputs)
    inputs.push_back({{"action", i.action},
                      {"label", i.label},
                      {"keys", i.keys},
                      {"kind", i.press ? "press" : "hold"},
                      {"value", i.value}});
  return {{"demo", d.id},
          {"title", d.title},
          {"summary", d.summary},
          {"group", d.group},
          {"chapter", d.chapter},
          {"text", d.text},
          {"dimension", d.dimension},
          {"dt", d.dt},
          {"camera", std::move(camera)},
          {"parameters", std::move(parameters)},
          {"plots", std::move(plots)},
          {"inputs", std::move(inputs)}};
}

Json shape_json(const ShapeView& s) {
  const math::Transform3f& t = s.local;
  Json out = {{"kind", name_of(s.kind)}, {"local", {t.p.x, t.p.y, t.p.z, t.q.w, t.q.x, t.q.y, t.q.z}}};
  if (s.sensor) out["sensor"] = true;
  if (s.look) {
    out["color"] = color_text(s.look);
    out["opacity"] = float(s.look >> 24) / 255.0f;
  }
  switch (s.kind) {
    case ShapeKind::sphere:
    case ShapeKind::circle:
      out["radius"] = s.radius;
      break;
    case ShapeKind::capsule:
      out["radius"] = s.radius;
      out["half_length"] = s.size.y;
      break;
    case ShapeKind::ellipsoid:
      out["radii"] = {s.size.x, s.size.y, s.size.z};
      break;
    case ShapeKind::box:
      out["half_extents"] = {s.size.x, s.size.y, s.size.z};
      out["radius"] = s.radius;
      break;
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      if (s.size.x > 0) out["rounding"] = s.size.x;
      out["radius"] = s.radius;
      out["half_height"] = s.size.y;
      break;
    case ShapeKind::plane:
      out["normal"] = {s.size.x, s.size.y, s.size.z};
      break;
    case ShapeKind::mesh:
      out["mesh"] = s.mesh;
      break;
    case ShapeKind::polygon:
      out["points"] = points_json(s.points);
      out["radius"] = s.radius;
      break;
    case ShapeKind::segment:
      out["points"] = points_json(s.points);
      break;
    case ShapeKind::chain:
      out["points"] = points_json(s.points);
      out["loop"] = s.loop;
      break;
  }
  return out;
}

Json body_json(const BodyView& body) {
  constexpr const char* types[] = {"fixed", "kinematic", "dynamic"};
  Json shapes = Json::array();
  for (const ShapeView& shape : body.shapes) shapes.push_back(shape_json(shape));
  Json out = {{"id", body.id},
              {"name", body.name},
              {"type", types[int(body.type)]},
              {"position", vector_json(body.position)},
              {"rotation", {body.rotation.w, body.rotation.x, body.rotation.y, body.rotation.z}},
              {"shapes", std::move(shapes)}};
  if (body.color) out["color"] = color_text(body.color);
  return out;
}

Json bodies_json(std::span<const BodyView> bodies) {
  Json out = Json::array();
  for (const BodyView& body : bodies) out.push_back(body_json(body));
  return out;
}

}  // namespace

std::string menu_json(std::span<const Declaration> demos) {
  Json list = Json::array();
  for (const Declaration& demo : demos) list.push_back(summary_json(demo));
  return text_of(list);
}

std::string welcome_message(const char* engine, std::string_view menu) {
  Json layers = Json::array();
  for (const DebugLayer& layer : debug_layers)
    layers.push_back({{"name", layer.name}, {"label", layer.label}, {"legend", layer.legend}});
  std::string text = text_of({{"type", "welcome"},
                              {"layers", std::move(layers)},
                              {"protocol", protocol_version},
                              {"version", CAROM_VERSION_STRING},
                              {"engine", engine}});
  text.back() = ',';  // the list of demos is text already
  return text + "\"demos\":" + std::string(menu) + "}";
}

std::string opened_message(const Declaration& declaration) {
  Json out = declaration_fields(declaration);
  out["type"] = "opened";
  return text_of(out);
}

std::string declaration_json(const Declaration& declaration, int indent) {
  Json out = declaration_fields(declaration);
  out["duration"] = declaration.duration;
  return text_of(out, indent);
}

std::string scene_message(const Declaration& declaration, std::span<const BodyView> bodies) {
  Json out = {{"type", "scene"}, {"bodies", bodies_json(bodies)}};
  if (declaration.ground) out["ground"] = {{"level", *declaration.ground}};
  return text_of(out);
}

std::string bodies_message(std::span<const BodyView> added, std::span<const std::uint32_t> removed) {
  return text_of({{"type", "bodies"},
                  {"add", bodies_json(added)},
                  {"remove", std::vector<std::uint32_t>(removed.begin(), removed.end())}});
}

std::string grabbed_message(std::int64_t pointer, const GrabAnswer& answer) {
  return text_of(
      {{"type", "grabbed"}, {"pointer", pointer}, {"body", answer.body}, {"point", vector_json(answer.point)}});
}

std::string values_message(const Declaration& declaration, std::span<const double> values) {
  Json list = Json::object();
  for (std::size_t i = 0; i < declaration.parameters.size() && i < values.size(); ++i)
    list[declaration.parameters[i].name] = values[i];
  return text_of({{"type", "values"}, {"values", std::move(list)}});
}

std::string numbers_message(const NumbersFields& f) {
  Json legend = Json::array();
  for (const LegendEntry& entry : f.legend)
    legend.push_back({{"label", entry.label}, {"color", color_text(entry.color)}});
  const rigid::StepProfile& p = f.profile;
  return text_of(
      {{"type", "numbers"},
       {"stages",
        {{"effectors", p.effectors},
         {"broad phase", p.broad_phase},
         {"narrow phase", p.narrow_phase},
         {"prepare", p.prepare},
         {"solve", p.solve},
         {"restitution", p.restitution},
         {"finalize", p.finalize},
         {"continuous", p.continuous},
         {"sensors", p.sensors},
         {"sleep", p.sleep},
         {"whole step", p.total}}},
       {"mass", f.budget.mass},
       {"momentum", vector_json(f.budget.momentum)},
       {"angular_momentum", vector_json(f.budget.angular_momentum)},
       {"joint_error", f.worst_joint_error},
       {"hand_force", f.hand_force},
       {"bytes", f.bytes},
       {"legend", std::move(legend)},
       {"arrows", {{"velocity", f.arrows.velocity}, {"force", f.arrows.force}, {"impulse", f.arrows.impulse}}}});
}

std::string probed_message(std::string_view kind, const ProbeAnswer& answer) {
  return text_of({{"type", "probed"},
                  {"kind", std::string(kind)},
                  {"body", answer.body},
                  {"point", vector_json(answer.point)},
                  {"normal", vector_json(answer.normal)},
                  {"distance", answer.distance}});
}

std::string inspected_message(std::string_view report) {
  if (report.empty()) return text_of({{"type", "inspected"}, {"body", -1}});
  return "{\"type\":\"inspected\"," + std::string(report.substr(1));
}

std::string verified_message(const ReplayReport& report) {
  Json out = {{"type", "verified"},      {"done", report.done},     {"equal", report.equal()},
              {"step", report.step},     {"first", report.first},   {"last", report.last},
              {"frames", report.frames}, {"hashes", report.hashes}, {"message", report.text()}};
  if (report.difference) out["differs"] = report.difference->step;
  return text_of(out);
}

std::string source_message(std::string_view name, std::string_view text, bool written) {
  Json out = {{"type", "source"}, {"name", std::string(name)}, {"text", std::string(text)}};
  if (written) out["written"] = true;
  return text_of(out);
}

std::string error_message(std::string_view message) {
  return text_of({{"type", "error"}, {"message", std::string(message)}});
}

std::string status_message(const StatusFields& fields) {
  Json out = {{"type", "status"},    {"running", fields.running},    {"speed", fields.speed},
              {"time", fields.time}, {"step", fields.step},          {"first", fields.first},
              {"last", fields.last}, {"recording", fields.recording}};
  if (fields.playing) out["playing"] = true;
  if (!fields.message.empty()) out["message"] = std::string(fields.message);
  return text_of(out);
}

}  // namespace carom::host
