// Billiard presets: tables with their balls and cloth (presets/table), cloths (presets/cloth), cues (presets/cue).
//
// A file has a description, a source and `values`, numbers with units. What it does not say keeps the value that it had
// before, so that a cloth may be laid on any table.
#pragma once

#include <string_view>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/sports/billiards.h"
#include "carom/sports/cue.h"
#include "carom/sports/table.h"

namespace carom::scene {

struct BilliardSetting {
  sports::RectangularTable table{};
  sports::BilliardPhysics physics{};
};

// Errors begin with "name:line:" and say what was found and what was expected: a JSON text that cannot be read, a key
// that is not known, a quantity of the wrong kind, a physics or an outline that the sports room refuses.
CAROM_API core::Result<BilliardSetting> read_billiard_table(std::string_view text, std::string_view name,
                                                            const BilliardSetting& before = {});
CAROM_API core::Result<sports::Cloth> read_cloth(std::string_view text, std::string_view name,
                                                 const sports::Cloth& before = {});
CAROM_API core::Result<sports::Cue> read_cue(std::string_view text, std::string_view name,
                                             const sports::Cue& before = {});

}  // namespace carom::scene
