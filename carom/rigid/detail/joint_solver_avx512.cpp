// The kernels of pins, limbs, flights, bodies of space and ends of steps for 16 lanes.
#include "carom/math/simd.h"
#include "carom/math/simd_double.h"
#include "carom/rigid/detail/flight_lanes.h"
#include "carom/rigid/detail/joint_lanes.h"
#include "carom/rigid/detail/joint_limb_lanes.h"
#include "carom/rigid/detail/move_lanes.h"
#include "carom/rigid/detail/step_end_lanes.h"

#define CAROM_PIN_NAMESPACE pin_kernels_avx512
#define CAROM_PIN_WIDTH 16
#include "carom/rigid/detail/flight_kernel.inl"
#include "carom/rigid/detail/joint_kernel.inl"
#include "carom/rigid/detail/joint_limb_kernel.inl"
#include "carom/rigid/detail/move_kernel.inl"
#include "carom/rigid/detail/step_end_kernel.inl"
#undef CAROM_PIN_NAMESPACE
#undef CAROM_PIN_WIDTH
