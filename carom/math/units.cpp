#include "carom/math/units.h"

#include "carom/math/decimal.h"
#include "carom/math/detail/unit_table.h"

namespace carom::math {
namespace detail {
namespace {

struct NamedDimension {
  Dimension dimension;
  std::string_view name, unit, example;
};
constexpr NamedDimension named_dimensions[] = {
    {dimensions::angle, "angle", "rad", "45 deg"},
    {dimensions::none, "plain number", "", "0.5"},
    {dimensions::mass, "mass", "kg", "1200 kg"},
    {dimensions::length, "length", "m", "2.5 m"},
    {dimensions::time, "time", "s", "20 ms"},
    {dimensions::temperature, "temperature", "K", "20 degC"},
    {dimensions::current, "electric current", "A", "2 A"},
    {dimensions::angular_velocity, "angular velocity", "rad/s", "30 rpm"},
    {dimensions::frequency, "frequency", "Hz", "50 Hz"},
    {dimensions::angular_acceleration, "angular acceleration", "rad/s^2", "3 rad/s^2"},
    {dimensions::speed, "speed", "m/s", "30 mph"},
    {dimensions::acceleration, "acceleration", "m/s^2", "9.81 m/s^2"},
    {dimensions::area, "area", "m^2", "2 m^2"},
    {dimensions::volume, "volume", "m^3", "3 L"},
    {dimensions::force, "force", "N", "10 kN"},
    {dimensions::energy, "energy or torque", "N*m", "1.5 N*m"},
    {dimensions::power, "power", "W", "150 hp"},
    {dimensions::pressure, "pressure", "Pa", "1 atm"},
    {dimensions::momentum, "momentum", "kg*m/s", "5 kg*m/s"},
    {dimensions::angular_momentum, "angular momentum", "kg*m^2/s", "5 kg*m^2/s"},
    {dimensions::moment_of_inertia, "moment of inertia", "kg*m^2", "4 kg*m^2"},
    {dimensions::density, "density", "kg/m^3", "1000 kg/m^3"},
    {dimensions::stiffness, "stiffness", "N/m", "20 kN/m"},
    {dimensions::damping, "damping coefficient", "N*s/m", "300 N*s/m"},
    {dimensions::dynamic_viscosity, "dynamic viscosity", "Pa*s", "1 mPa*s"},
    {dimensions::kinematic_viscosity, "kinematic viscosity", "m^2/s", "1 cSt"},
    {dimensions::voltage, "voltage", "V", "12 V"},
};

const NamedDimension* named(Dimension d) {
  const NamedDimension* found = nullptr;
  for (const NamedDimension& n : named_dimensions) {
    if (!(n.dimension == d)) continue;
    if (n.dimension.angle == d.angle) return &n;
    if (found == nullptr) found = &n;
  }
  return found;
}

std::string base_units(Dimension d) {
  const std::pair<std::string_view, int> factors[] = {
      {"kg", d.mass}, {"m", d.length}, {"s", d.time}, {"K", d.temperature}, {"A", d.current}};
  std::string above, below;
  for (const auto& [name, exponent] : factors) {
    if (exponent == 0) continue;
    std::string& side = exponent > 0 ? above : below;
    if (exponent > 0 && !side.empty()) side += "*";
    if (exponent < 0) side += "/";
    side += name;
    const int size = exponent > 0 ? exponent : -exponent;
    if (size > 1) side += "^" + std::to_string(size);
  }
  return (above.empty() ? "1" : above) + below;
}

bool add_exponent(std::int8_t& to, int exponent) {
  const int sum = to + exponent;
  to = static_cast<std::int8_t>(clamp(sum, -100, 100));
  return sum == to;
}

class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  UnitResult parse() {
    UnitResult r;
    skip_spaces();
    if (at_end()) {
      r.ok = true;
      return r;
    }
    r.unit = product_of_factors(0);
    if (error_.empty() && !at_end()) fail("a stray '" + std::string(1, text_[at_]) + "'");
    if (error_.empty() && !(is_finite(r.unit.scale.hi) && r.unit.scale.hi > 0))
      fail("a factor that no double can hold");
    r.ok = error_.empty();
    r.error = error_;
    return r;
  }

