// The contact kernels for 4 lanes.
#include "carom/math/simd.h"
#include "carom/rigid/detail/contact_block.h"

#define CAROM_CONTACT_NAMESPACE contact_kernels_baseline
#define CAROM_CONTACT_WIDTH 4
#include "carom/rigid/detail/contact_kernel.inl"
#undef CAROM_CONTACT_NAMESPACE
#undef CAROM_CONTACT_WIDTH
