// Small arithmetic over named quantities: + − * / ^, comparisons, functions, numbers with units. Dimensions are
// checked once; evaluation is a loop over a postfix program, so that a plot may read it every step.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "carom/core/result.h"
#include "carom/scene/detail/quantity.h"

namespace carom::scene::detail {

struct Expression {
  enum class Code : std::uint8_t {
    constant,
    name,
    negate,
    add,
    subtract,
    multiply,
    divide,
    power,
    less,
    less_equal,
    greater,
    greater_equal,
    equal,
    not_equal,
    sqrt,
    sin,
    cos,
    tan,
    abs,
    floor,
    ceil,
    exp,
    log,
    minimum,
    maximum,
    mod,
    atan2,
    random,
    select
  };
  struct Operation {
    Code code{};
    double value = 0;       ///< of a constant; the exponent of a power
    Dimension dimension{};  ///< of a constant
    int index = 0;          ///< of a name; the number of arguments of random
  };
  std::vector<Operation> program;
  std::vector<std::string> names;  ///< each one once
  int stack = 0;                   ///< the depth that evaluation needs, at most 64
};

/// Errors say at which character (from 1) and what was expected there.
core::Result<Expression> parse_expression(std::string_view text);
/// The dimension of the value, where names[i] has dimensions[i].
core::Result<Dimension> check_expression(const Expression& expression, std::span<const Dimension> dimensions);
/// The value in SI units. Division by zero and the like give what IEEE 754 says.
double evaluate_expression(const Expression& expression, std::span<const double> values);

}  // namespace carom::scene::detail
