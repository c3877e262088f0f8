// The units that quantities know, and what a unit expression comes to.
#pragma once

#include <string>
#include <string_view>

#include "carom/math/detail/double_double.h"
#include "carom/math/units.h"

namespace carom::math::detail {

struct NamedUnit {
  std::string_view name;
  double numerator, denominator;  ///< SI value of one unit is their quotient; both exact or as defined
  Dimension dimension;
  bool prefixable;
  double offset;       ///< of the zero point, in this unit: only temperatures
  bool counts_cycles;  ///< Hz: must not be taken for rad/s
};

struct Unit {
  Pair scale{1, 0};
  double offset{};
  Dimension dimension{};
  bool counts_cycles{};
};

struct UnitResult {
  bool ok{};
  Unit unit;
  std::string error;
};

/// The unit of a name, prefixed or not; false where there is none.
bool find_unit(std::string_view name, Unit& unit);
/// A known name that `name` may be a misspelling of, or empty.
std::string nearest_unit(std::string_view name);
/// A whole unit expression; empty text is the plain number one.
UnitResult parse_unit(std::string_view text);

}  // namespace carom::math::detail
