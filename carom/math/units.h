// Physical quantities as text: "30 mph", "7.62 mm", "1200 kg/m^3", "25 degC", "14.7 psi", "4 kg·m²".
//
// A quantity is a number and a product of units: names joined by `*`, `·`, `/` or a space, each with an exponent (`^2`,
// `^-1`, `²`), groups in parentheses. SI units take the SI prefixes. A division binds to the one factor behind it, as
// in arithmetic: "J/kg/K" and "J/(kg*K)" are the same. Files and the command line use this; inside the library all is
// SI.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "carom/export.h"

namespace carom::math {

/// Exponents of the base quantities. Angles have no dimension; their exponent is kept for messages, and to tell an
/// angular velocity from a frequency.
struct Dimension {
  std::int8_t mass{}, length{}, time{}, temperature{}, current{};
  std::int8_t angle{};

  friend constexpr bool operator==(const Dimension& a, const Dimension& b) {
    return a.mass == b.mass && a.length == b.length && a.time == b.time && a.temperature == b.temperature &&
           a.current == b.current;
  }
};

namespace dimensions {
inline constexpr Dimension none{}, mass{1}, length{0, 1}, time{0, 0, 1}, temperature{0, 0, 0, 1},
    current{0, 0, 0, 0, 1};
inline constexpr Dimension angle{0, 0, 0, 0, 0, 1}, angular_velocity{0, 0, -1, 0, 0, 1};
inline constexpr Dimension angular_acceleration{0, 0, -2, 0, 0, 1}, frequency{0, 0, -1};
inline constexpr Dimension speed{0, 1, -1}, acceleration{0, 1, -2}, area{0, 2}, volume{0, 3};
inline constexpr Dimension force{1, 1, -2}, torque{1, 2, -2}, energy{1, 2, -2}, power{1, 2, -3}, pressure{1, -1, -2};
inline constexpr Dimension momentum{1, 1, -1}, angular_momentum{1, 2, -1}, moment_of_inertia{1, 2};
inline constexpr Dimension density{1, -3}, stiffness{1, 0, -2}, damping{1, 0, -1}, rotational_stiffness{1, 2, -2};
inline constexpr Dimension dynamic_viscosity{1, -1, -1}, kinematic_viscosity{0, 2, -1}, voltage{1, 2, -3, 0, -1};
}  // namespace dimensions

/// "speed [m/s]", "mass [kg]", "plain number", or only the units where the dimension has no common name: "[kg*m^4/s]".
CAROM_API std::string to_string(Dimension d);

struct QuantityResult {
  bool ok{};
  double si{};            ///< in SI base units, radians and kelvins
  Dimension dimension{};  ///< of what was found
  std::string error;      ///< what was found and what was expected; empty where ok
};

/// Parse a quantity of any dimension. A number alone is a plain number; "50 %" is 0.5. Conversion is correct to 1 ulp.
/// A lone degC or degF is a temperature (25 degC is 298.15 K); within a product ("W/m^2/degC") and as delta_degC or
/// delta_degF it is a difference. Infinities, overflow and names that are no unit are errors.
CAROM_API QuantityResult parse_quantity(std::string_view text);

/// The same, and an error unless it has the expected dimension. A frequency in Hz is not taken for an angular velocity
/// nor the reverse, because they differ by 2π.
CAROM_API QuantityResult parse_quantity(std::string_view text, Dimension expected);

/// Text of an SI value in the given unit, such as format_quantity(13.4112, "mph") = "30 mph": the fewest digits that
/// parse back to the same double, or seventeen. An empty unit gives the bare number. Empty where `unit` is not a unit.
CAROM_API std::string format_quantity(double si, std::string_view unit);
/// With a fixed number of significant digits (1 to 17).
CAROM_API std::string format_quantity(double si, std::string_view unit, int digits);

/// value in `from` expressed in `to`, as in convert(1, "slug", "kg"); the error tells why not.
CAROM_API QuantityResult convert(double value, std::string_view from, std::string_view to);

/// All unit names without prefixes, for completion and documentation, in the order of the table.
CAROM_API std::vector<std::string_view> unit_names();

}  // namespace carom::math
