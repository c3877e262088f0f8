// Polygons into pieces: the plane's side of fracture.h.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/shape2.h"

namespace carom::blast {

/// {x : normal·x ≤ offset} in the plane, unit normal. `tag` ≥ 0 names the side that a cut along it leaves.
struct HalfPlane {
  math::Vec2d normal{1, 0};
  double offset = 0;
  int tag = 0;
};
struct Pattern2 {
  /// Convex, as the half-planes of their cuts.
  std::vector<std::vector<HalfPlane>> cells;
  /// Two cells that may share part of a cut: the tags of the sides along which they meet.
  struct Meeting {
    std::uint32_t cell_a, cell_b;
    int tag_a, tag_b;
  };
  std::vector<Meeting> meetings;
};

/// Cells of the sites; tag of a side: the site beyond it. Errors: no site, not finite, two in one place, more than
/// 10000.
CAROM_API core::Result<Pattern2> voronoi_pattern2(std::span<const math::Vec2d> sites);
/// Uniform in the box.
CAROM_API std::vector<math::Vec2d> uniform_sites2(const geometry::Bounds2d& box, int count, std::uint64_t seed);
/// Rings about the impact, each `growth` times as wide as the one before, of `sectors` points each, out to `limit` m.
struct RadialSites2 {
  math::Vec2d impact{};
  double first_radius = 0.02;  ///< m
  double growth = 1.6;
  int sectors = 9;
  double jitter = 0.35;  ///< 0 … 1
  double limit = 1;      ///< m
};
CAROM_API core::Result<std::vector<math::Vec2d>> radial_sites2(const RadialSites2& rings, std::uint64_t seed);
/// `count` slabs of the polygon square to `normal`, 1 to 10000, with borders moved by up to `jitter` (0 … 1) of half a
/// thickness.
CAROM_API core::Result<Pattern2> slab_pattern2(std::span<const math::Vec2d> outline, math::Vec2d normal, int count,
                                               double jitter = 0, std::uint64_t seed = 0);
/// Bricks of `size` m over the polygon, in courses that rise along y, every second one shifted by half a brick.
/// `corner`: where a brick of the lowest course begins. Errors: more than 10000 bricks, a size that is not positive.
CAROM_API core::Result<Pattern2> brick_pattern2(std::span<const math::Vec2d> outline, math::Vec2d size,
                                                math::Vec2d corner);

struct Piece2 {
  std::uint32_t cell = 0;
  std::vector<math::Vec2d> outline;   ///< m, counterclockwise
  std::vector<std::int32_t> sources;  ///< of the side from corner i to i + 1: ≥ 0 that of the polygon, < 0: −1 − tag
  geometry::MassProperties2 mass;     ///< of density 1 kg/m²
  /// Convex, about the centre, sides moved inward by the skin. A piece too thin for one has none.
  std::vector<geometry::Polygon> polygons;
};
struct Bond2 {
  std::uint32_t a = 0, b = 0;
  double length = 0;  ///< m
  math::Vec2d center{}, normal{};
};
struct Fracture2 {
  std::vector<Piece2> pieces;
  std::vector<Bond2> bonds;
};
/// A simple polygon, convex or not, counterclockwise. `skin`: m, at most a tenth of a convex part's inner radius.
/// Errors: fewer than three corners, not finite, clockwise, sides that cross, a skin out of range (0 … 0.1).
CAROM_API core::Result<Fracture2> fracture_polygon(std::span<const math::Vec2d> outline, const Pattern2& pattern,
                                                   double skin = 1e-3);

}  // namespace carom::blast
