// What the kernel of ProjectileBatch works on: plain pointers, one function for each instruction set.
#pragma once

#include <cstddef>

namespace carom::ballistics::detail {

/// Uniform tables, every value followed by the difference to the next node's: drag_row and air_row floats a node,
/// filled up so that rows are gathered whole.
inline constexpr int drag_row = 4;  // C_D
inline constexpr int air_row = 12;  // density, 1/speed of sound, wind x, y, z
struct BatchStep {
  float* position[3];
  float* velocity[3];
  float* previous[3];
  const float* half_area_per_mass;
  const float* drag;
  const float* air;
  float nodes_per_mach, last_node;
  float lowest, levels_per_metre, last_level;
  float gravity;
  float turning[3];  // −2 Ω
  float dt;
};

namespace batch_baseline {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
#if defined(__x86_64__)
namespace batch_avx2 {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
namespace batch_avx512 {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
#endif

}  // namespace carom::ballistics::detail
