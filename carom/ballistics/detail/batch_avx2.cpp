// The step of ProjectileBatch for 8 lanes.
#include "carom/ballistics/detail/batch_step.h"
#include "carom/math/simd.h"

#define CAROM_BATCH_NAMESPACE batch_avx2
#define CAROM_BATCH_WIDTH 8
#include "carom/ballistics/detail/batch_kernel.inl"
#undef CAROM_BATCH_NAMESPACE
#undef CAROM_BATCH_WIDTH
