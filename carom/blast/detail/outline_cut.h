// Polygons of the plane cut by lines, convex or not.
#pragma once

#include <vector>

#include "carom/blast/fracture2.h"

namespace carom::blast::detail {

struct Corner2 {
  math::Vec2d p;
  std::int32_t source;  ///< of the side that begins here: ≥ 0 that of the polygon, < 0: −1 − tag
};
using Outline2 = std::vector<Corner2>;

double area_of(const Outline2& outline);

/// What cuts work in, so that one after another needs no new memory.
struct CutScratch2 {
  struct Crossing {
    std::size_t corner;
    double along;
  };
  std::vector<Corner2> corners;
  std::vector<std::size_t> next;
  std::vector<double> distance;
  std::vector<Crossing> exits, entries;
  std::vector<char> used;
};
/// Keeps what lies within the half-plane. Corners are within or beyond, never on the line. Crossings are joined in
/// pairs along it, the k-th way out with the k-th way in, so that loops stay closed whatever the rounding.
void cut(std::vector<Outline2>& outlines, const HalfPlane& half_plane, CutScratch2& scratch);

}  // namespace carom::blast::detail
