// A box in pieces, for the tests of what holds together.
#pragma once

#include <cstdint>

#include "carom/blast/fracture.h"
#include "carom/blast/pattern.h"

namespace carom::blast::test {

inline Fracture block(math::Vec3d half, int count, std::uint64_t seed) {
  const ConvexCell box(geometry::Bounds3d{-half, half});
  return fracture_convex(voronoi_pattern(box, uniform_sites(box, count, seed)).value(), {.meshes = false}).value();
}

}  // namespace carom::blast::test
