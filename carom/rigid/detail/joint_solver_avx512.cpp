// The kernels of pins, limbs, flights, bodies of space and ends of steps for 16 lanes.
#include "carom/math/simd.h"
#include "carom/math/simd_double.h"
#include "carom/rigid/detail/kernels.h"

#define CAROM_PIN_NAMESPACE pin_kernels_avx512
#define CAROM_PIN_WIDTH 16
#include "carom/rigid/detail/lane_kernels.inl"
#undef CAROM_PIN_NAMESPACE
#undef CAROM_PIN_WIDTH
