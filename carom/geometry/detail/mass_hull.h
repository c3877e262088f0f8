#pragma once

#include "carom/geometry/detail/volume_integrals.h"
#include "carom/geometry/hull.h"

namespace carom::geometry::detail {

/// The hull with its radius, exactly, relative to `origin`.
VolumeIntegrals integrate_hull(const Hull& hull, Vec3d origin);

}  // namespace carom::geometry::detail
