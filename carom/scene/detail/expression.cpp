#include "carom/scene/detail/expression.h"

#include "carom/core/spelling.h"
#include "carom/math/decimal.h"
#include "carom/math/elementary.h"
#include "carom/math/vec.h"
#include "carom/scene/detail/document.h"

namespace carom::scene::detail {
namespace {
using Code = Expression::Code;

constexpr int max_depth = 48;

struct Function {
  std::string_view name;
  Code code;
  int arguments;  ///< −1: one or more
};
constexpr Function functions[] = {
    {"sqrt", Code::sqrt, 1},   {"sin", Code::sin, 1},        {"cos", Code::cos, 1},     {"tan", Code::tan, 1},
    {"abs", Code::abs, 1},     {"floor", Code::floor, 1},    {"ceil", Code::ceil, 1},   {"exp", Code::exp, 1},
    {"log", Code::log, 1},     {"min", Code::minimum, 2},    {"max", Code::maximum, 2}, {"mod", Code::mod, 2},
    {"atan2", Code::atan2, 2}, {"random", Code::random, -1}, {"if", Code::select, 3},
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c & 0x80) != 0; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class ExpressionParser {
 public:
  explicit ExpressionParser(std::string_view text) : text_(text) {}

  core::Result<Expression> parse() {
    comparison(0);
    skip();
    if (error_.empty() && at_ < text_.size()) fail("found " + rest() + ", expected an operator or the end");
    if (error_.empty() && out_.stack > 64) fail("found too many values waiting at once");
    if (!error_.empty()) return core::Error{error_};
    return std::move(out_);
  }

 private:
  void fail(const std::string& what) {
    if (error_.empty()) error_ = "character " + std::to_string(at_ + 1) + ": " + what;
  }
  std::string rest() const {
    if (at_ >= text_.size()) return "the end";
    std::string_view tail = text_.substr(at_, 12);
    while (!tail.empty() && at_ + tail.size() < text_.size() && (text_[at_ + tail.size()] & 0xC0) == 0x80)
      tail.remove_suffix(1);
    return quote(tail);
  }
  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(std::string_view token) {
    skip();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void emit(Code code, int pops, double value = 0, Dimension dimension = {}, int index = 0) {
    out_.program.push_back({code, value, dimension, index});
    depth_ += 1 - pops;
    if (depth_ > out_.stack) out_.stack = depth_;
  }

  void comparison(int level) {
    if (level > max_depth) return fail("found parentheses nested deeper than " + std::to_string(max_depth));
    sum(level);
    struct {
      std::string_view token;
      Code code;
    } const table[] = {{"<=", Code::less_equal}, {">=", Code::greater_equal}, {"==", Code::equal},
                       {"!=", Code::not_equal},  {"<", Code::less},           {">", Code::greater}};
    for (const auto& entry : table) {
      if (!error_.empty() || !take(entry.token)) continue;
      sum(level);
      emit(entry.code, 2);
      return;
    }
  }
  void sum(int level) {
    product(level);
    while (error_.empty()) {
      if (take("+"))
        product(level), emit(Code::add, 2);
      else if (take("-"))
        product(level), emit(Code::subtract, 2);
      else
        return;
    }
  }
  void product(int level) {
    unary(level);
    while (error_.empty()) {
      if (take("*"))
        unary(level), emit(Code::multiply, 2);
      else if (take("/"))
        unary(level), emit(Code::divide, 2);
      else
        return;
    }
  }
  void unary(int level) {
    if (level > max_depth) return fail("found signs nested deeper than " + std::to_string(max_depth));
    if (take("-")) {
      unary(level + 1);
      emit(Code::negate, 1);
      return;
    }
    primary(level);
    if (error_.empty() && take("^")) {
      skip();
      const bool negative = take("-");
      int exponent = 0;
      const std::size_t start = at_;
      while (at_ < text_.size() && is_digit(text_[at_]) && at_ - start < 2)
        exponent = exponent * 10 + (text_[at_++] - '0');
      if (at_ == start) return fail("found " + rest() + ", expected a whole exponent");
      emit(Code::power, 1, negative ? -exponent : exponent);
    }
  }
  void primary(int level) {
    skip();
    if (at_ >= text_.size()) return fail("found the end, expected a number, a name or \"(\"");
    const char c = text_[at_];
    if (c == '(') {
      ++at_;
      comparison(level + 1);
      if (error_.empty() && !take(")")) fail("found " + rest() + ", expected \")\"");
    } else if (is_digit(c) || c == '.') {
      number();
    } else if (is_letter(c)) {
      name_or_call(level);
    } else {
      fail("found " + rest() + ", expected a number, a name or \"(\"");
    }
  }
  void number() {
    const std::size_t start = at_;
    const math::DecimalResult number = math::parse_decimal(std::string_view(text_).substr(at_));
    const double value = number.value;
    if (number.length == 0 || !math::is_finite(value)) return fail("found " + rest() + ", expected a number");
    at_ += number.length;
    const std::size_t number_end = at_;
    skip();
    const std::size_t unit = at_;
    // A unit is one run without spaces: letters, ^ with its exponent, and / or * before another letter.
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (is_letter(c) || c == '%')
        ++at_;
      else if (c == '^' && at_ > unit) {
        std::size_t next = at_ + 1;
        if (next < text_.size() && text_[next] == '-') ++next;
        if (next >= text_.size() || !is_digit(text_[next])) break;
        while (next < text_.size() && is_digit(text_[next])) ++next;
        at_ = next;
      } else if ((c == '/' || c == '*') && at_ > unit && at_ + 1 < text_.size() && is_letter(text_[at_ + 1])) {
        ++at_;
      } else {
        break;
      }
    }
    if (at_ == unit) {
      at_ = number_end;
      return emit(Code::constant, 0, value);
    }
    // "600 kg/m^3/water" divides by a name and "2 m*min(" calls a function: what is no unit after the last sign is not
    // part of the unit.
    const auto previous_factor = [&](std::size_t end) {
      const std::size_t sign = text_.find_last_of("/*", end - 1);
      return sign == std::string_view::npos || sign <= unit ? unit : sign;
    };
    if (at_ < text_.size() && text_[at_] == '(' && previous_factor(at_) > unit) at_ = previous_factor(at_);
    core::Result<Quantity> quantity = parse_quantity(text_.substr(start, at_ - start));
    for (std::size_t end = previous_factor(at_); !quantity.ok() && end > unit; end = previous_factor(end)) {
      core::Result<Quantity> shorter = parse_quantity(text_.substr(start, end - start));
      if (!shorter.ok()) continue;
      quantity = shorter;
      at_ = end;
    }
    if (!quantity) {
      at_ = unit;
      return fail(quantity.error().message);
    }
    emit(Code::constant, 0, quantity->value, quantity->dimension);
  }
  void name_or_call(int level) {
    const std::size_t start = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]) || text_[at_] == '.')) ++at_;
    const std::string_view name = text_.substr(start, at_ - start);
    if (take("(")) return call(name, start, level);
    if (name == "pi") return emit(Code::constant, 0, math::pi);
    for (std::size_t i = 0; i < out_.names.size(); ++i)
      if (out_.names[i] == name) return emit(Code::name, 0, 0, {}, int(i));
    out_.names.emplace_back(name);
    emit(Code::name, 0, 0, {}, int(out_.names.size()) - 1);
  }
  void call(std::string_view name, std::size_t start, int level) {
    const Function* function = nullptr;
    for (const Function& f : functions)
      if (f.name == name) function = &f;
    if (function == nullptr) {
      std::vector<std::string_view> known;
      for (const Function& f : functions) known.push_back(f.name);
      at_ = start;
      return fail("found the function " + quote(name) + " that does not exist" + core::did_you_mean(name, known));
    }
    int count = 0;
    do {
      comparison(level + 1);
      ++count;
    } while (error_.empty() && take(","));
    if (!error_.empty()) return;
    if (!take(")")) return fail("found " + rest() + ", expected \",\" or \")\"");
    if (function->arguments >= 0 && count != function->arguments) {
      at_ = start;
      return fail(std::string(name) + " takes " + std::to_string(function->arguments) + " values, found " +
                  std::to_string(count));
    }
    if (count > 8) return fail("random takes at most 8 values");
    emit(function->code, count, 0, {}, count);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  Expression out_;
  std::string error_;
};

