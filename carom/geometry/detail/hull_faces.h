// From the triangles of a hull to its faces.
#pragma once

#include <vector>

#include "carom/geometry/detail/hull_builder.h"

namespace carom::geometry::detail {

/// The border of every group of triangles that lie in one plane, as corners counterclockwise from outside; or the
/// corners to leave out (inside a face, or between two faces only) before asking again.
struct HullLoops {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint32_t> surplus;
};

HullLoops merge_coplanar(std::span<const GridPoint> points, std::span<const HullTriangle> triangles, double tolerance);

}  // namespace carom::geometry::detail
