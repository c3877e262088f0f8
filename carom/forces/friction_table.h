// A table of friction pairs for designers (chapter 3.3).
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "carom/export.h"

namespace carom::forces {

/// Dry unless stated. Clean, oiled, worn or warm surfaces differ by a third and more: starting values, not constants.
struct PairFriction {
  std::string_view first, second;
  double static_coefficient;
  double kinetic_coefficient;
};
/// After Avallone & Baumeister (eds.), Marks' Standard Handbook for Mechanical Engineers, table 3.2.1, and for rubber,
/// ice, snow and concrete the ranges of vehicle dynamics (T. D. Gillespie, Fundamentals of Vehicle Dynamics, 1992).
CAROM_API std::span<const PairFriction> friction_table();
/// The pair in either order; empty where the table does not have it.
CAROM_API std::optional<PairFriction> find_friction(std::string_view first, std::string_view second);

}  // namespace carom::forces
