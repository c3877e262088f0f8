// The heights of SeaPatch for 8 lanes.
#include "carom/environment/detail/sea_waves.h"
#include "carom/math/simd.h"

#define CAROM_SEA_NAMESPACE sea_avx2
#define CAROM_SEA_WIDTH 8
#include "carom/environment/detail/sea_kernel.inl"
#undef CAROM_SEA_NAMESPACE
#undef CAROM_SEA_WIDTH
