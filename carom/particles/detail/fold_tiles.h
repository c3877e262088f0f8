// Where the folds of a cloth may meet: its vertices and its triangles in tiles of sixteen that lie near each other.
#pragma once

#include <cstdint>

namespace carom::particles::detail {

inline constexpr int fold_lanes = 16;

/// Sixteen times sixteen vertices.
struct alignas(64) FoldVertices {
  float low[3][fold_lanes], high[3][fold_lanes];  ///< m, of the tiles; the wrong way round where there is none
  float at[fold_lanes][3][fold_lanes];            ///< m, far away where there is none
  int vertex[fold_lanes][fold_lanes];
  float all_low[3], all_high[3];
};

/// Planes of sixteen triangles, and what is linear in where a point is: its height above the plane and the shares of
/// the second and the third corner at its foot.
struct alignas(64) FoldTriangles {
  int corner[3][fold_lanes];
  int triangle[fold_lanes];  ///< −1: none
  float origin[3][fold_lanes], normal[3][fold_lanes], second[3][fold_lanes], third[3][fold_lanes];
  float margin[fold_lanes];  ///< m, of height; below 0: of what is not looked at
  float low[3], high[3];     ///< m, of all, with their margins
};

/// The edges of a tile of triangles that no tile before it has.
struct alignas(64) FoldEdges {
  static constexpr int most = 3 * fold_lanes;
  static constexpr float least_sine = 0.05f;  ///< edges that lie so nearly along each other are left to the vertices
  int end[2][most] = {};                      ///< vertices; beyond the last edge one more than there are, far away
  float from[3][most], to[3][most];           ///< m, of the ends; far away beyond the last
  int count = 0;
};

/// Two edges that may meet, by their places in their tiles.
struct EdgeHit {
  int first = 0, second = 0;
};

/// The bounds of tiles of triangles that follow each other: a lane each, the wrong way round where there is none.
struct alignas(64) FoldRun {
  float low[3][fold_lanes], high[3][fold_lanes];
  float all_low[3], all_high[3];
};

struct FoldMeasures {
  float apart = 0;    ///< m
  float ahead = 0;    ///< s: margins grow with a triangle's change of shape in this time
  float margin = 0;   ///< m, at most, beyond `apart`
  float longest = 0;  ///< m: a triangle of a greater extent is stretched out of all measure
};

struct FoldHit {
  int vertex = 0, triangle = 0;
};

}  // namespace carom::particles::detail
