#include "carom/scene/sports_presets.h"

#include "carom/core/string.h"
#include "carom/scene/detail/preset_values.h"

namespace carom::scene {
namespace {
using detail::read_preset;

}  // namespace

core::Result<sports::Ball> parse_ball(std::string_view text, std::string_view file) {
  static constexpr std::string_view names[] = {"side_kind", "lift_shape"};
  const auto values = read_preset(text, file, sports::ball_number_names(), names);
  if (!values) return values.error();
  auto ball = sports::ball_from_numbers(values->numbers, values->text("side_kind", "none"),
                                        values->text("lift_shape", "rational"));
  return ball ? std::move(ball) : core::Result<sports::Ball>(detail::in_file(file, ball.error()));
}

core::Result<sports::Surface> parse_surface(std::string_view text, std::string_view file) {
  const auto values = read_preset(text, file, sports::surface_number_names(), {});
  if (!values) return values.error();
  auto surface = sports::surface_from_numbers(values->numbers);
  return surface ? std::move(surface) : core::Result<sports::Surface>(detail::in_file(file, surface.error()));
}

core::Result<sports::ClubHead> parse_club(std::string_view text, std::string_view file) {
  const auto values = read_preset(text, file, sports::club_number_names(), {});
  if (!values) return values.error();
  auto head = sports::club_from_numbers(values->numbers);
  return head ? std::move(head) : core::Result<sports::ClubHead>(detail::in_file(file, head.error()));
}

}  // namespace carom::scene
