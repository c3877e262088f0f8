// A face of a cloth or a soft body before a shape that may meet it between its corners.
#pragma once

#include "carom/particles/detail/soft_thing.h"

namespace carom::particles::detail {

struct SoftFaceView {
  Vec3d corner{};    ///< m, the first
  Vec3f u{}, v{};    ///< m, to the others
  Vec3f outward{};   ///< as the corners go round
  Vec3f to_shape{};  ///< the same, or its opposite: where the shape is or comes from
  float margin = 0;  ///< m, that the shape may come beyond `apart` in a substep
};

/// False where the shape does not come there in h.
bool view_face(const SoftThing& thing, const SoftObstacles::Shape& shape, Vec3d middle, const std::uint32_t* corner,
               float h, SoftFaceView& face);

/// Where a shape is nearest to the edge between two vertices, or deepest in it: the share of the second.
float meet_edge(const SoftThing& thing, const SoftObstacles::Shape& shape, std::uint32_t first, std::uint32_t second,
                SoftPlane& plane);

}  // namespace carom::particles::detail
