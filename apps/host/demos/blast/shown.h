// What demos of things that break share.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/blast/structure.h"

namespace carom::host::demo {

/// After a structure's after_step: shows its new bodies, and those that lost parts anew.
template <class D>
void show_changes(Stage<D>& stage, const blast::Structure<D>& structure) {
  if (structure.made().empty() && structure.changed().empty()) return;
  stage.adopt_all();
  for (const rigid::BodyId body : structure.changed())
    if (stage.world().contains(body)) stage.redraw(body);
}

/// A shade of its own for each part: `hue` a little lighter or darker.
inline std::uint32_t shade(std::uint32_t hue, std::uint32_t i) {
  const std::uint32_t factor = 200 + (i * 37) % 56;
  const auto channel = [&](int shift) { return math::min((hue >> shift & 255) * factor / 228, 255u) << shift; };
  return 0xff000000u | channel(16) | channel(8) | channel(0);
}

}  // namespace carom::host::demo
