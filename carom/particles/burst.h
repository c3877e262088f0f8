// A burst with an exact budget: equal masses flying apart with no momentum between them and a given energy (chapters
// 2.7 and 18.7).
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::particles {

struct BurstDef {
  int count = 1000;          ///< ≥ 2
  math::Vec3d center{};      ///< m
  math::Vec3d velocity{};    ///< m/s, of the centre
  double energy = 0;         ///< J in the centre's frame; 0: `speed` counts
  double speed = 10;         ///< m/s: energy is count · ½ m speed²
  double mass = 1e-3;        ///< kg, of one
  bool equal_speeds = true;  ///< false: speeds uniform in velocity space up to a greatest one
  bool planar = false;       ///< in the plane z = 0
  std::uint64_t seed = 1;
};

/// Velocities (m/s) in the frame of the centre. They come in opposite pairs, an odd count with one triple of equal
/// angles, so that their sum is zero to rounding; speeds are scaled to the energy. Errors name a field that cannot be.
CAROM_API core::Result<std::vector<math::Vec3d>> burst_velocities(const BurstDef& definition);

/// Where a particle of the burst is after `time` without air: on a sphere of radius |w| t about the falling centre.
constexpr math::Vec3d burst_position(const BurstDef& definition, math::Vec3d w, math::Vec3d gravity, double time) {
  return definition.center + definition.velocity * time + gravity * (0.5 * time * time) + w * time;
}

}  // namespace carom::particles
