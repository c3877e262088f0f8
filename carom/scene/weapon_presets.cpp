#include "carom/scene/weapon_presets.h"

#include "carom/ballistics/drag_data.h"
#include "carom/core/string.h"
#include "carom/scene/detail/preset_values.h"

namespace carom::scene {
namespace {

using detail::PresetValues;
using sports::NumberName;

/// The number of that name into `into`, where the file has it.
void take(const PresetValues& values, std::string_view name, double& into) { into = values.number(name, into); }

}  // namespace

core::Result<ballistics::Ammunition> parse_ammunition(std::string_view text, std::string_view file) {
  static constexpr NumberName names[] = {{"ballistic_coefficient", ""},
                                         {"drag_coefficient", ""},
                                         {"form_factor", ""},
                                         {"mass", "kg"},
                                         {"diameter", "m"},
                                         {"length", "m"},
                                         {"muzzle_speed", "m/s"},
                                         {"speed_deviation", "m/s"},
                                         {"powder_mass", "kg"},
                                         {"gas_speed", "m/s"}};
  static constexpr std::string_view texts[] = {"drag_function"}, lists[] = {"drag_table", "ballistic_coefficients"};
  const auto values = detail::read_preset(text, file, names, texts, lists);
  if (!values) return values.error();
  const auto error = [&](std::string_view where, const std::string& message) {
    return detail::preset_error(file, *values->root.find("values"), "values." + std::string(where), message);
  };
  for (const std::string_view needed : {"mass", "diameter", "muzzle_speed"})
    if (!values->has(needed)) return error(needed, "is missing");
  ballistics::Ammunition a;
  take(*values, "mass", a.mass);
  take(*values, "diameter", a.diameter);
  take(*values, "length", a.length);
  take(*values, "muzzle_speed", a.muzzle_speed);
  take(*values, "speed_deviation", a.speed_deviation);
  take(*values, "powder_mass", a.powder_mass);
  take(*values, "gas_speed", a.gas_speed);
  ballistics::DragData data;
  if (values->has("drag_function")) {
    data.function = ballistics::drag_function_from_name(values->text("drag_function"));
    if (!data.function)
      return error("drag_function", core::text("found ", core::quoted(values->text("drag_function")),
                                               ", expected g1, g2, g5, g6, g7, g8, gi, gs or ra4"));
  }
  if (values->has("drag_coefficient")) data.coefficient = values->number("drag_coefficient", 0);
  if (values->has("ballistic_coefficient")) data.ballistic_coefficient = values->number("ballistic_coefficient", 1);
  take(*values, "form_factor", data.form_factor);
  const auto pairs = [&](std::string_view name, auto& out) {
    const std::span<const double> numbers = values->list(name);
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) out.push_back({numbers[i], numbers[i + 1]});
    return numbers.size() % 2 == 0;
  };
  if (!pairs("drag_table", data.table)) return error("drag_table", "expected pairs, one after another");
  if (!pairs("ballistic_coefficients", data.bands))
    return error("ballistic_coefficients", "expected pairs, one after another");
  auto projectile = ballistics::projectile_from(data, a.mass, a.diameter);
  if (!projectile)
    return detail::preset_error(file, *values->root.find("values"), "values", projectile.error().message);
  a.projectile = std::move(projectile).value();
  if (auto s = ballistics::check(a); !s) return detail::in_file(file, s.error());
  return a;
}

core::Result<ballistics::Sight> parse_sight(std::string_view text, std::string_view file) {
  static constexpr NumberName names[] = {{"height", "m"}, {"click", "rad"}, {"spacing", "rad"}, {"magnification", ""}};
  const auto values = detail::read_preset(text, file, names, {});
  if (!values) return values.error();
  ballistics::Sight s;
  take(*values, "height", s.height);
  take(*values, "click", s.click);
  take(*values, "spacing", s.spacing);
  take(*values, "magnification", s.magnification);
  if (auto checked = ballistics::check(s); !checked) return detail::in_file(file, checked.error());
  return s;
}

