#include "carom/sports/numbers.h"

#include <array>

#include "carom/sports/detail/number_fields.h"

namespace carom::sports {
namespace {
constexpr std::array<std::string_view, 4> side_names = {"none", "held_seam", "turning_seam", "wandering_wake"};
constexpr std::array<std::string_view, 2> lift_names = {"rational", "hyperbolic"};
}  // namespace

std::string_view to_string(SideForce::Kind kind) { return side_names[std::size_t(kind)]; }
std::string_view to_string(LiftLaw::Shape shape) { return lift_names[std::size_t(shape)]; }

std::span<const NumberName> ball_number_names() { return detail::number_names_of<Ball>(); }
std::span<const NumberName> surface_number_names() { return detail::number_names_of<Surface>(); }
std::span<const NumberName> club_number_names() { return detail::number_names_of<ClubHead>(); }
std::vector<double> ball_numbers(const Ball& ball) { return detail::numbers_of(ball); }
std::vector<double> surface_numbers(const Surface& surface) { return detail::numbers_of(surface); }
std::vector<double> club_numbers(const ClubHead& head) { return detail::numbers_of(head); }

core::Result<Ball> ball_from_numbers(std::span<const Number> numbers, std::string_view side, std::string_view lift) {
  Ball ball;
  if (const core::Status taken = detail::take_numbers(ball, numbers, "a ball"); !taken) return taken.error();
  if (lift != lift_names[0] && lift != lift_names[1])
    return core::Error{
        core::text("the shape of the lift of a ball is ", core::quoted(lift), ", expected rational or hyperbolic")};
  ball.lift.shape = LiftLaw::Shape(lift == lift_names[1]);
  for (std::size_t i = 0; i < side_names.size(); ++i)
    if (side_names[i] == side) {
      ball.side.kind = SideForce::Kind(i);
      return ball;
    }
  return core::Error{core::text("the side force of a ball is ", core::quoted(side),
                                ", expected none, held_seam, turning_seam or wandering_wake")};
}

core::Result<Surface> surface_from_numbers(std::span<const Number> numbers) {
  Surface surface;
  if (const core::Status taken = detail::take_numbers(surface, numbers, "a surface"); !taken) return taken.error();
  return surface;
}

core::Result<ClubHead> club_from_numbers(std::span<const Number> numbers) {
  ClubHead head;
  if (const core::Status taken = detail::take_numbers(head, numbers, "a club head"); !taken) return taken.error();
  return head;
}

}  // namespace carom::sports
