// The kernels of grains for 8 lanes.
#include "carom/math/simd_rows.h"
#include "carom/particles/detail/granular_block.h"

#define CAROM_GRAIN_NAMESPACE grains_avx2
#define CAROM_GRAIN_WIDTH 8
#include "carom/particles/detail/granular_kernel.inl"
#undef CAROM_GRAIN_NAMESPACE
#undef CAROM_GRAIN_WIDTH
