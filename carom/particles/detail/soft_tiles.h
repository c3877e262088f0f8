// The rows of a matrix of cloth or of a soft body in tiles of sixteen lanes, and the kernels of the solver's sweeps:
// one set for each instruction set.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/math/cpu.h"
#include "carom/particles/detail/cloth_tiles.h"
#include "carom/particles/detail/fold_tiles.h"

namespace carom::particles::detail {

inline constexpr int soft_lanes = 16;               ///< of a tile, whatever the width
inline constexpr int soft_block = 9 * soft_lanes;   ///< floats: 3×3 blocks by columns, lanes side by side
inline constexpr int soft_vector = 3 * soft_lanes;  ///< floats: vectors of a tile

/// Rows in the order of a sweep, sixteen side by side of which none hangs on another. A place is 16 × tile + lane.
struct SoftTiles {
  int count = 0;
  std::vector<int> row;     ///< by place; −1: none
  std::vector<int> place;   ///< by row
  std::vector<int> first;   ///< by tile: first entry below the diagonal; one more than tiles
  std::vector<int> far;     ///< by tile: first entry that is a link
  std::vector<int> column;  ///< by entry and lane: place; the lane's own beyond the last tile where there is none
  std::vector<int> source;  ///< by entry and lane: slot of the block, number of the link; the one after the last: none
  int places() const { return soft_lanes * count; }
};

/// What a solve reads and writes. Vectors by tile have soft_vector floats each.
struct SoftSweep {
  int tiles = 0;
  const int *first = nullptr, *last = nullptr;  ///< by tile: entries below the diagonal
  const int* column = nullptr;
  float* lower = nullptr;        ///< by entry: soft_block floats, Wᵀ K W
  const float* scale = nullptr;  ///< by tile: soft_block floats, W
  float *swept = nullptr, *direction = nullptr, *back = nullptr, *sum = nullptr;
  float* forward = nullptr;       ///< by place, and sixteen more: four floats each
  const float* answer = nullptr;  ///< of contacts with other systems; null: none
};

/// What the blocks below the diagonal are made from.
struct SoftEntries {
  const int *far = nullptr, *source = nullptr;
  const std::uint8_t* stale = nullptr;  ///< by entry: whether to make it
  const float* scale = nullptr;         ///< W by place, and sixteen more: three columns of four floats
  const float* blocks = nullptr;        ///< K by slot, likewise
  const float* links = nullptr;
  float link_scale = 1;
};

struct SoftKernels {
  void (*fill)(const SoftSweep& sweep, const SoftEntries& entries);
  /// swept, forward ← (1 + L)⁻¹ Wᵀ from; returns its square. `from`: by place, four floats each.
  double (*start)(const SoftSweep& sweep, const float* from);
  /// direction ← swept + keep direction, back ← (1 + Lᵀ)⁻¹ (direction − what `forward` holds); it is left in disorder.
  void (*up)(const SoftSweep& sweep, float keep);
  /// forward ← (1 + L)⁻¹ (direction − back + answer); returns direction · (back + forward).
  double (*down)(const SoftSweep& sweep);
  /// sum ← sum + stride back, swept ← swept − stride (back + forward), forward ← 0; returns the square of swept.
  double (*go)(const SoftSweep& sweep, float stride);

  /// `out`: by triangle. `records`: by vertex, cloth_record floats each.
  void (*strain)(const ClothTile* tiles, int from, int to, const float* records, const ClothLaw& law, ClothStrain* out);
  /// The blocks beside the diagonal, with the law's weight.
  void (*join_edges)(const ClothEdges* edges, int from, int to, const ClothSide* sides, const ClothStrain* strains,
                     const ClothLaw& law, float* blocks);
  /// Those on it, and what acts on the vertices: `out` has cloth_row floats by vertex.
  void (*join_corners)(const ClothCorners* corners, int from, int to, const ClothSide* sides,
                       const ClothStrain* strains, const ClothLaw& law, float* blocks, float* out);

  /// Planes, margins and bounds. `records`: by vertex, place and velocity, four floats each.
  void (*lay_folds)(FoldTriangles* tiles, int count, const float* records, const FoldMeasures& measures);
  /// Vertices of a group above or below triangles of a tile that they are not in: at most 16³. Returns how many.
  int (*meet_folds)(const FoldTriangles& tile, const FoldVertices& group, FoldHit* hits);
  void (*lay_edges)(FoldEdges* tiles, int count, const float* records);
  /// Edges of one tile within the bounds of another's triangles and nearer than `widest` to an edge of that one between
  /// their ends: at most FoldEdges::most². `same`: it is the same tile. Returns how many.
  int (*meet_edges)(const FoldEdges& ours, const FoldTriangles& bounds, const FoldEdges& theirs, bool same,
                    float widest, EdgeHit* hits);
  /// Which tiles of a run a tile's bounds meet, as bits.
  std::uint32_t (*meet_run)(const FoldRun& run, const FoldTriangles& tile);
};

namespace soft_baseline {
extern const SoftKernels kernels;
}
namespace soft_avx2 {
extern const SoftKernels kernels;
}
namespace soft_avx512 {
extern const SoftKernels kernels;
}

/// For 4, 8 or 16 lanes; the machine must have them.
inline const SoftKernels& soft_kernels(int lanes) {
#if CAROM_WIDE_UNITS
  if (lanes == 16) return soft_avx512::kernels;
  if (lanes == 8) return soft_avx2::kernels;
#endif
  static_cast<void>(lanes);
  return soft_baseline::kernels;
}

}  // namespace carom::particles::detail
