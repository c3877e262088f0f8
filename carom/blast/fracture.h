// Solids into pieces (chapter 18.8): convex ones and closed meshes of any form, cut along a pattern into watertight
// pieces with exact masses, and the bonds that held them together.
#pragma once

#include <memory>

#include "carom/blast/pattern.h"

namespace carom::blast {

/// A closed piece, in the frame of the solid.
struct Piece {
  std::uint32_t cell = 0;                ///< of the pattern
  std::vector<math::Vec3d> vertices;     ///< m
  std::vector<std::uint32_t> triangles;  ///< three each, counterclockwise seen from outside
  /// A triangle: ≥ 0 the triangle of the mesh (of a convex solid: the face) that it is part of; < 0 a cut, −1 − its tag
  /// in the pattern (Voronoi cells: the cell beyond).
  std::vector<std::int32_t> sources;
  std::vector<math::Vec2f> texture;  ///< a corner of a triangle
  geometry::MassProperties3 mass;    ///< of density 1 kg/m³, about its centre
  /// For collisions, about `mass.center`, each face moved inward by the skin. Hulls of pieces of different cells never
  /// meet. A piece too thin for one has none.
  std::vector<std::shared_ptr<const geometry::Hull>> hulls;
};

/// Where two pieces hold together.
struct Bond {
  std::uint32_t a = 0, b = 0;      ///< pieces, a < b
  double area = 0;                 ///< m²
  math::Vec3d center{}, normal{};  ///< in the frame of the solid; from a to b
};

struct Fracture {
  std::vector<Piece> pieces;
  std::vector<Bond> bonds;
};

struct FractureOptions {
  double skin = 1e-3;  ///< m, 0 … 0.1: how far hulls stand back; at most a tenth of a piece's inner radius
  bool meshes = true;  ///< triangles to draw; without them masses, hulls and bonds come all the same
  bool hulls = true;
  double texture_scale = 1;     ///< of the coordinates of cuts, per metre; the same from both sides of a cut
  double least_solidity = 0.7;  ///< a piece of a mesh that fills less of its hull gets several (0: always one)
  int max_hulls = 6;            ///< of a piece, 1 … 32
  core::TaskScheduler* scheduler = nullptr;  ///< pieces of convex solids on several threads, with the same bits
};

/// The pieces of the convex container itself. Errors: options out of range.
CAROM_API core::Result<Fracture> fracture_convex(const Pattern& pattern, const FractureOptions& options = {});

/// A closed mesh cut along a pattern whose container holds it (ConvexCell(bounds)). A cell may give several pieces.
/// `texture`: one coordinate a corner (three a triangle), or none. Errors: options out of range; a mesh that is not
/// closed, inside out, not finite, or has an edge with more than two triangles (the message says where).
CAROM_API core::Result<Fracture> fracture_mesh(std::span<const math::Vec3d> vertices,
                                               std::span<const std::uint32_t> triangles, const Pattern& pattern,
                                               const FractureOptions& options = {},
                                               std::span<const math::Vec2f> texture = {});

/// The box of the vertices, grown by a thousandth of its size.
CAROM_API ConvexCell container_of(std::span<const math::Vec3d> vertices);

/// V − E + F of the triangles: 2 for what is like a ball, 0 for what is like a ring.
CAROM_API int euler_characteristic(const Piece& piece);
/// Every edge has exactly one triangle on each side.
CAROM_API bool is_watertight(const Piece& piece);

}  // namespace carom::blast