 private:
  bool at_end() const { return at_ >= text_.size(); }
  bool starts_with(std::string_view s) const { return text_.substr(at_, s.size()) == s; }
  bool take(std::string_view s) {
    if (!starts_with(s)) return false;
    at_ += s.size();
    return true;
  }
  void skip_spaces() {
    while (!at_end() && (text_[at_] == ' ' || text_[at_] == '\t' || starts_with("\u00a0")))
      at_ += text_[at_] == '\xc2' ? 2 : 1;
  }
  void fail(const std::string& what) {
    if (error_.empty()) error_ = "found " + what + " in the unit '" + std::string(text_) + "'";
  }

  Unit product_of_factors(int depth) {
    Unit result;
    int factors = 0;
    bool divide = take("/");  // "5 /s"
    for (;;) {
      skip_spaces();
      Unit f = factor(depth);
      if (!error_.empty()) return result;
      ++factors;
      if (factors == 1 && !divide) {
        result = f;
      } else {
        if (divide) f = power_of(f, -1);
        result = times(result, f);
        result.offset = 0;  // in a product a degree is a difference
      }
      skip_spaces();
      divide = false;
      if (take("*") || take("·") || take("⋅") || take("×")) continue;
      if (take("/")) {
        divide = true;
        continue;
      }
      if (at_end() || text_[at_] == ')') return result;
      if (factors > 40) {
        fail("more than forty factors");
        return result;
      }
    }
  }

  Unit factor(int depth) {
    Unit u;
    if (take("(")) {
      if (depth > 8) {
        fail("parentheses nested deeper than eight");
        return u;
      }
      u = product_of_factors(depth + 1);
      if (error_.empty() && !take(")")) fail("no closing parenthesis");
    } else if (starts_with("1/")) {
      ++at_;  // "1/s"
    } else {
      const std::size_t begin = at_;
      while (!at_end() && is_name_character()) ++at_;
      const std::string_view name = text_.substr(begin, at_ - begin);
      if (name.empty()) {
        fail(at_end() ? "an end where a unit name was expected"
                      : "'" + std::string(1, text_[at_]) + "' where a unit name was expected");
        return u;
      }
      if (!find_unit(name, u)) {
        const std::string near = nearest_unit(name);
        fail("'" + std::string(name) + "', which is no unit known here" +
             (near.empty() ? "," : " (did you mean '" + near + "'?),"));
        return u;
      }
    }
    const int e = exponent();
    return e == 1 ? u : power_of(u, e);
  }

