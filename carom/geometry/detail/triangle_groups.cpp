#include "carom/geometry/detail/triangle_groups.h"

#include "carom/math/cpu.h"

namespace carom::geometry::detail {

const TriangleKernels& triangle_kernels() {
#if CAROM_WIDE_UNITS
  static const bool wide = math::detect_instruction_set() >= math::InstructionSet::avx2;
  if (wide) return triangle_groups_avx2::kernels;
#endif
  return triangle_groups_baseline::kernels;
}

}  // namespace carom::geometry::detail
