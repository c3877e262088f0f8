// Decimal text to double and back: correctly rounded, without locale, the same on every platform.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "carom/export.h"

namespace carom::math {

struct DecimalResult {
  double value{};
  std::size_t length{};  ///< characters of the text that belong to the number; zero where it does not start with one
};

/// The longest number at the start of `text`: [+−]digits[.digits][e[+−]digits], to the nearest double (ties to even).
/// Overflow gives infinity, underflow zero or a subnormal. Neither leading spaces nor "inf", "nan" or hexadecimal.
CAROM_API DecimalResult parse_decimal(std::string_view text);

/// The shortest decimal that parses back to x; "inf", "-inf" or "nan" where x is not finite.
CAROM_API std::string format_decimal(double x);
/// Likewise the shortest that parses back to the same float.
CAROM_API std::string format_decimal(float x);
/// x with `digits` significant digits (1 to 17), trailing zeros dropped.
CAROM_API std::string format_decimal(double x, int digits);
/// x with `digits` digits (0 to 99) after the point.
CAROM_API std::string format_fixed(double x, int digits);

}  // namespace carom::math
