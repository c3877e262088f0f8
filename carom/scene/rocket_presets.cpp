#include "carom/scene/rocket_presets.h"

#include "carom/core/string.h"
#include "carom/scene/detail/preset_values.h"

namespace carom::scene {
namespace {

using detail::Node;
using detail::preset_error;
using detail::PresetNumber;
using detail::read_preset_numbers;
using Need = PresetNumber::Need;

/// Mach number, C_D, Mach number, C_D … under `key`, instead of the number under `other`.
core::Status read_drag_table(const Node& values, std::string_view key, std::string_view other, std::string_view file,
                             ballistics::DragCurve& out) {
  const Node* const table = values.find(key);
  const std::string where = core::text("values.", key);
  if (table == nullptr) return {};
  if (values.find(other) != nullptr)
    return preset_error(file, *table, where, core::text("found it beside ", other, ", expected one of them"));
  if (!table->is_array() || table->children.empty() || table->children.size() % 2 != 0)
    return preset_error(file, *table, where, "expected pairs of Mach number and C_D, one after another");
  std::vector<ballistics::DragPoint> points;
  for (std::size_t i = 0; i < table->children.size(); i += 2) {
    const auto mach = detail::read_preset_quantity(table->children[i], "", file, where),
               coefficient = detail::read_preset_quantity(table->children[i + 1], "", file, where);
    if (!mach) return mach.error();
    if (!coefficient) return coefficient.error();
    points.push_back({*mach, *coefficient});
  }
  auto curve = ballistics::DragCurve::from_points(points);
  if (!curve) return preset_error(file, *table, where, curve.error().message);
  out = std::move(*curve);
  return {};
}

core::Result<ballistics::Motor> read_motor(const Node& stage, std::string_view file, const std::string& at,
                                           const PresetResolver& resolver) {
  const Node* const name = stage.find("motor");
  if (name == nullptr) return preset_error(file, stage, at + ".motor", "is missing");
  if (!name->is_text() || !detail::is_preset_name(name->text))
    return preset_error(file, *name, at + ".motor", "found " + detail::show(*name) + ", expected the name of a preset");
  if (!resolver) return preset_error(file, *name, at + ".motor", "there is nobody to ask for presets");
  const std::string path = core::text("presets/motor/", name->text, ".eng");
  const auto text = resolver(path);
  if (!text) return preset_error(file, *name, at + ".motor", text.error().message);
  const auto motors = ballistics::read_rasp(*text, path);
  if (!motors) return preset_error(file, *name, at + ".motor", motors.error().message);
  const Node* const wanted = stage.find("designation");
  auto motor = detail::choose_motor(*motors, path, wanted);
  if (motor) return std::move(*motor);
  return wanted == nullptr ? preset_error(file, *name, at + ".motor", motor.error().message)
                           : preset_error(file, *wanted, at + ".designation", motor.error().message);
}

}  // namespace

core::Result<ballistics::Rocket> parse_rocket(std::string_view text, std::string_view file,
                                              const PresetResolver& resolver) {
  const auto tree = detail::read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  const Node& values = *tree->find("values");
  ballistics::Rocket rocket;
  rocket.fins = {.count = 0};
  double drag = 0.5, coasting = -1, fins = 0;
  const PresetNumber fields[] = {{"diameter", "m", &rocket.diameter, Need::positive},
                                 {"length", "m", &rocket.length, Need::positive},
                                 {"nose_length", "m", &rocket.nose_length, Need::not_negative},
                                 {"drag_coefficient", "", &drag, Need::not_negative},
                                 {"coasting_drag_coefficient", "", &coasting, Need::not_negative},
                                 {"fin_count", "", &fins, Need::not_negative},
                                 {"fin_root_chord", "m", &rocket.fins.root_chord, Need::not_negative},
                                 {"fin_tip_chord", "m", &rocket.fins.tip_chord, Need::not_negative},
                                 {"fin_span", "m", &rocket.fins.span, Need::not_negative},
                                 {"fin_sweep", "m", &rocket.fins.sweep, Need::not_negative},
                                 {"fin_position", "m", &rocket.fins.position, Need::not_negative},
                                 {"parachute_drag_area", "m^2", &rocket.parachute.drag_area, Need::not_negative},
                                 {"parachute_height", "m", &rocket.parachute.deploy_height, Need::not_negative},
                                 {"parachute_delay", "s", &rocket.parachute.deploy_delay, Need::not_negative}};
  static constexpr std::string_view lists[] = {"stages", "drag_table", "coasting_drag_table"};
  if (auto s = read_preset_numbers(values, fields, lists, file, "values"); !s) return s.error();
  rocket.drag = ballistics::DragCurve(drag);
  if (const core::Status s = read_drag_table(values, "drag_table", "drag_coefficient", file, rocket.drag); !s)
    return s.error();
  rocket.coasting_drag = coasting < 0 ? rocket.drag : ballistics::DragCurve(coasting);
  if (const core::Status s =
          read_drag_table(values, "coasting_drag_table", "coasting_drag_coefficient", file, rocket.coasting_drag);
      !s)
    return s.error();
  rocket.fins.count = int(math::min(fins, 100.0));
  if (double(rocket.fins.count) != fins || fins > 16)
    return preset_error(file, *values.find("fin_count"), "values.fin_count",
                        core::refused("it", fins, "a whole number, at most 16"));

  const Node* const stages = values.find("stages");
  if (stages == nullptr || !stages->is_array() || stages->children.empty() || stages->children.size() > 10)
    return preset_error(file, stages != nullptr ? *stages : values, "values.stages",
                        "expected a list of 1 to 10 stages");
  for (std::size_t i = 0; i < stages->children.size(); ++i) {
    const Node& node = stages->children[i];
    const std::string at = core::text("values.stages[", i, "]");
    ballistics::Stage stage;
    const PresetNumber numbers[] = {{"dry_mass", "kg", &stage.dry_mass, Need::positive},
                                    {"dry_centre", "m", &stage.dry_centre, Need::not_negative},
                                    {"motor_centre", "m", &stage.motor_centre, Need::not_negative},
                                    {"ignition_delay", "s", &stage.ignition_delay, Need::not_negative},
                                    {"separation_delay", "s", &stage.separation_delay, Need::not_negative}};
    static constexpr std::string_view texts[] = {"motor", "designation", "name"};
    if (auto s = read_preset_numbers(node, numbers, texts, file, at); !s) return s.error();
    auto motor = read_motor(node, file, at, resolver);
    if (!motor) return motor.error();
    stage.motor = std::move(*motor);
    rocket.stages.push_back(std::move(stage));
  }
  return rocket;
}

}  // namespace carom::scene
