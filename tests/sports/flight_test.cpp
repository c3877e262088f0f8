// The flight of balls against published numbers and closed forms (shared reference "ballistics", sections 2.10
// to 2.12).
#include "carom/sports/flight.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/presets.h"

namespace sports_flight_test {
using namespace carom;
using namespace carom::sports;

constexpr double degree = math::pi / 180, rpm = math::pi / 30, mph = 0.44704, yard = 0.9144;

TEST(SportsFlight, PresetsFly) {
  for (const BallPreset& preset : ball_presets()) {
    ASSERT_TRUE(check(preset.ball)) << preset.name;
    const auto flight = fly(preset.ball, {}, launch_state({.speed = 30, .elevation = .3, .spin = 100}, {0, 1, 0}));
    ASSERT_TRUE(flight) << flight.error().message;
    EXPECT_GT(landing(*flight).carry, 5) << preset.name;
  }
}

}  // namespace sports_flight_test
