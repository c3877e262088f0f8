// Numbers that a caller gives, checked by name.
#pragma once

#include <initializer_list>

#include "carom/core/result.h"
#include "carom/core/string.h"
#include "carom/math/vec.h"

namespace carom::ballistics::detail {

struct NamedNumber {
  const char* name;
  double value;
  bool zero = false;  ///< may be 0
};

/// Errors: the first of them that is no finite number, less than 0, more than `most` (0: none is), or 0 where it may
/// not be.
inline core::Status check_numbers(std::initializer_list<NamedNumber> numbers, double most = 0) {
  for (const NamedNumber& n : numbers) {
    if (math::is_finite(n.value) && (n.value > 0 || (n.value == 0 && n.zero)) && (most == 0 || n.value <= most))
      continue;
    const std::string expected = n.zero ? "a finite number >= 0" : "a finite number > 0";
    return core::Error{core::refused(n.name, n.value, most == 0 ? expected : core::text(expected, ", at most ", most))};
  }
  return {};
}

}  // namespace carom::ballistics::detail
