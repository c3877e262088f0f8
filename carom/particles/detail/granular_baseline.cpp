// The kernels of grains for 4 lanes.
#include "carom/math/simd_rows.h"
#include "carom/particles/detail/granular_block.h"

#define CAROM_GRAIN_NAMESPACE grains_baseline
#define CAROM_GRAIN_WIDTH 4
#include "carom/particles/detail/granular_kernel.inl"
#undef CAROM_GRAIN_NAMESPACE
#undef CAROM_GRAIN_WIDTH
