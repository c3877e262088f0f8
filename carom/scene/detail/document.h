// A JSON text as a tree in which every value knows its file, line and column.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "carom/core/result.h"

namespace carom::scene::detail {

enum class NodeKind : std::uint8_t { null, boolean, number, text, array, object };

struct Node {
  NodeKind kind = NodeKind::null;
  std::uint16_t file = 0;  ///< index into SceneDocument::files
  bool truth = false;
  bool integral = false;              ///< a number written without fraction and exponent
  std::int32_t line = 0, column = 0;  ///< of the value's last character
  double number = 0;
  std::string text;               ///< of a string
  std::vector<std::string> keys;  ///< of an object, in file order, one a child
  std::vector<Node> children;     ///< of an array or object

  const Node* find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] == key) return &children[i];
    return nullptr;
  }
  bool is_object() const { return kind == NodeKind::object; }
  bool is_array() const { return kind == NodeKind::array; }
  bool is_text() const { return kind == NodeKind::text; }
};

struct DocumentLimits {
  std::size_t bytes = 64u << 20;
  std::size_t nodes = 4u << 20;
  std::size_t keys = 4096;  ///< in one object
  int depth = 64;
};

/// Comments // and /* */ are allowed. Errors are complete sentences that begin with "name:line:".
core::Result<Node> parse_document(std::string_view text, std::string_view name, std::uint16_t file,
                                  const DocumentLimits& limits = {});

/// The value as an error message shows it: strings quoted and shortened, arrays and objects by kind.
std::string show(const Node& node);

/// s as a JSON string, with quotes.
std::string quote(std::string_view s);

/// The shortest digits that give exactly this number back; JSON has no way to write one that is not finite.
std::string shortest(double value);
std::string shortest(float value);

}  // namespace carom::scene::detail
