// What the kernel of SeaPatch works on: plain pointers, one function for each instruction set.
#pragma once

#include <cstddef>

#include "carom/math/cpu.h"

namespace carom::environment::detail {

struct SeaWaves {
  const float* turns_x;  ///< per metre
  const float* turns_z;
  const float* phase;  ///< turns, in [−½, ½]
  const float* amplitude;
  int count;
  const float* x;
  const float* z;
  float* height;
  float* slope_x;  ///< null: not wanted
  float* slope_z;
};

/// For whole blocks of lanes from `from` to `to`.
namespace sea_baseline {
void heights(const SeaWaves& sea, std::size_t from, std::size_t to);
}
#if CAROM_WIDE_UNITS
namespace sea_avx2 {
void heights(const SeaWaves& sea, std::size_t from, std::size_t to);
}
namespace sea_avx512 {
void heights(const SeaWaves& sea, std::size_t from, std::size_t to);
}
#endif

}  // namespace carom::environment::detail
