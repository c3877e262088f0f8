// The pin kernels for 8 lanes.
#include "carom/math/simd.h"
#include "carom/rigid/detail/joint_lanes.h"

#define CAROM_PIN_NAMESPACE pin_kernels_avx2
#define CAROM_PIN_WIDTH 8
#include "carom/rigid/detail/joint_kernel.inl"
#undef CAROM_PIN_NAMESPACE
#undef CAROM_PIN_WIDTH
