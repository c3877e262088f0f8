#include "carom/scene/game_presets.h"

#include "carom/core/string.h"
#include "carom/scene/detail/preset_values.h"

namespace carom::scene {
namespace {

using detail::Node;
using detail::preset_error;
using detail::PresetNumber;
using detail::read_preset_numbers;
using sports::NumberName;

template <class T>
core::Result<T> parse_flat(std::string_view text, std::string_view file) {
  const auto values = detail::read_preset(text, file, sports::game_number_names<T>(), {});
  if (!values) return values.error();
  auto value = sports::game_from_numbers<T>(values->numbers);
  return value ? std::move(value) : core::Result<T>(detail::in_file(file, value.error()));
}

/// [time, value, time, value, …], or one number.
core::Result<sports::Curve> read_curve(const Node& node, std::string_view file, const std::string& at) {
  if (node.kind == detail::NodeKind::number) return sports::Curve::constant(node.number);
  if (!node.is_array() || node.children.empty() || node.children.size() % 2 != 0 || node.children.size() > 400)
    return preset_error(file, node, at,
                        "found " + detail::show(node) + ", expected a number or pairs of time and value");
  sports::Curve curve;
  for (std::size_t i = 0; i < node.children.size(); i += 2) {
    const auto time = detail::read_preset_quantity(node.children[i], "", file, at),
               value = detail::read_preset_quantity(node.children[i + 1], "", file, at);
    if (!time) return time.error();
    if (!value) return value.error();
    curve.points.push_back({*time, *value});
  }
  return curve;
}

core::Status read_link(const Node& node, std::string_view file, const std::string& at, sports::SwingLink& link) {
  const PresetNumber fields[] = {{"mass", "kg", &link.mass},    {"length", "m", &link.length},
                                 {"centre", "m", &link.centre}, {"inertia", "kg*m^2", &link.inertia},
                                 {"angle", "rad", &link.angle}, {"rate", "rad/s", &link.rate}};
  static constexpr std::string_view others[] = {"torque", "hold", "name"};
  if (const core::Status read = read_preset_numbers(node, fields, others, file, at); !read) return read;
  if (const Node* torque = node.find("torque")) {
    auto curve = read_curve(*torque, file, at + ".torque");
    if (!curve) return curve.error();
    link.torque = std::move(*curve);
  }
  const Node* hold = node.find("hold");
  if (hold == nullptr || (hold->is_text() && hold->text == "free")) return {};
  if (hold->is_text() && hold->text == "opens") {
    link.hold.until = sports::Hold::Until::opens;
    return {};
  }
  const auto time = detail::read_preset_quantity(*hold, "s", file, at + ".hold");
  if (!time)
    return preset_error(file, *hold, at + ".hold",
                        "found " + detail::show(*hold) + ", expected \"free\", \"opens\" or a time such as \"0.1 s\"");
  link.hold = {sports::Hold::Until::time, *time};
  return {};
}

}  // namespace

core::Result<sports::Pitch> parse_pitch(std::string_view text, std::string_view file) {
  return parse_flat<sports::Pitch>(text, file);
}
core::Result<sports::Bat> parse_bat(std::string_view text, std::string_view file) {
  return parse_flat<sports::Bat>(text, file);
}
core::Result<sports::CricketDelivery> parse_cricket_delivery(std::string_view text, std::string_view file) {
  return parse_flat<sports::CricketDelivery>(text, file);
}
core::Result<sports::BowlingBall> parse_bowling_ball(std::string_view text, std::string_view file) {
  return parse_flat<sports::BowlingBall>(text, file);
}
core::Result<sports::Delivery> parse_bowling_delivery(std::string_view text, std::string_view file) {
  return parse_flat<sports::Delivery>(text, file);
}

core::Result<sports::Lane> parse_lane(std::string_view text, std::string_view file) {
  const auto tree = detail::read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  const Node& values = *tree->find("values");
  sports::Lane lane;
  const PresetNumber fields[] = {
      {"length", "m", &lane.length}, {"width", "m", &lane.width}, {"gravity", "m/s^2", &lane.gravity}};
  static constexpr std::string_view others[] = {"stretches"};
  if (const core::Status read = read_preset_numbers(values, fields, others, file, "values"); !read) return read.error();
  const Node* const list = values.find("stretches");
  if (list == nullptr || !list->is_array() || list->children.empty() || list->children.size() > 100)
    return preset_error(file, list != nullptr ? *list : values, "values.stretches",
                        "expected a list of 1 to 100 stretches");
  lane.stretches.clear();
  for (std::size_t i = 0; i < list->children.size(); ++i) {
    sports::Lane::Stretch stretch;
    const PresetNumber numbers[] = {{"end", "m", &stretch.end}, {"friction", "", &stretch.friction}};
    if (const core::Status read =
            read_preset_numbers(list->children[i], numbers, {}, file, core::text("values.stretches[", i, "]"));
        !read)
      return read.error();
    lane.stretches.push_back(stretch);
  }
  if (const core::Status good = sports::check(lane); !good) return detail::in_file(file, good.error());
  return lane;
}

core::Result<sports::Swing> parse_swing(std::string_view text, std::string_view file) {
  const auto tree = detail::read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  const Node& values = *tree->find("values");
  sports::Swing swing;
  const PresetNumber fields[] = {
      {"plane", "rad", &swing.plane}, {"gravity", "m/s^2", &swing.gravity}, {"ball", "m", &swing.ball}};
  static constexpr std::string_view others[] = {"impact", "hub", "shaft", "links"};
  if (const core::Status read = read_preset_numbers(values, fields, others, file, "values"); !read) return read.error();
  if (const Node* impact = values.find("impact")) {
    static constexpr std::string_view names[] = {"head_below_hub", "club_vertical", "ball"};
    bool known = false;
    for (std::size_t i = 0; i < std::size(names); ++i)
      if (impact->is_text() && impact->text == names[i]) swing.impact = sports::Swing::ImpactAt(i), known = true;
    if (!known)
      return preset_error(file, *impact, "values.impact",
                          "found " + detail::show(*impact) + ", expected head_below_hub, club_vertical or ball");
  }
  if (const Node* hub = values.find("hub")) {
    auto curve = read_curve(*hub, file, "values.hub");
    if (!curve) return curve.error();
    swing.hub = std::move(*curve);
  }
  if (const Node* shaft = values.find("shaft")) {
    const PresetNumber numbers[] = {{"frequency", "Hz", &swing.shaft.frequency},
                                    {"damping_ratio", "", &swing.shaft.damping_ratio},
                                    {"head_mass", "kg", &swing.shaft.head_mass},
                                    {"shaft_mass", "kg", &swing.shaft.shaft_mass}};
    if (const core::Status read = read_preset_numbers(*shaft, numbers, {}, file, "values.shaft"); !read)
      return read.error();
  }
  const Node* const links = values.find("links");
  if (links == nullptr || !links->is_array() || links->children.empty() ||
      links->children.size() > sports::max_swing_links)
    return preset_error(file, links != nullptr ? *links : values, "values.links", "expected a list of 2 to 4 links");
  for (std::size_t i = 0; i < links->children.size(); ++i) {
    sports::SwingLink link;
    if (const core::Status read = read_link(links->children[i], file, core::text("values.links[", i, "]"), link); !read)
      return read.error();
    swing.links.push_back(std::move(link));
  }
  if (const core::Status good = sports::check(swing); !good) return detail::in_file(file, good.error());
  return swing;
}

}  // namespace carom::scene
