#include "carom/geometry/detail/corner_lanes.h"

#include "carom/math/cpu.h"

namespace carom::geometry::detail {

const CornerKernels& corner_kernels() {
#if CAROM_WIDE_UNITS
  static const bool wide = math::detect_instruction_set() >= math::InstructionSet::avx2;
  if (wide) return corner_lanes_avx2::kernels;
#endif
  return corner_lanes_baseline::kernels;
}

}  // namespace carom::geometry::detail
