// The contact kernels for 8 lanes.
#include "carom/math/simd.h"
#include "carom/rigid/detail/contact_block.h"

#define CAROM_CONTACT_NAMESPACE contact_kernels_avx2
#define CAROM_CONTACT_WIDTH 8
#include "carom/rigid/detail/contact_kernel.inl"
#undef CAROM_CONTACT_NAMESPACE
#undef CAROM_CONTACT_WIDTH
