#include "carom/scene/sports_presets.h"

#include "carom/core/string.h"
#include "carom/math/units.h"
#include "carom/scene/detail/document.h"

namespace carom::scene {
namespace {

struct PresetValues {
  detail::Node root;
  std::vector<sports::Number> numbers;  // names live in `root`
  std::string side = "none";
};

/// "file:line: values.mass: found …, expected …"
core::Error preset_error(std::string_view file, const detail::Node& at, std::string_view where,
                         const std::string& message) {
  return core::Error{core::text(file, ":", at.line, ": ", where, ": ", message)};
}

core::Result<PresetValues> read_preset(std::string_view text, std::string_view file,
                                       std::span<const sports::NumberName> names, bool has_side) {
  auto document = detail::parse_document(text, file, 0, {.bytes = 1u << 20, .nodes = 4096, .depth = 8});
  if (!document) return document.error();
  PresetValues out{.root = std::move(*document), .numbers = {}};
  if (!out.root.is_object())
    return preset_error(file, out.root, "preset", "found " + detail::show(out.root) + ", expected an object");
  for (const std::string& key : out.root.keys)
    if (key != "description" && key != "source" && key != "values")
      return preset_error(file, *out.root.find(key), key, "found a key that a preset does not have");
  const detail::Node* values = out.root.find("values");
  if (values == nullptr || !values->is_object())
    return preset_error(file, values ? *values : out.root, "values", "expected an object of named quantities");
  for (std::size_t i = 0; i < values->keys.size(); ++i) {
    const std::string& key = values->keys[i];
    const detail::Node& node = values->children[i];
    const std::string where = "values." + key;
    if (has_side && key == "side_kind") {
      if (!node.is_text()) return preset_error(file, node, where, "found " + detail::show(node) + ", expected a name");
      out.side = node.text;
      continue;
    }
    const sports::NumberName* known = nullptr;
    for (const sports::NumberName& name : names)
      if (name.name == key) known = &name;
    if (known == nullptr) return preset_error(file, node, where, "found a name that is not known here");
    math::QuantityResult quantity;
    if (node.kind == detail::NodeKind::number && known->unit.empty()) {
      quantity.si = node.number;
    } else if (node.is_text()) {
      const math::QuantityResult unit = math::parse_quantity("1 " + std::string(known->unit));
      quantity = math::parse_quantity(node.text, known->unit.empty() ? math::Dimension{} : unit.dimension);
      if (!quantity.ok) return preset_error(file, node, where, quantity.error);
    } else {
      return preset_error(
          file, node, where,
          "found " + detail::show(node) + ", expected " +
              (known->unit.empty() ? std::string("a number") : "a quantity in " + std::string(known->unit)));
    }
    out.numbers.push_back({key, quantity.si});
  }
  return core::Result<PresetValues>(std::move(out));  // moved, never copied: the names live in the tree
}

core::Error in_file(std::string_view file, const core::Error& error) {
  return core::Error{core::text(file, ": ", error.message)};
}

}  // namespace

core::Result<sports::Ball> parse_ball(std::string_view text, std::string_view file) {
  const auto values = read_preset(text, file, sports::ball_number_names(), true);
  if (!values) return values.error();
  auto ball = sports::ball_from_numbers(values->numbers, values->side);
  return ball ? std::move(ball) : core::Result<sports::Ball>(in_file(file, ball.error()));
}

core::Result<sports::Surface> parse_surface(std::string_view text, std::string_view file) {
  const auto values = read_preset(text, file, sports::surface_number_names(), false);
  if (!values) return values.error();
  auto surface = sports::surface_from_numbers(values->numbers);
  return surface ? std::move(surface) : core::Result<sports::Surface>(in_file(file, surface.error()));
}

core::Result<sports::ClubHead> parse_club(std::string_view text, std::string_view file) {
  const auto values = read_preset(text, file, sports::club_number_names(), false);
  if (!values) return values.error();
  auto head = sports::club_from_numbers(values->numbers);
  return head ? std::move(head) : core::Result<sports::ClubHead>(in_file(file, head.error()));
}

}  // namespace carom::scene
