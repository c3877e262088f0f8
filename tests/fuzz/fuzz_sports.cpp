// Presets of balls, surfaces, clubs and games from anybody: numbers that can be, or a clear error that names the file.
#include <cstdint>
#include <string_view>

#include "carom/math/elementary.h"
#include "carom/scene/game_presets.h"
#include "carom/scene/sports_presets.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"

FUZZ_TARGET(sports) {
  using namespace carom;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto ball = scene::parse_ball(text, "f");
  require(ball.ok() || ball.error().message.starts_with("f"), "an error that does not name the file");
  if (ball) {
    require(sports::check(*ball).ok(), "a ball that cannot be");
    const auto load =
        sports::air_load(*ball, {}, {.velocity = {30, 5, -3}, .spin = {10, 200, -50}, .turned = 1, .time = 2});
    require(math::is_finite(math::length(load.force)) && math::is_finite(math::length(load.moment)),
            "a force that is not finite");
  }
  const auto surface = scene::parse_surface(text, "f");
  require(surface.ok() || surface.error().message.starts_with("f"), "an error that does not name the file");
  if (surface) {
    const sports::Ball solid;
    const auto out = sports::bounce(solid, *surface, {0, 1, 0}, {.velocity = {12, -9, 2}, .spin = {30, 4, 90}});
    require(math::is_finite(math::length(out.after.velocity)) && out.after.velocity.y >= -1e-9,
            "a bounce that cannot be");
  }
  const auto head = scene::parse_club(text, "f");
  require(head.ok() || head.error().message.starts_with("f"), "an error that does not name the file");
  if (head) {
    const auto hit = sports::strike({}, *head, {});
    if (hit) require(math::is_finite(math::length(hit->ball.velocity)), "a blow that is not finite");
  }
  const auto named = [](const auto& result) {
    require(result.ok() || result.error().message.starts_with("f"), "an error that does not name the file");
    return result.ok();
  };
  if (const auto pitch = scene::parse_pitch(text, "f"); named(pitch)) {
    const auto path = sports::pitch({}, {}, *pitch);
    require(!path || math::is_finite(path->height), "a pitch that is not finite");
  }
  if (const auto bat = scene::parse_bat(text, "f"); named(bat)) {
    const auto out = sports::hit({}, *bat, {.offset = 0}, {.velocity = {38, 0, 0}});
    require(!out || math::is_finite(math::length(out->velocity)), "a hit that is not finite");
  }
  if (const auto delivery = scene::parse_cricket_delivery(text, "f"); named(delivery)) {
    const auto path = sports::deliver({}, {}, {}, *delivery);
    require(!path || math::is_finite(path->side), "a delivery that is not finite");
  }
  const auto weight = scene::parse_bowling_ball(text, "f");
  const auto lane = scene::parse_lane(text, "f");
  const auto thrown = scene::parse_bowling_delivery(text, "f");
  named(weight);
  named(lane);
  named(thrown);
  const auto path = sports::bowl(weight.ok() ? *weight : sports::BowlingBall{}, lane.ok() ? *lane : sports::Lane{},
                                 thrown.ok() ? *thrown : sports::Delivery{});
  require(!path || math::is_finite(path->end().y), "a way down the lane that is not finite");
  if (const auto swing = scene::parse_swing(text, "f"); named(swing))
    require(sports::check(*swing).ok(), "a swing that cannot be");
}
