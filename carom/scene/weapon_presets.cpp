#include "carom/scene/weapon_presets.h"

#include <vector>

#include "carom/ballistics/drag_data.h"
#include "carom/core/string.h"
#include "carom/scene/detail/preset_values.h"
#include "carom/scene/detail/weapon_numbers.h"

namespace carom::scene {
namespace {

using detail::PresetNumber;
using detail::PresetValues;
using sports::NumberName;

/// The number of that name into `into`, where the file has it.
void take(const PresetValues& values, std::string_view name, double& into) { into = values.number(name, into); }

/// The text of the preset that is named under its kind.
core::Result<std::string> named_preset(const PresetValues& values, std::string_view kind, std::string_view file,
                                       const PresetResolver& resolver) {
  const auto error = [&](const std::string& message) {
    return detail::preset_error(file, *values.root.find("values"), core::text("values.", kind), message);
  };
  const std::string_view name = values.text(kind);
  if (!detail::is_preset_name(name))
    return error(core::text("found ", core::quoted(name), ", expected the name of a preset"));
  if (!resolver) return error("there is nobody to ask for presets");
  auto found = resolver(core::text("presets/", kind, "/", name, ".json"));
  if (!found) return error(found.error().message);
  return found;
}

}  // namespace

core::Result<ballistics::Ammunition> parse_ammunition(std::string_view text, std::string_view file,
                                                      const PresetResolver& resolver) {
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
  static constexpr std::string_view texts[] = {"drag_function", "shell"},
                                    lists[] = {"drag_table", "ballistic_coefficients"};
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
  if (values->has("shell")) {
    const auto shell = named_preset(*values, "shell", file, resolver);
    if (!shell) return shell.error();
    auto read = parse_shell(*shell, core::text("presets/shell/", values->text("shell"), ".json"));
    if (!read) return error("shell", read.error().message);
    a.shell = std::move(*read);
  }
  if (auto s = ballistics::check(a); !s) return detail::in_file(file, s.error());
  return a;
}

core::Result<ballistics::Sight> parse_sight(std::string_view text, std::string_view file) {
  static constexpr NumberName names[] = {{"height", "m"},    {"offset", "m"},       {"click", "rad"},
                                         {"spacing", "rad"}, {"magnification", ""}, {"parallax_free", "m"}};
  const auto values = detail::read_preset(text, file, names, {});
  if (!values) return values.error();
  ballistics::Sight s;
  take(*values, "height", s.height);
  take(*values, "offset", s.offset);
  take(*values, "parallax_free", s.parallax_free);
  take(*values, "click", s.click);
  take(*values, "spacing", s.spacing);
  take(*values, "magnification", s.magnification);
  if (auto checked = ballistics::check(s); !checked) return detail::in_file(file, checked.error());
  return s;
}

core::Result<ballistics::Weapon> parse_gun(std::string_view text, std::string_view file,
                                           const PresetResolver& resolver) {
  static const std::vector<NumberName> names = [] {
    std::vector<NumberName> list;
    ballistics::Weapon any;
    detail::visit_numbers(any, [&](const char* name, const char* unit, double&) { list.push_back({name, unit}); });
    return list;
  }();
  static constexpr std::string_view texts[] = {"ammunition", "sight"};
  const auto values = detail::read_preset(text, file, names, texts);
  if (!values) return values.error();
  const auto error = [&](std::string_view where, const std::string& message) {
    return detail::preset_error(file, *values->root.find("values"), "values." + std::string(where), message);
  };
  ballistics::Weapon w;
  const auto ammunition = named_preset(*values, "ammunition", file, resolver);
  if (!ammunition) return ammunition.error();
  auto round =
      parse_ammunition(*ammunition, core::text("presets/ammunition/", values->text("ammunition"), ".json"), resolver);
  if (!round) return error("ammunition", round.error().message);
  w.ammunition = *round;
  if (values->has("sight")) {
    const auto sight = named_preset(*values, "sight", file, resolver);
    if (!sight) return sight.error();
    const auto read = parse_sight(*sight, core::text("presets/sight/", values->text("sight"), ".json"));
    if (!read) return error("sight", read.error().message);
    w.sight = *read;
  }
  detail::visit_numbers(w, [&](const char* name, const char*, double& value) { take(*values, name, value); });
  if (auto s = ballistics::check(w); !s) return detail::in_file(file, s.error());
  return w;
}

core::Result<ballistics::Shell> parse_shell(std::string_view text, std::string_view file) {
  const auto tree = detail::read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  const detail::Node& values = *tree->find("values");
  ballistics::Shell shell;
  const PresetNumber whole[] = {{"mass", "kg", &shell.mass},
                                {"diameter", "m", &shell.diameter},
                                {"axial_inertia", "kg*m^2", &shell.axial_inertia},
                                {"transverse_inertia", "kg*m^2", &shell.transverse_inertia},
                                {"twist", "", &shell.twist},
                                {"length", "m", &shell.length},
                                {"centre", "m", &shell.centre}};
  static constexpr std::string_view others[] = {"aerodynamics"};
  if (const core::Status s = detail::read_preset_numbers(values, whole, others, file, "values"); !s) return s.error();
  for (const std::string_view needed : {"mass", "diameter", "axial_inertia", "transverse_inertia", "twist"})
    if (values.find(needed) == nullptr)
      return detail::preset_error(file, values, core::text("values.", needed), "is missing");
  const detail::Node* const rows = values.find("aerodynamics");
  if (rows == nullptr || !rows->is_array() || rows->children.empty() || rows->children.size() > 200)
    return detail::preset_error(file, rows != nullptr ? *rows : values, "values.aerodynamics",
                                "expected a list of 1 to 200 rows");
  for (std::size_t i = 0; i < rows->children.size(); ++i) {
    ballistics::ShellCoefficients row;
    const PresetNumber numbers[] = {{"mach", "", &row.mach},
                                    {"axial", "", &row.axial},
                                    {"axial_yaw", "", &row.axial_yaw},
                                    {"normal", "", &row.normal},
                                    {"magnus_force", "", &row.magnus_force},
                                    {"roll_damping", "", &row.roll_damping},
                                    {"overturning", "", &row.overturning},
                                    {"pitch_damping", "", &row.pitch_damping},
                                    {"magnus_moment", "", &row.magnus_moment}};
    if (const core::Status s = detail::read_preset_numbers(rows->children[i], numbers, {}, file,
                                                           core::text("values.aerodynamics[", i, "]"));
        !s)
      return s.error();
    shell.aerodynamics.push_back(row);
  }
  if (const core::Status s = ballistics::check(shell); !s) return detail::in_file(file, s.error());
  return shell;
}

core::Result<std::vector<ballistics::Layer>> parse_wall(std::string_view text, std::string_view file) {
  const auto tree = detail::read_preset_tree(text, file, true);
  if (!tree) return tree.error();
  const detail::Node& list = *tree->find("values");
  if (list.children.empty() || list.children.size() > 100)
    return detail::preset_error(file, list, "values", "expected 1 to 100 layers");
  std::vector<ballistics::Layer> layers;
  for (std::size_t i = 0; i < list.children.size(); ++i) {
    ballistics::Layer layer;
    const PresetNumber numbers[] = {{"thickness", "m", &layer.thickness},
                                    {"strength", "Pa", &layer.medium.strength},
                                    {"inertia", "kg/m^3", &layer.medium.inertia},
                                    {"limit_speed", "m/s", &layer.limit_speed},
                                    {"density", "kg/m^3", &layer.density},
                                    {"ricochet_angle", "rad", &layer.ricochet_angle},
                                    {"ricochet_restitution", "", &layer.ricochet_restitution}};
    static constexpr std::string_view others[] = {"name"};
    if (const core::Status s =
            detail::read_preset_numbers(list.children[i], numbers, others, file, core::text("values[", i, "]"));
        !s)
      return s.error();
    layers.push_back(layer);
  }
  if (auto s = ballistics::check_layers(layers); !s) return detail::in_file(file, s.error());
  return layers;
}

}  // namespace carom::scene
