// How these demos draw ropes.
#pragma once

#include "apps/host/stage.h"
#include "carom/particles/rope.h"

namespace carom::host::demo {

/// A rope as beads so close that they make a round line.
inline void draw_rope(StageBase& stage, const particles::RopeSet& ropes, int rope, std::uint32_t rgba) {
  const auto positions = ropes.positions(rope);
  const auto broken = ropes.broken(rope);
  std::vector<math::Vec3f> beads;
  const double radius = ropes.material(rope).radius;
  for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
    if (broken[i]) continue;
    const int pieces = math::clamp(int(math::distance(positions[i], positions[i + 1]) / (0.8 * radius)), 1, 24);
    for (int k = 0; k < pieces; ++k)
      beads.push_back(math::Vec3f(math::lerp(positions[i], positions[i + 1], double(k) / pieces)));
  }
  if (!positions.empty()) beads.push_back(math::Vec3f(positions.back()));
  stage.points(beads, float(radius), rgba);
}

}  // namespace carom::host::demo
