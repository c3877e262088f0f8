#include "carom/scene/scene.h"

#include <algorithm>
#include <cstdio>

#include "carom/core/spelling.h"
#include "carom/scene/detail/builder.h"
#include "carom/scene/detail/flight.h"
#include "carom/scene/detail/include.h"

namespace carom::scene {
namespace {
using detail::Node;
using detail::Object;
using detail::Quantity;
using detail::Reader;
using detail::tables;

constexpr double infinity = __builtin_inf();

/// The unit behind the number of "30 mph"; empty for a plain number or an expression.
std::string unit_of(const Node& node) {
  if (!node.is_text() || node.text.empty() || node.text[0] == '=' || node.text[0] == '$') return {};
  const std::string& t = node.text;
  std::size_t i = 0;
  while (i < t.size() &&
         ((t[i] >= '0' && t[i] <= '9') || t[i] == ' ' || t[i] == '.' || t[i] == '+' || t[i] == '-' || t[i] == '/' ||
          ((t[i] == 'e' || t[i] == 'E') && i > 0 && t[i - 1] >= '0' && t[i - 1] <= '9' && i + 1 < t.size() &&
           ((t[i + 1] >= '0' && t[i + 1] <= '9') || t[i + 1] == '-' || t[i + 1] == '+'))))
    ++i;
  return t.substr(i);
}

void read_parameter(Reader& reader, const Node& node, const std::string& name, Scene& scene,
                    std::vector<detail::Dimension>& dimensions) {
  const std::string path = "parameters." + name;
  Object o;
  if (!reader.open(node, path, *tables().parameter, o)) return;
  bool good = !name.empty() && !(name[0] >= '0' && name[0] <= '9');
  for (const char c : name)
    good = good && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_');
  if (!good)
    return reader.fail(node, path, "found the name " + detail::quote(name) + ", expected letters, digits and _");
  Parameter p;
  p.name = name;
  p.label = reader.text(o, "label", name);
  p.description = reader.text(o, "description");
  p.live = reader.flag(o, "live", false);
  const Quantity value = reader.any_value(*o.find("value"), o.path_of("value"));
  const auto bound = [&](const char* key) {
    if (!o.has(key)) return 0.0;
    const Quantity q = reader.any_value(*o.find(key), o.path_of(key));
    if (!reader.failed() && q.dimension != value.dimension)
      reader.expected(*o.find(key), o.path_of(key), detail::describe_dimension(value.dimension) + " like the value");
    return q.value;
  };
  p.value = value.value;
  p.minimum = bound("minimum");
  p.maximum = bound("maximum");
  p.step = o.has("step") ? bound("step") : (p.maximum - p.minimum) / 100;
  p.display_unit = o.has("unit") ? reader.text(o, "unit") : unit_of(*o.find("value"));
  if (reader.failed()) return;
  p.unit = detail::si_unit(value.dimension);
  const core::Result<Quantity> unit = detail::parse_unit(p.display_unit);
  if (!unit && o.has("unit")) return reader.fail(*o.find("unit"), o.path_of("unit"), unit.error().message);
  if (!unit)
    p.display_unit = p.unit;
  else
    p.display_scale = unit->value;
  if (unit && unit->dimension != value.dimension)
    return reader.expected(*o.find(o.has("unit") ? "unit" : "value"), o.path_of("unit"),
                           "a unit of " + detail::describe_dimension(value.dimension));
  if (!(p.minimum <= p.value && p.value <= p.maximum))
    return reader.expected(*o.find("value"), o.path_of("value"), "a value from minimum to maximum");
  if (!(p.step >= 0)) return reader.expected(*o.find("step"), o.path_of("step"), "a step of zero or more");
  for (std::size_t i = 0; i < scene.parameters.size(); ++i) {
    if (scene.parameters[i].name != name) continue;
    scene.parameters[i] = p;  // the scene itself overrides what it includes
    dimensions[i] = value.dimension;
    return;
  }
  scene.parameters.push_back(std::move(p));
  dimensions.push_back(value.dimension);
}

void read_parameters(Reader& reader, Scene& scene, detail::SceneDocument& document) {
  for (const Node& part : document.parts) {
    const Node* map = part.find("parameters");
    if (map == nullptr) continue;
    if (!map->is_object()) return reader.expected(*map, "parameters", "an object of names");
    for (std::size_t i = 0; i < map->keys.size(); ++i)
      read_parameter(reader, map->children[i], map->keys[i], scene, document.parameter_dimensions);
  }
}

void read_camera(Reader& reader, const Object& o, Scene& scene) {
  Object c;
  if (!o.has("camera") || !reader.open(*o.find("camera"), "camera", *tables().camera, c)) return;
  scene.camera.target = reader.vector(c, "target", scene.camera.target);
  if (scene.dimension == 3) {
    scene.camera.position = reader.vector(c, "position", scene.camera.position);
    scene.camera.field_of_view = reader.number(c, "field_of_view", scene.camera.field_of_view);
    if (!reader.failed() && !(scene.camera.field_of_view > 0.01 && scene.camera.field_of_view < 3.1))
      reader.expected(*c.find("field_of_view"), "camera.field_of_view", "an angle from 1 to 175 degrees");
  } else {
    scene.camera.height = reader.number(c, "height", scene.camera.height);
    if (!reader.failed() && !(scene.camera.height > 0))
      reader.expected(*c.find("height"), "camera.height", "a height above zero");
    scene.camera.width = reader.number(c, "width", 0);
    if (!reader.failed() && !(scene.camera.width >= 0))
      reader.expected(*c.find("width"), "camera.width", "a width above zero");
  }
  scene.camera.follow = reader.text(c, "follow");
}

void set_axis_unit(Reader& reader, const Object& a, Axis& axis, const std::string& si,
                   const detail::Dimension& dimension) {
  axis.unit = axis.display_unit = si;
  if (!a.node || !a.has("unit")) return;
  axis.display_unit = reader.text(a, "unit");
  const core::Result<Quantity> unit = detail::parse_unit(axis.display_unit);
  if (!unit) return reader.fail(*a.find("unit"), a.path_of("unit"), unit.error().message);
  if (unit->dimension != dimension)
    return reader.expected(*a.find("unit"), a.path_of("unit"), "a unit of " + detail::describe_dimension(dimension));
  axis.display_scale = unit->value;
}

void read_points(Reader& reader, const Object& s, const Plot& plot, Series& series) {
  const Node& list = *s.find("points");
  const std::string path = s.path_of("points");
  if (!list.is_array()) return reader.expected(list, path, "a list of [x, y]");
  for (std::size_t i = 0; i < list.children.size() && !reader.failed(); ++i) {
    const Node& pair = list.children[i];
    const std::string at = detail::index_path(path, i);
    if (!pair.is_array() || pair.children.size() != 2) return reader.expected(pair, at, "two numbers: [x, y]");
    // A plain number is in the axis' unit, as printed tables are; a text brings its own.
    const auto coordinate = [&](const Node& n, const Axis& axis, std::size_t k) {
      const Quantity q = reader.any_value(n, detail::index_path(at, k));
      return n.kind == detail::NodeKind::number ? q.value * axis.display_scale : q.value;
    };
    const double x = coordinate(pair.children[0], plot.x, 0);
    series.points.emplace_back(x, coordinate(pair.children[1], plot.y, 1));
  }
}

void read_plot(Reader& reader, const Node& node, const std::string& path, const SceneWorld& trial, Scene& scene) {
  Object o, x, y;
  if (!reader.open(node, path, *tables().plot, o)) return;
  Plot plot;
  plot.title = reader.text(o, "title");
  plot.interval = reader.number(o, "interval", 0);
  if (!reader.failed() && plot.interval < 0)
    return reader.expected(*o.find("interval"), o.path_of("interval"), "a time of zero or more");
  if (o.has("x") && !reader.open(*o.find("x"), o.path_of("x"), *tables().axis, x)) return;
  if (o.has("y") && !reader.open(*o.find("y"), o.path_of("y"), *tables().axis, y)) return;
  const auto probe = [&](const Node& at, const std::string& where, const std::string& text, std::string& unit) {
    const Result<Probe> p = trial.probe(text);
    if (!p) return reader.fail(at, where, "found " + detail::quote(text) + ": " + p.error().message);
    unit = p->unit;
  };
  std::string x_unit = "s", y_unit;
  if (x.node && x.has("quantity")) {
    plot.x_expression = reader.text(x, "quantity");
    if (!reader.failed()) probe(*x.find("quantity"), x.path_of("quantity"), plot.x_expression, x_unit);
  }
  plot.x.label = x.node ? reader.text(x, "label", plot.x_expression) : plot.x_expression;
  if (y.node) plot.y.label = reader.text(y, "label");
  const Node& list = *o.find("series");
  if (!list.is_array() || list.children.empty()) return reader.expected(list, o.path_of("series"), "a list of series");
  bool y_known = false;
  std::vector<Object> opened(list.children.size());
  for (std::size_t i = 0; i < list.children.size() && !reader.failed(); ++i) {
    Object& s = opened[i];
    if (!reader.open(list.children[i], detail::index_path(o.path_of("series"), i), *tables().series, s)) return;
    Series series;
    series.name = reader.text(s, "name");
    series.style = reader.choice(s, "style", s.has("points") ? 1 : 0) == 1 ? "points" : "line";
    if (s.has("quantity") == s.has("points"))
      return reader.fail(*s.node, s.path, "a series needs either the key \"quantity\" or \"points\"");
    if (s.has("quantity")) {
      series.expression = reader.text(s, "quantity");
      std::string unit;
      if (!reader.failed()) probe(*s.find("quantity"), s.path_of("quantity"), series.expression, unit);
      const auto same_dimension = [](const std::string& a, const std::string& b) {
        return detail::parse_unit(a).value_or(Quantity{}).dimension ==
               detail::parse_unit(b).value_or(Quantity{}).dimension;
      };
      if (y_known && !reader.failed() && !same_dimension(unit, y_unit))
        return reader.fail(*s.find("quantity"), s.path_of("quantity"),
                           "found a quantity in " + unit + " beside one in " + y_unit + " on one axis");
      y_unit = unit;
      y_known = true;
    }
    plot.series.push_back(std::move(series));
  }
  if (!y_known && y.node && y.has("unit")) y_unit = reader.text(y, "unit");
  if (reader.failed()) return;
  set_axis_unit(reader, x, plot.x, x_unit, detail::parse_unit(x_unit).value_or(Quantity{}).dimension);
  set_axis_unit(reader, y, plot.y, y_unit, detail::parse_unit(y_unit).value_or(Quantity{}).dimension);
  for (std::size_t i = 0; i < plot.series.size() && !reader.failed(); ++i)
    if (opened[i].has("points")) read_points(reader, opened[i], plot, plot.series[i]);
  scene.plots.push_back(std::move(plot));
}

void read_expectation(Reader& reader, const Node& node, const std::string& path, const SceneWorld& trial,
                      Scene& scene) {
  Object o;
  if (!reader.open(node, path, *tables().expectation, o)) return;
  Expectation e;
  e.time = reader.number(o, "time", -1);
  if (o.has("time") && !reader.failed() && !(e.time >= 0))
    return reader.expected(*o.find("time"), o.path_of("time"), "a time of zero or more");
  e.quantity = reader.text(o, "quantity");
  e.source = reader.text(o, "source");
  const Quantity expected = reader.any_value(*o.find("expected"), o.path_of("expected"));
  const Quantity tolerance = reader.any_value(*o.find("tolerance"), o.path_of("tolerance"));
  if (reader.failed()) return;
  const Result<Probe> probe = trial.probe(e.quantity);
  if (!probe)
    return reader.fail(*o.find("quantity"), o.path_of("quantity"),
                       "found " + detail::quote(e.quantity) + ": " + probe.error().message);
  const detail::Dimension due = detail::parse_unit(probe->unit).value_or(Quantity{}).dimension;
  const auto check = [&](const char* key, const Quantity& q) {
    if (q.dimension != due && o.find(key)->kind != detail::NodeKind::number)
      reader.expected(*o.find(key), o.path_of(key), detail::describe_dimension(due));
  };
  check("expected", expected);
  check("tolerance", tolerance);
  if (!reader.failed() && !(tolerance.value >= 0))
    reader.expected(*o.find("tolerance"), o.path_of("tolerance"), "a tolerance of zero or more");
  e.expected = expected.value;
  e.tolerance = tolerance.value;
  e.unit = e.display_unit = probe->unit;
  if (const std::string unit = unit_of(*o.find("expected")); !unit.empty()) {
    if (const core::Result<Quantity> scale = detail::parse_unit(unit); scale.ok()) {
      e.display_unit = unit;
      e.display_scale = scale->value;
    }
  }
  scene.expectations.push_back(std::move(e));
}

template <class Each>
void each_of(Reader& reader, const Object& o, const char* key, const Each& each) {
  const Node* list = o.find(key);
  if (list == nullptr) return;
  if (!list->is_array()) return reader.expected(*list, key, "a list");
  for (std::size_t i = 0; i < list->children.size() && !reader.failed(); ++i)
    each(list->children[i], detail::index_path(key, i));
}

bool read_declarations(Reader& reader, Scene& scene, detail::SceneDocument& document, Object& o) {
  const Node& root = document.main();
  if (!reader.open(root, "", *tables().scene, o)) return false;
  scene.kind = reader.choice(o, "kind", 0) == 1 ? Kind::flight : Kind::rigid;
  scene.dimension = reader.integer(o, "dimension", 3, 2, 3);
  reader.dimension = scene.dimension;
  // Keys of the other dimension are known only now that the dimension is.
  if (reader.failed() || !reader.open(root, "", *tables().scene, o)) return false;
  for (std::size_t i = 0; i + 1 < document.parts.size(); ++i) {
    Object part;
    if (!reader.open(document.parts[i], "", *tables().part, part)) return false;
  }
  scene.name = reader.text(o, "name", scene.file);
  scene.description = reader.text(o, "description");
  read_parameters(reader, scene, document);
  return !reader.failed();
}

}  // namespace

std::span<const SourceFile> Scene::sources() const {
  return document ? std::span<const SourceFile>(document->sources) : std::span<const SourceFile>();
}

Result<Scene> parse_scene(std::string_view text, std::string_view name, const Resolver& resolver,
                          const LoadOptions& options) {
  auto document = std::make_shared<detail::SceneDocument>();
  document->maximum_objects = options.maximum_objects;
  document->sources.push_back({std::string(name), std::string(text)});
  Resolver keeping;
  if (resolver)
    keeping = [&](std::string_view path) -> Result<std::string> {
      Result<std::string> found = resolver(path);
      const auto known = [&](const SourceFile& one) { return one.name == path; };
      if (found.ok() && std::none_of(document->sources.begin() + 1, document->sources.end(), known))
        document->sources.push_back({std::string(path), *found});
      return found;
    };
  if (const Status read = detail::read_parts(*document, text, name, keeping); !read) return read.error();
  Scene scene;
  scene.file = std::string(name);
  Reader reader(*document);
  Object o;
  const bool declared = read_declarations(reader, scene, *document, o);
  scene.document = document;
  if (!declared) return reader.error();
  if (const Status set = detail::set_variables(reader, scene, {}); !set) return set.error();
  scene.step = reader.number(o, "step", scene.kind == Kind::flight ? 0.01 : 1.0 / 60);
  scene.duration = reader.number(o, "duration", scene.kind == Kind::flight ? 30 : 10);
  scene.loop = reader.flag(o, "loop", false);
  if (o.has("ground")) scene.ground = reader.number(o, "ground", 0);
  if (!reader.failed() && !(scene.step > 0 && scene.step <= 1)) {
    reader.expected(*o.find("step"), "step", "a time above zero and up to 1 s");
  }
  if (!reader.failed() && !(scene.duration >= 0 && scene.duration <= 1e9))
    reader.expected(*o.find("duration"), "duration", "a time from 0 to 1e9 s");
  read_camera(reader, o, scene);
  if (reader.failed()) return reader.error();

  // A trial world finds what is wrong with bodies, joints and effectors, and which quantities plots may name.
  Result<SceneWorld> trial = scene.instantiate();
  if (!trial) return trial.error();
  each_of(reader, o, "plots",
          [&](const Node& n, const std::string& path) { read_plot(reader, n, path, *trial, scene); });
  each_of(reader, o, "expectations",
          [&](const Node& n, const std::string& path) { read_expectation(reader, n, path, *trial, scene); });
  if (!reader.failed() && !scene.camera.follow.empty() && trial->find_body(scene.camera.follow) == nullptr) {
    std::vector<std::string_view> known;
    for (const SceneBody& b : trial->bodies) known.push_back(b.name);
    const Node& follow = *o.find("camera")->find("follow");
    reader.expected(follow, "camera.follow", "the name of a body", core::did_you_mean(scene.camera.follow, known));
  }
  if (reader.failed()) return reader.error();
  return scene;
}

Result<SceneWorld> Scene::instantiate(std::span<const ParameterValue> values, const InstantiateOptions& options) const {
  if (!document) return core::Error{"the scene was not loaded"};
  Reader reader(*document);
  reader.dimension = dimension;
  if (const Status set = detail::set_variables(reader, *this, values); !set) return set.error();
  SceneWorld out;
  const bool built = kind == Kind::flight ? detail::build_flight(reader, *this, out)
                                          : detail::build_world(reader, *this, options, out);
  if (!built || reader.failed()) return reader.error();
  if (!(out.dt > 0 && out.dt <= 1))
    return core::Error{file + ": step: found " + detail::shortest(out.dt) +
                       " s, expected a time above zero and up to 1 s"};
  return out;
}

Result<std::vector<Expectation>> Scene::expectations_for(const SceneWorld& world,
                                                         std::span<const ParameterValue> values) const {
  if (!document) return core::Error{"the scene was not loaded"};
  Reader reader(*document);
  reader.dimension = dimension;
  if (const Status set = detail::set_variables(reader, *this, values); !set) return set.error();
  Object o;
  Scene evaluated;
  if (reader.open(document->main(), "", *tables().scene, o)) {
    each_of(reader, o, "expectations",
            [&](const Node& n, const std::string& path) { read_expectation(reader, n, path, world, evaluated); });
  }
  if (reader.failed()) return reader.error();
  return std::move(evaluated.expectations);
}

Status Scene::apply(SceneWorld& world, std::span<const ParameterValue> values) const {
  if (!document || (!world.world2 && !world.world3)) return core::Error{"the scene has no running world of bodies"};
  Reader reader(*document);
  reader.dimension = dimension;
  if (const Status set = detail::set_variables(reader, *this, values); !set) return set;
  if (!detail::update_world(reader, *this, world)) return reader.error();
  return {};
}

Result<ParameterValue> Scene::parse_parameter(std::string_view text) const {
  const std::size_t equals = text.find('=');
  const std::string_view name = text.substr(0, equals);
  if (equals == std::string_view::npos)
    return core::Error{"found " + detail::quote(text) + ", expected name=value such as \"speed=30 mph\""};
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    known.push_back(p.name);
    if (p.name != name) continue;
    const std::string_view given = text.substr(equals + 1);
    core::Result<Quantity> q = detail::parse_quantity(given);
    if (!q) return core::Error{"parameter " + p.name + ": found " + detail::quote(given) + ": " + q.error().message};
    const bool plain = q->dimension == detail::Dimension{} && q->dimension.angle == 0;
    if (plain)
      q->value *= p.display_scale;  // a number alone is in the unit that people see
    else if (q->dimension != document->parameter_dimensions[i])
      return core::Error{"parameter " + p.name + ": found " + detail::quote(given) + ", expected " +
                         detail::describe_dimension(document->parameter_dimensions[i])};
    if (!(q->value >= p.minimum && q->value <= p.maximum)) {
      const std::string unit = p.display_unit.empty() ? "" : " " + p.display_unit;
      return core::Error{"parameter " + p.name + ": found " + detail::quote(given) + ", expected " +
                         detail::shortest(p.minimum / p.display_scale) + " to " +
                         detail::shortest(p.maximum / p.display_scale) + unit};
    }
    return ParameterValue{p.name, q->value};
  }
  return core::Error{"found no parameter " + detail::quote(name) + core::did_you_mean(name, known)};
}

}  // namespace carom::scene