  /// Letters, %, _, and every byte of a longer UTF-8 character that is no operator or superscript; digits inside a
  /// name.
  bool is_name_character() const {
    const char c = text_[at_];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_';
    if (letter) return true;
    if (c == '0') return at_ > 0 && text_[at_ - 1] == 'g';  // g0, the standard acceleration of gravity
    if (static_cast<unsigned char>(c) < 0x80) return false;
    for (const std::string_view s : {"·", "⋅", "×", "²", "³", "¹", "⁰", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹", "⁻", "\u00a0"}) {
      if (starts_with(s)) return false;
    }
    return true;
  }

  int exponent() {
    int value = 0, digits = 0;
    bool negative = false;
    if (take("**") || take("^")) {
      const bool grouped = take("(");
      if (take("-"))
        negative = true;
      else if (take("−"))
        negative = true;
      else
        take("+");
      for (; !at_end() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_, ++digits)
        value = clamp(10 * value + text_[at_] - '0', 0, 1000);
      if (grouped && !take(")")) fail("no closing parenthesis");
      if (digits == 0) fail("no whole number behind '^'");
    } else {
      constexpr std::string_view superscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
      negative = take("⁻");
      for (bool found = true; found;) {
        found = false;
        for (int d = 0; d < 10 && !found; ++d) {
          found = take(superscripts[d]);
          if (found) value = clamp(10 * value + d, 0, 1000), ++digits;
        }
      }
      if (digits == 0 && negative) fail("no digit behind '⁻'");
      if (digits == 0) return 1;
    }
    if (value > 20) fail("an exponent above 20");
    return negative ? -value : value;
  }

  Unit times(Unit a, const Unit& b) {
    const double direct = a.scale.hi * b.scale.hi;
    a.scale = is_finite(direct) && direct != 0 ? product(a.scale, b.scale) : Pair{direct, 0};
    bool fits = add_exponent(a.dimension.mass, b.dimension.mass);
    fits &= add_exponent(a.dimension.length, b.dimension.length);
    fits &= add_exponent(a.dimension.time, b.dimension.time);
    fits &= add_exponent(a.dimension.temperature, b.dimension.temperature);
    fits &= add_exponent(a.dimension.current, b.dimension.current);
    fits &= add_exponent(a.dimension.angle, b.dimension.angle);
    if (!fits) fail("an exponent above 100");
    a.counts_cycles = a.counts_cycles || b.counts_cycles;
    return a;
  }

  Unit power_of(const Unit& u, int exponent) {
    Unit base = u, result;
    base.offset = 0;
    if (exponent < 0) {
      base.scale = quotient({1, 0}, u.scale);
      for (std::int8_t* e : {&base.dimension.mass, &base.dimension.length, &base.dimension.time,
                             &base.dimension.temperature, &base.dimension.current, &base.dimension.angle}) {
        *e = static_cast<std::int8_t>(-*e);
      }
    }
    for (int i = exponent < 0 ? -exponent : exponent; i > 0; --i) result = times(result, base);
    return result;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string error_;
};

std::string quoted(std::string_view text) {
  return "'" + std::string(text.substr(0, 80)) + (text.size() > 80 ? "…" : "") + "'";
}

std::string with_article(Dimension d) {
  const std::string text = to_string(d);
  return (std::string_view("aeiou").find(text.front()) != std::string_view::npos ? "an " : "a ") + text;
}

std::string expectation(Dimension d) {
  const NamedDimension* n = named(d);
  if (n == nullptr) return "a quantity in " + base_units(d);
  return with_article(d) + ", such as '" + std::string(n->example) + "'";
}

/// (value + offset) · scale, rounded once.
double to_si(double value, const Unit& u) {
  const Pair v = u.offset != 0 ? two_sum(value, u.offset) : Pair{value, 0};
  const double direct = v.hi * u.scale.hi;
  if (!(magnitude(direct) < 0x1p990 && magnitude(value) < 0x1p990 && magnitude(direct) > 0x1p-900)) return direct;
  const Pair p = product(v, u.scale);
  return p.hi + p.lo;
}
double from_si(double si, const Unit& u) {
  const double direct = si / u.scale.hi;
  if (!(magnitude(direct) < 0x1p990 && magnitude(si) < 0x1p990 && magnitude(direct) > 0x1p-900 &&
        magnitude(si) > 0x1p-900)) {
    return direct - u.offset;
  }
  const Pair q = sum(quotient({si, 0}, u.scale), {-u.offset, 0});
  return q.hi + q.lo;
}

std::string join(const std::string& number, std::string_view unit) {
  return unit.empty() ? number : number + (unit.front() == '/' ? "" : " ") + std::string(unit);
}

QuantityResult failure(const std::string& message) {
  QuantityResult r;
  r.error = message;
  return r;
}

struct Parsed {
  QuantityResult result;
  Unit unit;
};

Parsed parse_number_and_unit(std::string_view text) {
  std::string_view t = text;
  while (!t.empty() && (t.front() == ' ' || t.front() == '\t')) t.remove_prefix(1);
  while (!t.empty() && (t.back() == ' ' || t.back() == '\t')) t.remove_suffix(1);
  Parsed p;
  std::string unicode_minus;
  if (t.substr(0, 3) == "−") {
    unicode_minus = "-" + std::string(t.substr(3));
    t = unicode_minus;
  }
  const DecimalResult number = parse_decimal(t);
  if (number.length == 0) {
    p.result = failure("quantity " + quoted(text) + ": found no number at its start, expected one such as '30 mph'");
    return p;
  }
  const UnitResult unit = parse_unit(t.substr(number.length));
  if (!unit.ok) {
    p.result = failure("quantity " + quoted(text) + ": " + unit.error);
    return p;
  }
  p.unit = unit.unit;
  p.result.si = to_si(number.value, unit.unit);
  p.result.dimension = unit.unit.dimension;
  p.result.ok = is_finite(p.result.si);
  if (!p.result.ok) p.result.error = "quantity " + quoted(text) + ": the value is beyond the largest double, 1.8e308";
  return p;
}

}  // namespace

UnitResult parse_unit(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return UnitParser(text).parse();
}

}  // namespace detail

std::string to_string(Dimension d) {
  const detail::NamedDimension* n = detail::named(d);
  if (n == nullptr) return "[" + detail::base_units(d) + "]";
  return std::string(n->name) + (n->unit.empty() ? "" : " [" + std::string(n->unit) + "]");
}

QuantityResult parse_quantity(std::string_view text) { return detail::parse_number_and_unit(text).result; }

QuantityResult parse_quantity(std::string_view text, Dimension expected) {
  const detail::Parsed p = detail::parse_number_and_unit(text);
  if (!p.result.ok) return p.result;
  const std::string where = "quantity " + detail::quoted(text) + ": ";
  if (!(p.result.dimension == expected)) {
    return detail::failure(where + "found " + detail::with_article(p.result.dimension) + ", expected " +
                           detail::expectation(expected));
  }
  if (expected == dimensions::frequency) {
    const bool turns = p.result.dimension.angle != 0;
    if (expected.angle != 0 && !turns && p.unit.counts_cycles) {
      return detail::failure(where + "Hz counts cycles; an angular velocity is written in rad/s, rpm or rev/s");
    }
    if (expected.angle == 0 && turns) {
      return detail::failure(where + "found an angular velocity, expected a frequency in Hz, which counts cycles");
    }
  }
  return p.result;
}

std::string format_quantity(double si, std::string_view unit) {
  const detail::UnitResult u = detail::parse_unit(unit);
  if (!u.ok) return {};
  const double value = detail::from_si(si, u.unit);
  if (!is_finite(value)) return detail::join(format_decimal(value), unit);
  // The conversion rounds, so the value itself may carry a stray last digit that the shortest equal text has not.
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = format_decimal(value, digits);
    const double shorter = parse_decimal(text).value;
    if (detail::to_si(shorter, u.unit) == si) return detail::join(format_decimal(shorter), unit);
  }
  return detail::join(format_decimal(value), unit);
}

std::string format_quantity(double si, std::string_view unit, int digits) {
  const detail::UnitResult u = detail::parse_unit(unit);
  if (!u.ok) return {};
  return detail::join(format_decimal(detail::from_si(si, u.unit), digits), unit);
}

QuantityResult convert(double value, std::string_view from, std::string_view to) {
  const std::string where = "conversion from '" + std::string(from) + "' to '" + std::string(to) + "': ";
  if (!is_finite(value)) return detail::failure(where + "the value is not finite");
  const detail::UnitResult a = detail::parse_unit(from), b = detail::parse_unit(to);
  if (!a.ok) return detail::failure(where + a.error);
  if (!b.ok) return detail::failure(where + b.error);
  if (!(a.unit.dimension == b.unit.dimension)) {
    return detail::failure(where + "found " + detail::with_article(a.unit.dimension) + ", expected " +
                           detail::expectation(b.unit.dimension));
  }
  QuantityResult r;
  r.si = detail::from_si(detail::to_si(value, a.unit), b.unit);
  r.dimension = b.unit.dimension;
  r.ok = is_finite(r.si);
  if (!r.ok) r.error = where + "the result is beyond the largest double, 1.8e308";
  return r;
}

}  // namespace carom::math
