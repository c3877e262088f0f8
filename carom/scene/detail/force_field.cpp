#include "carom/scene/detail/force_field.h"

#include <algorithm>
#include <memory>

#include "carom/core/spelling.h"

namespace carom::scene::detail {
namespace {

/// What a formula may name beside the parameters of the scene.
struct Known {
  std::string_view name;
  Measure measure;
};
constexpr Known known[] = {{"x", Measure::length}, {"y", Measure::length}, {"z", Measure::length},
                           {"vx", Measure::speed}, {"vy", Measure::speed}, {"vz", Measure::speed},
                           {"t", Measure::time},   {"m", Measure::mass}};
constexpr std::size_t known_count = std::size(known);

struct Formula {
  Expression expression;
  std::vector<int> from;       // of each name: an index into `known`, or −1 for a parameter
  std::vector<double> values;  // of the parameters
  bool acceleration = false;
  static constexpr std::size_t most_names = 32;
  double at(const double (&state)[known_count]) const {
    double now[most_names];
    for (std::size_t i = 0; i < from.size(); ++i) now[i] = from[i] >= 0 ? state[from[i]] : values[i];
    const double value = evaluate_expression(expression, {now, from.size()});
    return math::is_finite(value) ? value * (acceleration ? state[7] : 1) : 0;
  }
};

bool is_same(const Dimension& a, Measure b) { return a == measure_dimension(b); }

/// False, and an error in the reader, where it cannot be.
bool read_formula(Reader& reader, const Node& node, const std::string& path, bool plane, Formula& out) {
  if (node.kind == NodeKind::number && node.number == 0) {
    out.expression = *parse_expression("0 N");
    return true;
  }
  if (!node.is_text()) {
    reader.expected(node, path, "a formula such as \"-k*x\"");
    return false;
  }
  const std::string_view text = node.text.starts_with('=') ? std::string_view(node.text).substr(1) : node.text;
  auto parsed = parse_expression(text);
  if (!parsed) {
    reader.fail(node, path, "found " + show(node) + ": " + parsed.error().message);
    return false;
  }
  out.expression = std::move(*parsed);
  if (out.expression.names.size() > Formula::most_names) {
    reader.fail(node, path, "found more than 32 names in a formula");
    return false;
  }
  std::vector<Dimension> dimensions;
  for (const std::string& name : out.expression.names) {
    int index = -1;
    for (std::size_t i = 0; i < known_count; ++i)
      if (known[i].name == name && !(plane && name.find('z') != std::string::npos)) index = int(i);
    const Reader::Variable* parameter = nullptr;
    for (const Reader::Variable& v : reader.variables)
      if (v.name == name) parameter = &v;
    if (index < 0 && parameter == nullptr) {
      std::vector<std::string_view> names;
      for (const Known& k : known) names.push_back(k.name);
      for (const Reader::Variable& v : reader.variables) names.push_back(v.name);
      reader.fail(node, path,
                  "found the name " + quote(name) +
                      ", expected x, y, z, vx, vy, vz, t, m (of the body) or a parameter" +
                      core::did_you_mean(name, names));
      return false;
    }
    out.from.push_back(index);
    out.values.push_back(index < 0 ? parameter->value : 0);
    dimensions.push_back(index < 0 ? parameter->dimension : measure_dimension(known[index].measure));
  }
  const auto dimension = check_expression(out.expression, dimensions);
  if (!dimension) {
    reader.fail(node, path, "found " + show(node) + ": " + dimension.error().message);
    return false;
  }
  out.acceleration = is_same(*dimension, Measure::acceleration);
  if (!out.acceleration && !is_same(*dimension, Measure::force)) {
    reader.fail(node, path,
                "found " + show(node) + ", which is " + describe_dimension(*dimension) +
                    ", expected a force or an acceleration");
    return false;
  }
  return true;
}

}  // namespace

template <class D>
rigid::EffectorDef<D> read_force_field(Reader& reader, const Object& o, rigid::BodyId body) {
  constexpr bool plane = D::dimension == 2;
  const Node* const list = o.find("formula");
  const std::string path = o.path_of("formula");
  auto formulas = std::make_shared<std::vector<Formula>>(D::dimension);
  if (list == nullptr || !list->is_array() || list->children.size() != std::size_t(D::dimension)) {
    reader.expected(list != nullptr ? *list : *o.node, path,
                    plane ? "two formulas, as [\"-k*x\", \"0 N\"]" : "three formulas, as [\"-k*x\", \"0 N\", \"0 N\"]");
    return rigid::LinearDrag<D>{};
  }
  for (std::size_t i = 0; i < list->children.size(); ++i)
    if (!read_formula(reader, list->children[i], index_path(path, i), plane, (*formulas)[i]))
      return rigid::LinearDrag<D>{};
  rigid::CustomEffector<D> effector;
  effector.body = body;
  // Of the middle of the step, as other fields.
  const double half = 0.5 * reader.step;
  effector.model = [formulas, half](const rigid::EffectorInput<D>& input) {
    const auto& s = input.state;
    double state[known_count] = {};
    for (int i = 0; i < D::dimension; ++i) {
      state[3 + i] = double(s.linear_velocity[i]);
      state[i] = double(s.center_of_mass[i]) + half * state[3 + i];
    }
    state[6] = input.time + half;
    state[7] = double(s.mass);
    rigid::Wrench<D> wrench;
    for (int i = 0; i < D::dimension; ++i) wrench.force[i] = float((*formulas)[std::size_t(i)].at(state));
    return wrench;
  };
  return effector;
}

template rigid::EffectorDef<rigid::Dim2> read_force_field<rigid::Dim2>(Reader&, const Object&, rigid::BodyId);
template rigid::EffectorDef<rigid::Dim3> read_force_field<rigid::Dim3>(Reader&, const Object&, rigid::BodyId);

}  // namespace carom::scene::detail
