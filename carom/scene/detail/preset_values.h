// Preset files that are one flat list of quantities: {"description", "source", "values": {name: quantity or text}}.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "carom/ballistics/motor.h"
#include "carom/core/result.h"
#include "carom/scene/detail/document.h"
#include "carom/sports/numbers.h"

namespace carom::scene::detail {

struct PresetText {
  std::string name, value;
};
struct PresetList {
  std::string name;
  std::vector<double> values;
};
struct PresetValues {
  Node root;
  std::vector<sports::Number> numbers;  // SI; names live in `root`
  std::vector<PresetText> texts;
  std::vector<PresetList> lists;

  bool has(std::string_view name) const;
  double number(std::string_view name, double otherwise) const;
  std::string_view text(std::string_view name, std::string_view otherwise = "") const;
  std::span<const double> list(std::string_view name) const;  ///< empty where there is none
};

/// "file:line: values.mass: found …, expected …"
core::Error preset_error(std::string_view file, const Node& at, std::string_view where, const std::string& message);
/// "file: …", for what is known of the whole alone.
core::Error in_file(std::string_view file, const core::Error& error);
/// Quantities of these names, texts of those, and lists of plain numbers; others, and what is named twice, are errors.
core::Result<PresetValues> read_preset(std::string_view text, std::string_view file,
                                       std::span<const sports::NumberName> names,
                                       std::span<const std::string_view> texts,
                                       std::span<const std::string_view> lists = {});
/// One quantity, in the unit's dimension (empty: a plain number), or an error.
core::Result<double> read_preset_quantity(const Node& node, std::string_view unit, std::string_view file,
                                          std::string_view where);
/// A number of an object by name, and what it must be.
struct PresetNumber {
  std::string_view name, unit;
  double* value;
  enum class Need {
    any,
    not_negative,
    positive,  ///< and it must be there
  } need = Need::any;
};
/// The numbers of an object; keys of `others` are looked at by the caller, all else is an error.
core::Status read_preset_numbers(const Node& node, std::span<const PresetNumber> fields,
                                 std::span<const std::string_view> others, std::string_view file,
                                 const std::string& at);
/// The tree of a preset with its values, whose kind is checked: "values" an object, or an array where `array` says so.
core::Result<Node> read_preset_tree(std::string_view text, std::string_view file, bool array);

/// The motor that `designation` names, the first where there is none (null). The error says what was found and
/// expected, not where.
core::Result<ballistics::Motor> choose_motor(std::span<const ballistics::Motor> motors, std::string_view path,
                                             const Node* designation);

/// A name of a preset, never a path.
inline bool is_preset_name(std::string_view name) {
  if (name.empty() || name.size() > 80) return false;
  for (const char c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-'))
      return false;
  return true;
}

}  // namespace carom::scene::detail
