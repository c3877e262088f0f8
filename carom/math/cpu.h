// Which instruction set the machine offers, so that a kernel compiled for several can be picked at run time.
#pragma once

#include "carom/export.h"

namespace carom::math {

/// In rising order. `baseline` is what the whole library is compiled for: SSE2, NEON or WASM SIMD128, four lanes.
enum class InstructionSet { baseline, avx2, avx512 };

/// Whether the rooms have units for AVX2 and AVX-512 to pick from. CAROM_BASELINE_ONLY: not in this build (cmake:
/// CAROM_WIDE).
#if defined(__x86_64__) && !defined(CAROM_BASELINE_ONLY)
#define CAROM_WIDE_UNITS 1
#else
#define CAROM_WIDE_UNITS 0
#endif

/// The most lanes that a kernel may be picked with: only x86 has any that are wider than the baseline.
#if CAROM_WIDE_UNITS
inline constexpr int widest_lanes = 16;
#else
inline constexpr int widest_lanes = 4;
#endif

/// The best instruction set that this processor and operating system run; avx512 means F, VL, DQ and BW.
CAROM_API InstructionSet detect_instruction_set();

/// `wanted` where the machine has it, else the best one it has. Results are the same in bits either way.
inline InstructionSet choose_instruction_set(InstructionSet wanted) {
  const InstructionSet best = detect_instruction_set();
  return wanted < best ? wanted : best;
}

/// Float lanes: 4, 8 or 16.
constexpr int simd_width(InstructionSet set) {
  return set == InstructionSet::avx512 ? 16 : (set == InstructionSet::avx2 ? 8 : 4);
}
/// The instruction set of a width of 4, 8 or 16 lanes (anything else: the next lower).
constexpr InstructionSet instruction_set_of_width(int width) {
  return width >= 16 ? InstructionSet::avx512 : (width >= 8 ? InstructionSet::avx2 : InstructionSet::baseline);
}
/// "baseline", "avx2" or "avx512".
constexpr const char* to_string(InstructionSet set) {
  return set == InstructionSet::avx512 ? "avx512" : (set == InstructionSet::avx2 ? "avx2" : "baseline");
}

}  // namespace carom::math
