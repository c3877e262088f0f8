// Corners of hulls, for AVX2.
#include "carom/geometry/detail/corner_lanes.h"
#include "carom/math/simd.h"

#define CAROM_CORNERS_NAMESPACE corner_lanes_avx2
#include "carom/geometry/detail/corner_lanes.inl"
#undef CAROM_CORNERS_NAMESPACE
