// The pin kernels for 16 lanes.
#include "carom/math/simd.h"
#include "carom/rigid/detail/joint_lanes.h"

#define CAROM_PIN_NAMESPACE pin_kernels_avx512
#define CAROM_PIN_WIDTH 16
#include "carom/rigid/detail/joint_kernel.inl"
#undef CAROM_PIN_NAMESPACE
#undef CAROM_PIN_WIDTH
