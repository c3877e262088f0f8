// Balls, surfaces and club heads from named numbers and back: what files and tables are read through.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "carom/sports/ball.h"
#include "carom/sports/bounce.h"
#include "carom/sports/golf_impact.h"

namespace carom::sports {

/// A number with its name, as a file holds it: "drag_crisis", SI.
struct Number {
  std::string_view name;
  double value = 0;
};
/// Names and SI units of the numbers, for readers and schemas.
struct NumberName {
  std::string_view name, unit;
};
CAROM_API std::span<const NumberName> ball_number_names();
CAROM_API std::span<const NumberName> surface_number_names();
CAROM_API std::span<const NumberName> club_number_names();
/// The numbers of one, in the order of the names.
CAROM_API std::vector<double> ball_numbers(const Ball& ball);
CAROM_API std::vector<double> surface_numbers(const Surface& surface);
CAROM_API std::vector<double> club_numbers(const ClubHead& head);

/// A ball from named numbers; those that are not named stay as in a `Ball`. `side` says which side force, by the names
/// none, held_seam, turning_seam, wandering_wake; `lift` the shape of the lift, rational or hyperbolic. Errors: an
/// unknown name, a number named twice, or one that cannot be.
CAROM_API core::Result<Ball> ball_from_numbers(std::span<const Number> numbers, std::string_view side = "none",
                                               std::string_view lift = "rational");
CAROM_API core::Result<Surface> surface_from_numbers(std::span<const Number> numbers);
CAROM_API core::Result<ClubHead> club_from_numbers(std::span<const Number> numbers);
CAROM_API std::string_view to_string(SideForce::Kind kind);
CAROM_API std::string_view to_string(LiftLaw::Shape shape);

}  // namespace carom::sports
