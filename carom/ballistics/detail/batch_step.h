// What the kernel of ProjectileBatch works on: plain pointers, one function for each instruction set.
#pragma once

#include <cstddef>

#include "carom/math/cpu.h"

namespace carom::ballistics::detail {

/// Tables, every value followed by the difference to the next node's or by the slope toward it: drag_row and air_row
/// floats a node, filled up so that rows are gathered whole.
inline constexpr int drag_row = 4;  // C_D, uniform
inline constexpr int air_row = 12;  // density, 1/speed of sound, wind x, y, z
/// Air by the distance above and below a height, near which wind changes most: 64 cells an octave, by the first bits of
/// the number, those above first.
inline constexpr float least_distance = 0.015625f, greatest_distance = 32767.0f;  // m
inline constexpr int air_shift = 17, air_first = 0x3c800000 >> air_shift, air_cells = 21 * 64;
struct BatchStep {
  float* position[3];
  float* velocity[3];
  float* previous[3];
  const float* half_area_per_mass;
  const float* drag;
  const float* air;
  float nodes_per_mach, last_node;
  float base;  // m: the height that distances are counted from
  float gravity;
  float turning[3];  // −2 Ω
  float dt;
  /// 1/s: what drag would stop within a part of a step slows down by e in it; there Runge and Kutta's steps would grow.
  float most_drag;
};

namespace batch_baseline {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
#if CAROM_WIDE_UNITS
namespace batch_avx2 {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
namespace batch_avx512 {
void step(const BatchStep& batch, std::size_t from, std::size_t to);
}
#endif

}  // namespace carom::ballistics::detail
