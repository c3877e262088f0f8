// The kernels of pins, limbs, flights, bodies of space and ends of steps for 4 lanes.
#include "carom/math/simd.h"
#include "carom/math/simd_double.h"
#include "carom/rigid/detail/kernels.h"

#define CAROM_PIN_NAMESPACE pin_kernels_baseline
#define CAROM_PIN_WIDTH 4
#include "carom/rigid/detail/lane_kernels.inl"
#undef CAROM_PIN_NAMESPACE
#undef CAROM_PIN_WIDTH
