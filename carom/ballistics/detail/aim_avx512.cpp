// The lanes of the aim solver, 8 of them.
#include "carom/ballistics/detail/aim_kernel.h"
#include "carom/math/simd_double.h"

#define CAROM_AIM_NAMESPACE aim_avx512
#define CAROM_AIM_WIDTH 8
#include "carom/ballistics/detail/aim_kernel.inl"
#undef CAROM_AIM_NAMESPACE
#undef CAROM_AIM_WIDTH
