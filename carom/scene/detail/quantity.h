// Quantities as scene files write them, and the kinds of quantity that fields expect.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "carom/core/result.h"
#include "carom/math/units.h"

namespace carom::scene::detail {

using math::Dimension;

struct Quantity {
  double value = 0;  ///< SI
  Dimension dimension{};
};

/// "1200 kg", "1/60 s", "30 deg", "4". Errors name what was not understood.
core::Result<Quantity> parse_quantity(std::string_view text);

Dimension multiply_dimensions(const Dimension& a, const Dimension& b);
Dimension divide_dimensions(const Dimension& a, const Dimension& b);
core::Result<Dimension> raise_dimension(const Dimension& a, int exponent);
core::Result<Dimension> root_dimension(const Dimension& a);
/// "a mass", "a plain number", or "a quantity in kg·m/s".
std::string describe_dimension(const Dimension& dimension);
/// The SI unit as units are written: "m/s^2"; "" for a plain number.
std::string si_unit(const Dimension& dimension);
/// The size of one `unit` in SI units. Errors: unknown, or with an offset (°C).
core::Result<Quantity> parse_unit(std::string_view unit);

/// What a field holds.
enum class Measure : std::uint8_t {
  plain,
  length,
  area,
  time,
  frequency,
  rate,
  mass,
  density,
  inertia,
  speed,
  acceleration,
  angle,
  angular_speed,
  force,
  torque,
  stiffness,
  damping,
  angular_damping,
  quadratic_angular_damping,
  circulation,
  gravitational_parameter,
  pressure,
  viscosity,
  temperature,
  wave_number,
  charge,
  electric_field,
  flux_density,
  mass_per_length,
  mass_per_area,
  rope_bending,
  rope_damping,
  cloth_bending,
  kinematic_viscosity,
  energy,
  count_
};
struct MeasureInfo {
  const char* article;  ///< "a mass"
  const char* unit;     ///< SI, as the units library reads it
  const char* sample;   ///< "1200 kg"
};
const MeasureInfo& measure_info(Measure measure);
const Dimension& measure_dimension(Measure measure);

}  // namespace carom::scene::detail