core::Result<ballistics::Weapon> parse_gun(std::string_view text, std::string_view file,
                                           const PresetResolver& resolver) {
  static constexpr NumberName names[] = {{"mass", "kg"},
                                         {"muzzle_speed", "m/s"},
                                         {"twist", "m"},
                                         {"zero", "m"},
                                         {"dispersion", "rad"},
                                         {"rounds_per_minute", ""},
                                         {"mount_mass", "kg"},
                                         {"mount_inertia", "kg*m^2"},
                                         {"mount_bore_above_shoulder", "m"},
                                         {"mount_bore_beside_shoulder", "m"},
                                         {"mount_push_frequency", "Hz"},
                                         {"mount_push_damping", ""},
                                         {"mount_rise_frequency", "Hz"},
                                         {"mount_rise_damping", ""}};
  static constexpr std::string_view texts[] = {"ammunition", "sight"};
  const auto values = detail::read_preset(text, file, names, texts);
  if (!values) return values.error();
  const auto error = [&](std::string_view where, const std::string& message) {
    return detail::preset_error(file, *values->root.find("values"), "values." + std::string(where), message);
  };
  const auto preset = [&](std::string_view kind) -> core::Result<std::string> {
    const std::string_view name = values->text(kind);
    if (!detail::is_preset_name(name))
      return error(kind, core::text("found ", core::quoted(name), ", expected the name of a preset"));
    if (!resolver) return error(kind, "there is nobody to ask for presets");
    auto found = resolver(core::text("presets/", kind, "/", name, ".json"));
    if (!found) return error(kind, found.error().message);
    return found;
  };
  ballistics::Weapon w;
  const auto ammunition = preset("ammunition");
  if (!ammunition) return ammunition.error();
  auto round = parse_ammunition(*ammunition, core::text("presets/ammunition/", values->text("ammunition"), ".json"));
  if (!round) return error("ammunition", round.error().message);
  w.ammunition = *round;
  if (values->has("sight")) {
    const auto sight = preset("sight");
    if (!sight) return sight.error();
    const auto read = parse_sight(*sight, core::text("presets/sight/", values->text("sight"), ".json"));
    if (!read) return error("sight", read.error().message);
    w.sight = *read;
  }
  take(*values, "mass", w.mass);
  take(*values, "muzzle_speed", w.muzzle_speed);
  take(*values, "twist", w.twist);
  take(*values, "zero", w.zero);
  take(*values, "dispersion", w.dispersion);
  take(*values, "rounds_per_minute", w.rounds_per_minute);
  take(*values, "mount_mass", w.mount.mass);
  take(*values, "mount_inertia", w.mount.inertia);
  take(*values, "mount_bore_above_shoulder", w.mount.bore_above_shoulder);
  take(*values, "mount_bore_beside_shoulder", w.mount.bore_beside_shoulder);
  take(*values, "mount_push_frequency", w.mount.push_frequency);
  take(*values, "mount_push_damping", w.mount.push_damping);
  take(*values, "mount_rise_frequency", w.mount.rise_frequency);
  take(*values, "mount_rise_damping", w.mount.rise_damping);
  if (auto s = ballistics::check(w); !s) return detail::in_file(file, s.error());
  return w;
}

