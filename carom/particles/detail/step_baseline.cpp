// The kernels of a particle step for 4 lanes.
#include "carom/math/simd.h"
#include "carom/particles/detail/step_data.h"

#define CAROM_PARTICLE_NAMESPACE particles_baseline
#define CAROM_PARTICLE_WIDTH 4
#include "carom/particles/detail/lanes.inl"
// The functions above first.
#include "carom/particles/detail/collide_kernel.inl"
#include "carom/particles/detail/move_kernel.inl"
#undef CAROM_PARTICLE_NAMESPACE
#undef CAROM_PARTICLE_WIDTH
