// The kernels of the solver of cloth and soft bodies for 16 lanes.
#include "carom/math/simd_double.h"
#include "carom/math/simd_rows.h"
#include "carom/particles/detail/soft_tiles.h"

#define CAROM_SOFT_NAMESPACE soft_avx512
#define CAROM_SOFT_WIDTH 16
#include "carom/particles/detail/soft_kernel.inl"
// What stands on these:
#include "carom/particles/detail/cloth_kernel.inl"
#include "carom/particles/detail/fold_kernel.inl"
#undef CAROM_SOFT_NAMESPACE
#undef CAROM_SOFT_WIDTH
