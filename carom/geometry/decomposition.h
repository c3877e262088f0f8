// Concave closed meshes and concave polygons as a few convex parts, for bodies that move.
#pragma once

#include "carom/geometry/hull.h"
#include "carom/geometry/shape2.h"

namespace carom::geometry {

struct DecompositionOptions {
  int max_parts = 16;       ///< 1 to 256
  int resolution = 32;      ///< cells along the longest side, 4 to 128: parts follow the mesh to about half a cell
  float concavity = 0.02f;  ///< of the mesh's volume, 0 to 1: a part whose hull adds less is not cut any more
  int max_vertices = 64;    ///< of a part, 8 to 255
};

/// Fills the mesh with cubic cells and cuts them along planes of the grid, the part with the most air in its hull
/// first, each at the plane that leaves the least; the parts' hulls come back, largest first. (The idea of a
/// volumetric, hierarchical decomposition is Mamou's, "Volumetric hierarchical approximate convex decomposition",
/// 2016.) The same on every machine. Triangles are counterclockwise seen from outside.
/// Errors: what mesh_mass_properties refuses (numbers not finite, indices out of range, open edges), no cell inside.
CAROM_API core::Result<std::vector<std::shared_ptr<const Hull>>> decompose_convex(
    std::span<const Vec3f> vertices, std::span<const std::uint32_t> indices, const DecompositionOptions& options = {});

/// A simple polygon, concave or with holes, as convex ones that together are exactly it: cut into triangles (Meisters,
/// "Polygons have ears", 1975; holes are bridged to what is round them), which are put together again while they
/// stay convex and of at most max_polygon_vertices corners (Hertel & Mehlhorn, "Fast triangulation of simple polygons",
/// 1983: without that limit at most four times as many as need be), in several orders, of which the one with the fewest
/// parts counts. No new corners
/// are made. Outline and holes in either direction, each closed by itself. All decisions are exact, on a grid of 2⁻²⁸
/// of the extent. In the order of their first corners in the outline and the holes; the same on every machine. A part
/// too thin to be a polygon is left out where it is less than a millionth of the area. Errors: fewer than three
/// corners, not finite, two corners at one place, outlines that meet or cross themselves or each other, a hole outside
/// or in another hole, a part too thin to be a polygon.
CAROM_API core::Result<std::vector<Polygon>> decompose_convex(std::span<const Vec2f> outline,
                                                              std::span<const std::vector<Vec2f>> holes = {});

}  // namespace carom::geometry
