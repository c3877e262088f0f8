#include "carom/scene/detail/preset_values.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/units.h"

namespace carom::scene::detail {

bool PresetValues::has(std::string_view name) const {
  for (const sports::Number& n : numbers)
    if (n.name == name) return true;
  for (const PresetText& t : texts)
    if (t.name == name) return true;
  return false;
}
double PresetValues::number(std::string_view name, double otherwise) const {
  for (const sports::Number& n : numbers)
    if (n.name == name) return n.value;
  return otherwise;
}
std::string_view PresetValues::text(std::string_view name, std::string_view otherwise) const {
  for (const PresetText& t : texts)
    if (t.name == name) return t.value;
  return otherwise;
}

std::span<const double> PresetValues::list(std::string_view name) const {
  for (const PresetList& l : lists)
    if (l.name == name) return l.values;
  return {};
}

core::Error preset_error(std::string_view file, const Node& at, std::string_view where, const std::string& message) {
  return core::Error{core::text(file, ":", at.line, ": ", where, ": ", message)};
}

core::Error in_file(std::string_view file, const core::Error& error) {
  return core::Error{core::text(file, ": ", error.message)};
}

core::Result<Node> read_preset_tree(std::string_view text, std::string_view file, bool array) {
  auto document = parse_document(text, file, 0, {.bytes = 1u << 20, .nodes = 4096, .depth = 8});
  if (!document) return document.error();
  if (!document->is_object())
    return preset_error(file, *document, "preset", "found " + show(*document) + ", expected an object");
  for (const std::string& key : document->keys)
    if (key != "description" && key != "source" && key != "values")
      return preset_error(file, *document->find(key), key, "found a key that a preset does not have");
  const Node* values = document->find("values");
  if (values == nullptr || !(array ? values->is_array() : values->is_object()))
    return preset_error(file, values ? *values : *document, "values",
                        array ? "expected a list of objects" : "expected an object of named quantities");
  return document;
}

core::Result<double> read_preset_quantity(const Node& node, std::string_view unit, std::string_view file,
                                          std::string_view where) {
  if (node.kind == NodeKind::number && unit.empty()) return node.number;
  if (!node.is_text())
    return preset_error(file, node, where,
                        "found " + show(node) + ", expected " +
                            (unit.empty() ? std::string("a number") : "a quantity in " + std::string(unit)));
  const math::QuantityResult known = math::parse_quantity("1 " + std::string(unit));
  const math::QuantityResult quantity =
      math::parse_quantity(node.text, unit.empty() ? math::Dimension{} : known.dimension);
  if (!quantity.ok) return preset_error(file, node, where, quantity.error);
  return quantity.si;
}

core::Status read_preset_numbers(const Node& node, std::span<const PresetNumber> fields,
                                 std::span<const std::string_view> others, std::string_view file,
                                 const std::string& at) {
  using Need = PresetNumber::Need;
  if (!node.is_object()) return preset_error(file, node, at, "found " + show(node) + ", expected an object");
  for (std::size_t k = 0; k < node.keys.size(); ++k) {
    const std::string_view key = node.keys[k];
    if (std::find(others.begin(), others.end(), key) != others.end()) continue;
    const std::string where = core::text(at, ".", key);
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const PresetNumber& f) { return f.name == key; });
    if (field == fields.end())
      return preset_error(file, node.children[k], where, "found a name that is not known here");
    const auto quantity = read_preset_quantity(node.children[k], field->unit, file, where);
    if (!quantity) return quantity.error();
    if (field->need != Need::any &&
        (!math::is_finite(*quantity) || *quantity < 0 || (field->need == Need::positive && *quantity == 0)))
      return preset_error(
          file, node.children[k], where,
          core::refused("it", *quantity,
                        field->need == Need::positive ? "a finite number > 0" : "a finite number >= 0"));
    *field->value = *quantity;
  }
  for (const PresetNumber& field : fields)
    if (field.need == Need::positive && node.find(field.name) == nullptr)
      return preset_error(file, node, core::text(at, ".", field.name), "is missing");
  return {};
}

core::Result<PresetValues> read_preset(std::string_view text, std::string_view file,
                                       std::span<const sports::NumberName> names,
                                       std::span<const std::string_view> texts,
                                       std::span<const std::string_view> lists) {
  auto tree = read_preset_tree(text, file, false);
  if (!tree) return tree.error();
  PresetValues out{.root = std::move(*tree), .numbers = {}, .texts = {}, .lists = {}};
  const Node& values = *out.root.find("values");
  for (std::size_t i = 0; i < values.keys.size(); ++i) {
    const std::string& key = values.keys[i];
    const Node& node = values.children[i];
    const std::string where = "values." + key;
    const auto among = [&](std::span<const std::string_view> these) {
      return std::find(these.begin(), these.end(), key) != these.end();
    };
    if (among(lists)) {
      if (!node.is_array())
        return preset_error(file, node, where, "found " + show(node) + ", expected a list of numbers");
      out.lists.push_back({key, {}});
      for (const Node& child : node.children) {
        const auto number = read_preset_quantity(child, "", file, where);
        if (!number) return number.error();
        out.lists.back().values.push_back(*number);
      }
      continue;
    }
    if (among(texts)) {
      if (!node.is_text()) return preset_error(file, node, where, "found " + show(node) + ", expected a name");
      out.texts.push_back({key, node.text});
      continue;
    }
    const sports::NumberName* known = nullptr;
    for (const sports::NumberName& name : names)
      if (name.name == key) known = &name;
    if (known == nullptr) return preset_error(file, node, where, "found a name that is not known here");
    const auto quantity = read_preset_quantity(node, known->unit, file, where);
    if (!quantity) return quantity.error();
    out.numbers.push_back({key, *quantity});
  }
  return core::Result<PresetValues>(std::move(out));  // moved, never copied: the names live in the tree
}

core::Result<ballistics::Motor> choose_motor(std::span<const ballistics::Motor> motors, std::string_view path,
                                             const Node* designation) {
  if (motors.empty()) return core::Error{core::text(path, " has no motor")};
  if (designation == nullptr) return motors.front();
  std::string known;
  for (const ballistics::Motor& motor : motors) {
    if (designation->is_text() && motor.name == designation->text) return motor;
    known += (known.empty() ? "" : ", ") + motor.name;
  }
  return core::Error{core::text("found ", show(*designation), ", expected one of ", path, ": ", known)};
}

}  // namespace carom::scene::detail