core::Result<ballistics::Shell> parse_shell(std::string_view text, std::string_view file) {
  const auto tree = detail::read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  const detail::Node& values = *tree->find("values");
  ballistics::Shell shell;
  struct Number {
    std::string_view name, unit;
    double* value;
  };
  const auto read = [&](const detail::Node& node, std::span<const Number> fields, std::string_view other,
                        const std::string& at) -> core::Status {
    if (!node.is_object())
      return detail::preset_error(file, node, at, "found " + detail::show(node) + ", expected an object");
    for (std::size_t k = 0; k < node.keys.size(); ++k) {
      const std::string where = core::text(at, ".", node.keys[k]);
      const Number* known = nullptr;
      for (const Number& field : fields)
        if (field.name == node.keys[k]) known = &field;
      if (known == nullptr && node.keys[k] == other) continue;
      if (known == nullptr)
        return detail::preset_error(file, node.children[k], where, "found a name that is not known here");
      const auto quantity = detail::read_preset_quantity(node.children[k], known->unit, file, where);
      if (!quantity) return quantity.error();
      *known->value = *quantity;
    }
    return {};
  };
  const Number whole[] = {{"mass", "kg", &shell.mass},
                          {"diameter", "m", &shell.diameter},
                          {"axial_inertia", "kg*m^2", &shell.axial_inertia},
                          {"transverse_inertia", "kg*m^2", &shell.transverse_inertia},
                          {"twist", "", &shell.twist}};
  if (const core::Status s = read(values, whole, "aerodynamics", "values"); !s) return s.error();
  for (const Number& field : whole)
    if (values.find(field.name) == nullptr)
      return detail::preset_error(file, values, core::text("values.", field.name), "is missing");
  const detail::Node* const rows = values.find("aerodynamics");
  if (rows == nullptr || !rows->is_array() || rows->children.empty() || rows->children.size() > 200)
    return detail::preset_error(file, rows != nullptr ? *rows : values, "values.aerodynamics",
                                "expected a list of 1 to 200 rows");
  for (std::size_t i = 0; i < rows->children.size(); ++i) {
    ballistics::ShellCoefficients row;
    const Number numbers[] = {{"mach", "", &row.mach},
                              {"axial", "", &row.axial},
                              {"axial_yaw", "", &row.axial_yaw},
                              {"normal", "", &row.normal},
                              {"magnus_force", "", &row.magnus_force},
                              {"roll_damping", "", &row.roll_damping},
                              {"overturning", "", &row.overturning},
                              {"pitch_damping", "", &row.pitch_damping},
                              {"magnus_moment", "", &row.magnus_moment}};
    if (const core::Status s = read(rows->children[i], numbers, {}, core::text("values.aerodynamics[", i, "]")); !s)
      return s.error();
    shell.aerodynamics.push_back(row);
  }
  if (const core::Status s = ballistics::check(shell); !s) return detail::in_file(file, s.error());
  return shell;
}

core::Result<std::vector<ballistics::Layer>> parse_wall(std::string_view text, std::string_view file) {
  static constexpr NumberName names[] = {{"thickness", "m"},          {"strength", "Pa"},    {"inertia", "kg/m^3"},
                                         {"limit_speed", "m/s"},      {"density", "kg/m^3"}, {"ricochet_angle", "rad"},
                                         {"ricochet_restitution", ""}};
  const auto tree = detail::read_preset_tree(text, file, true);
  if (!tree) return tree.error();
  const detail::Node& list = *tree->find("values");
  if (list.children.empty() || list.children.size() > 100)
    return detail::preset_error(file, list, "values", "expected 1 to 100 layers");
  std::vector<ballistics::Layer> layers;
  for (std::size_t i = 0; i < list.children.size(); ++i) {
    const detail::Node& node = list.children[i];
    const std::string at = core::text("values[", i, "]");
    if (!node.is_object())
      return detail::preset_error(file, node, at, "found " + detail::show(node) + ", expected an object");
    ballistics::Layer layer;
    double* const fields[] = {&layer.thickness, &layer.medium.strength, &layer.medium.inertia,      &layer.limit_speed,
                              &layer.density,   &layer.ricochet_angle,  &layer.ricochet_restitution};
    for (std::size_t k = 0; k < node.keys.size(); ++k) {
      const std::string where = at + "." + node.keys[k];
      if (node.keys[k] == "name") continue;
      double* field = nullptr;
      std::string_view unit;
      for (std::size_t f = 0; f < std::size(names); ++f)
        if (names[f].name == node.keys[k]) field = fields[f], unit = names[f].unit;
      if (field == nullptr)
        return detail::preset_error(file, node.children[k], where, "found a name that is not known here");
      const auto quantity = detail::read_preset_quantity(node.children[k], unit, file, where);
      if (!quantity) return quantity.error();
      *field = *quantity;
    }
    layers.push_back(layer);
  }
  if (auto s = ballistics::check_layers(layers); !s) return detail::in_file(file, s.error());
  return layers;
}

}  // namespace carom::scene