int operand_count(const Expression::Operation& op) {
  switch (op.code) {
    case Code::constant:
    case Code::name:
      return 0;
    case Code::random:
      return op.index;
    case Code::select:
      return 3;
    case Code::add:
    case Code::subtract:
    case Code::multiply:
    case Code::divide:
    case Code::less:
    case Code::less_equal:
    case Code::greater:
    case Code::greater_equal:
    case Code::equal:
    case Code::not_equal:
    case Code::minimum:
    case Code::maximum:
    case Code::mod:
    case Code::atan2:
      return 2;
    default:
      return 1;
  }
}

/// Uniform in [0, 1), the same for the same arguments: a hash of their bits (splitmix64's finisher between words).
double random_of(const double* arguments, int count) {
  std::uint64_t state = 0x9E3779B97F4A7C15u;
  for (int i = 0; i < count; ++i) {
    const double value = arguments[i] == 0 ? 0.0 : arguments[i];
    std::uint64_t bits;
    static_assert(sizeof bits == sizeof value);
    __builtin_memcpy(&bits, &value, sizeof bits);
    state ^= bits;
    state = (state ^ state >> 30) * 0xBF58476D1CE4E5B9u;
    state = (state ^ state >> 27) * 0x94D049BB133111EBu;
    state ^= state >> 31;
    state += 0x9E3779B97F4A7C15u;
  }
  return double(state >> 11) * 0x1p-53;
}

double integer_power(double x, int exponent) {
  const double base = exponent < 0 ? 1 / x : x;
  double result = 1;
  for (int i = exponent < 0 ? -exponent : exponent; i > 0; --i) result *= base;
  return result;
}

}  // namespace

