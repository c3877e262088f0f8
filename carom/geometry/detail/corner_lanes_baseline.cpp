// Corners of hulls, for the least that every processor has.
#include "carom/geometry/detail/corner_lanes.h"
#include "carom/math/simd.h"

#define CAROM_CORNERS_NAMESPACE corner_lanes_baseline
#include "carom/geometry/detail/corner_lanes.inl"
#undef CAROM_CORNERS_NAMESPACE
