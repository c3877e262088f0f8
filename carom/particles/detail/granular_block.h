// Contacts of grains side by side in lanes, and the kernels that solve them: one set for each instruction set.
#pragma once

#include <cstdint>

#include "carom/math/cpu.h"

namespace carom::particles::detail {

inline constexpr int grain_lanes = 16;  ///< of a block, whatever the width: no grain is in a block twice
/// Floats of a grain's motion: in the plane velocity, speed of its rim (spin times radius) and inverse radius; in space
/// velocity, inverse mass, velocity of its rim and inverse radius.
template <int N>
inline constexpr int grain_motion = N == 2 ? 4 : 8;
inline constexpr int grain_place = 4;  ///< floats: place, at the last radius
/// Floats that a pair holds from one search to the next: push, grip, roll (GrainBlock).
template <int N>
inline constexpr int grain_held = N == 2 ? 4 : 8;

/// Of the time until the next search: pairs are solved from that stage on in which the two may first touch.
inline constexpr int grain_stages = 8;

/// Pairs of grains, or grains and a surface that does not move (there `b` is not read). A lane without a contact has
/// twice a grain that is none.
template <int N>
struct alignas(64) GrainBlock {
  static constexpr int turns = N == 2 ? 1 : 3;
  std::uint32_t a[grain_lanes] = {}, b[grain_lanes] = {};  ///< grain_place × the grain's number
  float normal[N][grain_lanes] = {};                       ///< from a to b
  float gap[grain_lanes] = {};                             ///< m
  float push[grain_lanes] = {};                            ///< N·s along the normal, ≥ 0
  float gain[grain_lanes] = {};                            ///< N·s of it, by the last sweep
  float grip[turns][grain_lanes] = {};  ///< N·s on b across it; in the plane along the normal turned left
  float roll[turns][grain_lanes] = {};  ///< N·m·s on b
  // Of a pair, as long as it is watched.
  float ease[grain_lanes] = {};      ///< kg, that resist a push
  float give_way[grain_lanes] = {};  ///< kg·m, that resist rolling, times `turning` over 1/r_a + 1/r_b
  float lever[grain_lanes] = {};     ///< m, half of what rolling friction goes with
};

struct GrainPass {
  float inverse_h = 0;  ///< 1/s
  float lightness = 0;  ///< m²/kg in the plane: inverse mass over squared inverse radius
  float friction = 0, rolling = 0;
  float slop = 0;    ///< m of overlap that stays
  float part = 0;    ///< of the rest, that is taken out
  float up[3] = {};  ///< against gravity: what is added to the weight of the lower of two, straight below
};

template <int N>
inline constexpr int grain_rings = N == 2 ? 2 : 1;  ///< of cells around one, in which neighbours are looked for at most

/// Grains in the order of their cells, places and then radii in columns that may be read a block of lanes too far.
template <int N>
struct GrainColumns {
  const float* column[N + 1];
};
/// Where grains of a cell, which are begin … end − 1, and their neighbours lie: runs of cells, the first with those
/// grains in front. Of the others those count that are within `low` … `high`.
template <int N>
struct GrainRuns {
  static constexpr int most = (2 * grain_rings<N> + 1) * (N == 2 ? grain_rings<N> + 1 : 2);
  int begin = 0, end = 0, count = 0;
  int from[most], to[most];
  float low[N], high[N];  ///< m
};

/// A pair that does not touch yet: of both grains grain_place × the number.
struct GrainWait {
  std::uint32_t a = 0, b = 0;
};

/// Room for what is near a cell's grains, and for pairs of them that wait: for a block of lanes more than there can be.
/// And lists, by stage, to which these are added.
template <int N>
struct GrainRoom {
  int* number;
  float* column[N + 1];
  int *own, *other;
  float* wait[3];  ///< squared distance, the way it goes with, distance where they touch
  GrainWait* later[grain_stages];
  int* waiting;  ///< how many, by stage
};

/// m: how far two grains may close by axis, what is added in any direction, and no more than `most` in all.
template <int N>
struct GrainReach {
  float way[N] = {};
  float slack = 0, most = 0;
};

/// All but `find`, `wait` and `move` go through the blocks first … last − 1 in turn, or back from the last.
template <int N>
struct GrainKernels {
  using Block = GrainBlock<N>;
  /// Neighbours that may touch at once: their numbers go to found[at …], for each grain where they begin to
  /// first[grain]. Returns where they end. Those that may come to touch are added to the room's lists.
  int (*find)(const GrainColumns<N>& grains, const GrainRuns<N>& runs, const GrainReach<N>& reach,
              const GrainRoom<N>& room, int* first, int* found, int at);
  /// In how many stages from now on pairs may first touch, to `stages`, which has room for a block of lanes more:
  /// grain_stages, the most, is never. `pace` has by grain, as many floats as a place, how far another may close on it
  /// until the next search.
  void (*wait)(const GrainWait* waiting, int count, float* place, float* pace, float slack, int* stages);
  /// Grains first … last − 1 go on by `time` and then gain velocity: of four floats, that begin a row, each its own.
  void (*move)(float* place, float* motion, int first, int last, const float* time, const float* gained);
  /// What the pairs were holding: `was` has twice the pair's number then and 1 where its grains are swapped, or −1. And
  /// what their masses and radii come to.
  void (*recall)(Block* blocks, int first, int last, const int* was, const float* held, float scale, float* motion,
                 const GrainPass& pass);
  void (*keep)(const Block* blocks, int first, int last, const int* pair, float* held);
  /// Takes a part of overlaps out of the places alone, so that no speed comes of them; normals and gaps there; and
  /// gives the impulses that the contacts hold.
  void (*press)(Block* blocks, int first, int last, float* place, float* motion, const GrainPass& pass);
  void (*sweep)(Block* blocks, int first, int last, bool back, float* motion, const GrainPass& pass);
  /// The same with a surface, its normals and gaps being given.
  void (*press_surface)(Block* blocks, int first, int last, float* place, float* motion, const GrainPass& pass);
  void (*sweep_surface)(Block* blocks, int first, int last, bool back, float* motion, const GrainPass& pass);
  float (*deepest)(const Block* blocks, int first, int last, float* place);  ///< m, overlap, ≥ 0
};

namespace grains_baseline {
extern const GrainKernels<2> kernels2;
extern const GrainKernels<3> kernels3;
}  // namespace grains_baseline
namespace grains_avx2 {
extern const GrainKernels<2> kernels2;
extern const GrainKernels<3> kernels3;
}  // namespace grains_avx2
namespace grains_avx512 {
extern const GrainKernels<2> kernels2;
extern const GrainKernels<3> kernels3;
}  // namespace grains_avx512

/// For 4, 8 or 16 lanes; the machine must have them.
template <int N>
const GrainKernels<N>& grain_kernels(int lanes) {
  const auto pick = [](const GrainKernels<2>& plane, const GrainKernels<3>& space) -> const GrainKernels<N>& {
    if constexpr (N == 2)
      return static_cast<void>(space), plane;
    else
      return static_cast<void>(plane), space;
  };
#if CAROM_WIDE_UNITS
  if (lanes == 16) return pick(grains_avx512::kernels2, grains_avx512::kernels3);
  if (lanes == 8) return pick(grains_avx2::kernels2, grains_avx2::kernels3);
#endif
  static_cast<void>(lanes);
  return pick(grains_baseline::kernels2, grains_baseline::kernels3);
}

}  // namespace carom::particles::detail