core::Result<Expression> parse_expression(std::string_view text) {
  if (text.size() > 4096) return core::Error{"found an expression longer than 4096 characters"};
  return ExpressionParser(text).parse();
}

core::Result<Dimension> check_expression(const Expression& expression, std::span<const Dimension> dimensions) {
  std::vector<Dimension> stack;
  for (const Expression::Operation& op : expression.program) {
    const int count = operand_count(op);
    Dimension arguments[8];
    for (int i = count - 1; i >= 0; --i) {
      arguments[i] = stack.back();
      stack.pop_back();
    }
    const Dimension a = arguments[0], b = arguments[1];
    const auto differ = [&](const char* what) {
      return core::Error{std::string("found ") + describe_dimension(a) + " and " + describe_dimension(b) + ", " + what +
                         " needs two of one kind"};
    };
    Dimension result{};
    switch (op.code) {
      case Code::constant:
        result = op.dimension;
        break;
      case Code::name:
        result = dimensions[std::size_t(op.index)];
        break;
      case Code::negate:
      case Code::abs:
        result = a;
        break;
      case Code::add:
      case Code::subtract:
        if (a != b) return differ("a sum");
        result = a;
        break;
      case Code::minimum:
      case Code::maximum:
        if (a != b) return differ("min or max");
        result = a;
        break;
      case Code::mod:
        if (a != b) return differ("mod");
        result = a;
        break;
      case Code::less:
      case Code::less_equal:
      case Code::greater:
      case Code::greater_equal:
      case Code::equal:
      case Code::not_equal:
        if (a != b) return differ("a comparison");
        break;
      case Code::atan2:
        if (a != b) return differ("atan2");
        break;
      case Code::multiply:
        result = multiply_dimensions(a, b);
        break;
      case Code::divide:
        result = divide_dimensions(a, b);
        break;
      case Code::power: {
        const core::Result<Dimension> raised = raise_dimension(a, int(op.value));
        if (!raised) return raised.error();
        result = *raised;
        break;
      }
      case Code::sqrt: {
        const core::Result<Dimension> root = root_dimension(a);
        if (!root) return root.error();
        result = *root;
        break;
      }
      case Code::select:
        if (b != arguments[2])
          return core::Error{"found " + describe_dimension(b) + " and " + describe_dimension(arguments[2]) +
                             ", both choices of if must be of one kind"};
        result = b;
        break;
      case Code::sin:
      case Code::cos:
      case Code::tan:
      case Code::exp:
      case Code::log:
      case Code::floor:
      case Code::ceil:
        if (a != Dimension{})
          return core::Error{"found " + describe_dimension(a) + ", expected a plain number or angle in a function"};
        break;
      case Code::random:
        break;
    }
    stack.push_back(result);
  }
  return stack.back();
}

double evaluate_expression(const Expression& expression, std::span<const double> values) {
  double stack[72];
  int top = 0;
  for (const Expression::Operation& op : expression.program) {
    const int count = operand_count(op);
    top -= count;
    const double a = count > 0 ? stack[top] : 0, b = count > 1 ? stack[top + 1] : 0;
    double r = 0;
    switch (op.code) {
      case Code::constant:
        r = op.value;
        break;
      case Code::name:
        r = values[std::size_t(op.index)];
        break;
      case Code::negate:
        r = -a;
        break;
      case Code::add:
        r = a + b;
        break;
      case Code::subtract:
        r = a - b;
        break;
      case Code::multiply:
        r = a * b;
        break;
      case Code::divide:
        r = a / b;
        break;
      case Code::power:
        r = integer_power(a, int(op.value));
        break;
      case Code::less:
        r = a < b;
        break;
      case Code::less_equal:
        r = a <= b;
        break;
      case Code::greater:
        r = a > b;
        break;
      case Code::greater_equal:
        r = a >= b;
        break;
      case Code::equal:
        r = a == b;
        break;
      case Code::not_equal:
        r = a != b;
        break;
      case Code::sqrt:
        r = math::sqrt(a);
        break;
      case Code::sin:
        r = math::sin(a);
        break;
      case Code::cos:
        r = math::cos(a);
        break;
      case Code::tan:
        r = math::tan(a);
        break;
      case Code::abs:
        r = math::abs(a);
        break;
      case Code::floor:
        r = __builtin_floor(a);
        break;
      case Code::ceil:
        r = __builtin_ceil(a);
        break;
      case Code::exp:
        r = math::exp(a);
        break;
      case Code::log:
        r = math::log(a);
        break;
      case Code::minimum:
        r = math::min(a, b);
        break;
      case Code::maximum:
        r = math::max(a, b);
        break;
      case Code::mod:
        r = a - b * __builtin_floor(a / b);
        break;
      case Code::atan2:
        r = math::atan2(a, b);
        break;
      case Code::random:
        r = random_of(stack + top, count);
        break;
      case Code::select:
        r = a != 0 ? b : stack[top + 2];
        break;
    }
    stack[top++] = r;
  }
  return stack[0];
}

}  // namespace carom::scene::detail
