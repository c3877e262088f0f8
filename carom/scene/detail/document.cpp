#include "carom/scene/detail/document.h"

#define JSON_NO_IO
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>

#include "carom/math/decimal.h"

namespace carom::scene::detail {
namespace {

/// Where the parser has read to. Line and column are those of the last character that is not white space, so that a
/// number, which ends only at the character behind it, still names its own line.
struct ReadPosition {
  int line = 1, column = 0;
  int value_line = 1, value_column = 0;
};

/// Hands characters to the parser and counts lines as it goes.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, ReadPosition* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    const char c = *at_++;
    if (c == '\n') {
      ++position_->line;
      position_->column = 0;
      return *this;
    }
    ++position_->column;
    if (c != ' ' && c != '\t' && c != '\r') {
      position_->value_line = position_->line;
      position_->value_column = position_->column;
    }
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }
  friend bool operator!=(const CountingIterator& a, const CountingIterator& b) { return a.at_ != b.at_; }

 private:
  const char* at_;
  ReadPosition* position_;
};

/// Builds the tree from the parser's events.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view name, std::uint16_t file, const DocumentLimits& limits, const ReadPosition& position)
      : name_(name), file_(file), limits_(limits), position_(position) {}

  bool null() { return put(make(NodeKind::null)); }
  bool boolean(bool value) {
    Node node = make(NodeKind::boolean);
    node.truth = value;
    return put(std::move(node));
  }
  bool number_integer(std::int64_t value) { return put_number(double(value), true); }
  bool number_unsigned(std::uint64_t value) { return put_number(double(value), true); }
  bool number_float(double value, const std::string&) { return put_number(value, false); }
  bool string(std::string& value) {
    Node node = make(NodeKind::text);
    node.text = std::move(value);
    return put(std::move(node));
  }
  bool binary(std::vector<std::uint8_t>&) { return false; }
  bool start_object(std::size_t) { return open(NodeKind::object); }
  bool start_array(std::size_t) { return open(NodeKind::array); }
  bool key(std::string& value) {
    if (open_.back().keys.size() >= limits_.keys)
      return fail("found more than " + std::to_string(limits_.keys) + " keys in one object");
    if (open_.back().find(value) != nullptr) return fail("the key " + quote(value) + " stands twice in one object");
    open_.back().keys.push_back(std::move(value));
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  template <class Exception>
  bool parse_error(std::size_t, const std::string&, const Exception& error) {
    if (!error_.empty()) return false;
    // The parser's message begins with its own name and position; what follows the last ": " group of those is ours.
    std::string_view what = error.what();
    if (const std::size_t at = what.find("syntax error"); at != std::string_view::npos)
      what = what.substr(at);
    else if (const std::size_t close = what.find("] "); close != std::string_view::npos)
      what = what.substr(close + 2);
    return fail("not valid JSON: " + std::string(what.substr(0, 300)));
  }

  std::string& error() { return error_; }
  Node& root() { return root_; }
  bool fail(const std::string& message) {
    if (error_.empty()) error_ = name_ + ":" + std::to_string(position_.value_line) + ": " + message;
    return false;
  }

 private:
  Node make(NodeKind kind) const {
    Node node;
    node.kind = kind;
    node.file = file_;
    node.line = position_.value_line;
    node.column = position_.value_column;
    return node;
  }
  bool put_number(double value, bool integral) {
    Node node = make(NodeKind::number);
    node.number = value;
    node.integral = integral;
    return put(std::move(node));
  }
  bool put(Node&& node) {
    if (++count_ > limits_.nodes) return fail("found more than " + std::to_string(limits_.nodes) + " values");
    if (open_.empty())
      root_ = std::move(node);
    else
      open_.back().children.push_back(std::move(node));
    return true;
  }
  bool open(NodeKind kind) {
    if (int(open_.size()) >= limits_.depth)
      return fail("found values nested deeper than " + std::to_string(limits_.depth) + " levels");
    open_.push_back(make(kind));
    return true;
  }
  bool close() {
    Node node = std::move(open_.back());
    open_.pop_back();
    return put(std::move(node));
  }

  std::string name_;
  std::uint16_t file_;
  const DocumentLimits& limits_;
  const ReadPosition& position_;
  std::string error_;
  Node root_;
  std::vector<Node> open_;
  std::size_t count_ = 0;
};

}  // namespace

core::Result<Node> parse_document(std::string_view text, std::string_view name, std::uint16_t file,
                                  const DocumentLimits& limits) {
  if (text.size() > limits.bytes)
    return core::Error{std::string(name) + ": found " + std::to_string(text.size()) + " bytes, expected at most " +
                       std::to_string(limits.bytes)};
  ReadPosition position;
  TreeBuilder builder(name, file, limits, position);
  const char* const first = text.data();
  const bool parsed =
      nlohmann::json::sax_parse(CountingIterator(first, &position), CountingIterator(first + text.size(), &position),
                                &builder, nlohmann::json::input_format_t::json, true, true);
  if (!parsed || !builder.error().empty()) {
    if (builder.error().empty()) builder.fail("not valid JSON");
    return core::Error{std::move(builder.error())};
  }
  return std::move(builder.root());
}

std::string quote(std::string_view s) {
  std::string out = "\"";
  for (const char c : s) {
    switch (c) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      case '\t':
        out += "\\t";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20) {
          char escape[8];
          std::snprintf(escape, sizeof escape, "\\u%04x", unsigned(static_cast<unsigned char>(c)));
          out += escape;
        } else {
          out += c;
        }
    }
  }
  out += '"';
  return out;
}

std::string shortest(double value) { return math::format_decimal(value); }
std::string shortest(float value) { return math::format_decimal(value); }

std::string show(const Node& node) {
  switch (node.kind) {
    case NodeKind::null:
      return "null";
    case NodeKind::boolean:
      return node.truth ? "true" : "false";
    case NodeKind::number:
      return shortest(node.number);
    case NodeKind::text: {
      if (node.text.size() <= 60) return quote(node.text);
      std::size_t cut = 57;
      while (cut > 0 && (static_cast<unsigned char>(node.text[cut]) & 0xC0) == 0x80) --cut;
      return quote(node.text.substr(0, cut) + "…");
    }
    case NodeKind::array:
      return "a list of " + std::to_string(node.children.size());
    case NodeKind::object:
      return "an object";
  }
  return "";
}

}  // namespace carom::scene::detail
