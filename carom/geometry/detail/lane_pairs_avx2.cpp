// Pairs of convex shapes of the plane for 8 lanes.
#include "carom/geometry/detail/lane_pairs.h"
#include "carom/math/simd.h"

#define CAROM_PAIRS_NAMESPACE lane_pairs_avx2
#define CAROM_PAIRS_WIDTH 8
#include "carom/geometry/detail/lane_pairs.inl"
#undef CAROM_PAIRS_NAMESPACE
#undef CAROM_PAIRS_WIDTH
