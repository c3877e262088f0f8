// Billiard presets from anybody: a table that can be played on, or a clear error that names the place.
#include <cstdint>
#include <string_view>

#include "carom/scene/billiards.h"
#include "carom/sports/billiards_engine.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"

FUZZ_TARGET(billiards) {
  using namespace carom;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto setting = scene::read_billiard_table(text, "f");
  require(setting.ok() || setting.error().message.starts_with("f:"), "an error that does not name the file");
  if (setting) {
    const auto table = sports::BilliardTable::create(setting->table);
    require(table.ok(), "a table that was read cannot be made");
    auto game = sports::Billiards::create(*table, setting->physics, {.most_events = 500});
    require(game.ok(), "a physics that was read is refused");
    if (game->place(std::vector<math::Vec2d>{{0, 0}}) && game->strike(0, {.direction = 0.7, .speed = 2, .side = 0.2})) {
      const core::Status ran = game->run(20);
      if (ran) require(is_finite(game->state(0).position), "a ball that is nowhere");
    }
  }
  const auto cloth = scene::read_cloth(text, "f");
  require(cloth.ok() || cloth.error().message.starts_with("f:"), "an error that does not name the file");
  const auto cue = scene::read_cue(text, "f");
  require(cue.ok() || cue.error().message.starts_with("f:"), "an error that does not name the file");
}
