// Sentences from pieces, without a locale: messages are the same on every machine.
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <type_traits>

#include "carom/math/decimal.h"

namespace carom::core {

namespace detail {
inline void append_piece(std::string& out, std::string_view piece) { out.append(piece); }
inline void append_piece(std::string& out, const char* piece) { out.append(piece); }
inline void append_piece(std::string& out, const std::string& piece) { out.append(piece); }
inline void append_piece(std::string& out, char piece) { out.push_back(piece); }
inline void append_piece(std::string& out, bool piece) { out.append(piece ? "true" : "false"); }
template <class T>
  requires(std::is_arithmetic_v<T> && !std::is_same_v<T, char> && !std::is_same_v<T, bool>)
void append_piece(std::string& out, T number) {
  if constexpr (std::is_floating_point_v<T>) {
    out.append(math::format_decimal(number));
  } else {
    char buffer[32];
    const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, number);
    out.append(buffer, end.ptr);
  }
}
}  // namespace detail

/// The pieces one after another. Floating-point numbers in the shortest form that reads back to the same value.
template <class... Pieces>
std::string text(const Pieces&... pieces) {
  std::string out;
  (detail::append_piece(out, pieces), ...);
  return out;
}

/// `x` with `digits` digits after the point.
inline std::string fixed(double x, int digits) { return math::format_fixed(x, digits); }

/// "mass is -3, expected a finite number > 0": one form for every refused field.
template <class T>
std::string refused(std::string_view field, const T& found, std::string_view expected) {
  return text(field, " is ", found, ", expected ", expected);
}

/// The piece in double quotes, control characters shown as \xNN, for names that came from outside.
inline std::string quoted(std::string_view name) {
  constexpr const char* digits = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : name) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      out.append("\\x");
      out.push_back(digits[byte >> 4]);
      out.push_back(digits[byte & 15]);
    } else {
      if (c == '"' || c == '\\') out.push_back('\\');
      out.push_back(c);
    }
  }
  out.push_back('"');
  return out;
}

}  // namespace carom::core
