#include "carom/scene/detail/quantity.h"

#include "carom/math/decimal.h"
#include "carom/math/vec.h"

namespace carom::scene::detail {
namespace {

constexpr MeasureInfo measures[] = {
    {"a plain number", "", ""},
    {"a length", "m", "2.5 m"},
    {"an area", "m^2", "0.5 m^2"},
    {"a time", "s", "1/60 s"},
    {"a frequency", "Hz", "30 Hz"},
    {"a rate", "1/s", "0.1 1/s"},
    {"a mass", "kg", "1200 kg"},
    {"a density", "kg/m^3", "1000 kg/m^3"},
    {"a moment of inertia", "kg*m^2", "12 kg*m^2"},
    {"a speed", "m/s", "30 mph"},
    {"an acceleration", "m/s^2", "9.81 m/s^2"},
    {"an angle", "rad", "30 deg"},
    {"an angular speed", "rad/s", "20 deg/s"},
    {"a force", "N", "500 N"},
    {"a torque", "N*m", "80 N*m"},
    {"a stiffness", "N/m", "1000 N/m"},
    {"a damping", "N*s/m", "20 N*s/m"},
    {"an angular damping", "N*m*s", "2 N*m*s"},
    {"a quadratic angular damping", "N*m*s^2", "2 N*m*s^2"},
    {"a circulation", "m^2/s", "10 m^2/s"},
    {"a gravitational parameter", "m^3/s^2", "3.986004418e14 m^3/s^2"},
    {"a pressure", "Pa", "1013 hPa"},
    {"a viscosity", "Pa*s", "1.8e-5 Pa*s"},
    {"a temperature difference", "K", "10 K"},
    {"a wave number", "1/m", "0.1 1/m"},
    {"a charge", "C", "2 C"},
    {"an electric field", "V/m", "100 V/m"},
    {"a magnetic flux density", "T", "0.5 T"},
    {"a mass per length", "kg/m", "65 g/m"},
    {"a mass per area", "kg/m^2", "150 g/m^2"},
    {"a bending stiffness", "N*m^2", "0.01 N*m^2"},
    {"a damping of strain", "N*s", "50 N*s"},
    {"a bending stiffness per width", "N*m", "5e-6 N*m"},
    {"a kinematic viscosity", "m^2/s", "1e-6 m^2/s"},
    {"an energy", "J", "4 kJ"},
};
static_assert(sizeof measures / sizeof measures[0] == std::size_t(Measure::count_));

struct MeasureDimensions {
  Dimension of[std::size_t(Measure::count_)];
  MeasureDimensions() {
    for (std::size_t i = 1; i < std::size_t(Measure::count_); ++i)
      of[i] = math::parse_quantity(std::string("1 ") + measures[i].unit).dimension;
  }
};

std::string_view skip_spaces(std::string_view text) {
  while (!text.empty() && (text[0] == ' ' || text[0] == '\t')) text.remove_prefix(1);
  return text;
}

/// Reads "a/b" at the beginning; false where there is none.
bool take_fraction(std::string_view& text, double& value) {
  const std::string_view start = skip_spaces(text);
  const math::DecimalResult above = math::parse_decimal(start);
  if (above.length == 0) return false;
  std::string_view rest = skip_spaces(start.substr(above.length));
  if (rest.empty() || rest[0] != '/') return false;
  rest = skip_spaces(rest.substr(1));
  const math::DecimalResult below = math::parse_decimal(rest);
  if (below.length == 0) return false;
  text = skip_spaces(rest.substr(below.length));
  value = above.value / below.value;
  return true;
}

}  // namespace

core::Result<Quantity> parse_quantity(std::string_view text) {
  double fraction = 0;
  std::string_view unit = text;
  if (take_fraction(unit, fraction)) {
    const math::QuantityResult one = math::parse_quantity(unit.empty() ? std::string("1") : "1 " + std::string(unit));
    if (!one.ok) return core::Error{one.error};
    if (!math::is_finite(fraction * one.si)) return core::Error{"a fraction without a finite value"};
    return Quantity{fraction * one.si, one.dimension};
  }
  const math::QuantityResult result = math::parse_quantity(text);
  if (!result.ok) return core::Error{result.error};
  return Quantity{result.si, result.dimension};
}

Dimension multiply_dimensions(const Dimension& a, const Dimension& b) {
  Dimension d;
  d.mass = std::int8_t(a.mass + b.mass);
  d.length = std::int8_t(a.length + b.length);
  d.time = std::int8_t(a.time + b.time);
  d.temperature = std::int8_t(a.temperature + b.temperature);
  d.current = std::int8_t(a.current + b.current);
  d.angle = std::int8_t(a.angle + b.angle);
  return d;
}
Dimension divide_dimensions(const Dimension& a, const Dimension& b) {
  Dimension d;
  d.mass = std::int8_t(a.mass - b.mass);
  d.length = std::int8_t(a.length - b.length);
  d.time = std::int8_t(a.time - b.time);
  d.temperature = std::int8_t(a.temperature - b.temperature);
  d.current = std::int8_t(a.current - b.current);
  d.angle = std::int8_t(a.angle - b.angle);
  return d;
}
core::Result<Dimension> raise_dimension(const Dimension& a, int exponent) {
  const std::int8_t all[] = {a.mass, a.length, a.time, a.temperature, a.current, a.angle};
  std::int8_t raised[6];
  for (int i = 0; i < 6; ++i) {
    const int e = all[i] * exponent;
    if (e < -100 || e > 100) return core::Error{"found a power too high for its unit"};
    raised[i] = std::int8_t(e);
  }
  return Dimension{raised[0], raised[1], raised[2], raised[3], raised[4], raised[5]};
}
core::Result<Dimension> root_dimension(const Dimension& a) {
  if ((a.mass | a.length | a.time | a.temperature | a.current) & 1)
    return core::Error{"found the square root of " + describe_dimension(a)};
  return Dimension{std::int8_t(a.mass / 2),        std::int8_t(a.length / 2),  std::int8_t(a.time / 2),
                   std::int8_t(a.temperature / 2), std::int8_t(a.current / 2), std::int8_t(a.angle / 2)};
}

std::string describe_dimension(const Dimension& dimension) {
  const std::string text = math::to_string(dimension);
  const std::size_t bracket = text.find('[');
  if (bracket == 0) return "a quantity in " + text.substr(1, text.size() - 2);
  const std::string name = text.substr(0, bracket == std::string::npos ? bracket : bracket - 1);
  const bool vowel = !name.empty() && std::string_view("aeiou").find(name[0]) != std::string_view::npos;
  return (vowel ? "an " : "a ") + name;
}
std::string si_unit(const Dimension& dimension) {
  const std::string text = math::to_string(dimension);
  const std::size_t open = text.find('['), close = text.rfind(']');
  return open == std::string::npos || close == std::string::npos ? std::string()
                                                                 : text.substr(open + 1, close - open - 1);
}

core::Result<Quantity> parse_unit(std::string_view unit) {
  if (unit.empty()) return Quantity{1, Dimension{}};
  const math::QuantityResult one = math::parse_quantity("1 " + std::string(unit));
  if (!one.ok) return core::Error{one.error};
  const math::QuantityResult zero = math::parse_quantity("0 " + std::string(unit));
  if (!zero.ok || zero.si != 0)
    return core::Error{"found " + std::string(unit) + ", a unit that does not begin at zero"};
  return Quantity{one.si, one.dimension};
}

const MeasureInfo& measure_info(Measure measure) { return measures[std::size_t(measure)]; }
const Dimension& measure_dimension(Measure measure) {
  static const MeasureDimensions dimensions;
  return dimensions.of[std::size_t(measure)];
}

}  // namespace carom::scene::detail
