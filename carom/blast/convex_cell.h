// Convex polyhedra cut by planes: the cells of a fracture.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "carom/export.h"
#include "carom/geometry/bounds.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/mass_properties.h"

namespace carom::blast {

namespace detail {
class CellCutter;
}

/// {x : normal·x ≤ offset}, unit normal, m. `tag` names the face that a cut along it leaves.
struct HalfSpace {
  math::Vec3d normal{0, 1, 0};
  double offset = 0;
  int tag = 0;
};

/// A closed convex polyhedron in double: vertices, and faces as loops of vertices, counterclockwise seen from outside.
/// A cut classifies every vertex once and makes one new vertex for each edge that it crosses, so that the surface stays
/// closed whatever the rounding: V − E + F = 2, and no corner of a face lies within an edge of another.
class CAROM_API ConvexCell {
 public:
  struct Face {
    math::Vec3d normal{};  ///< outward, unit
    double offset = 0;     ///< m
    int tag = 0;           ///< of the half-space that cut it, or of the solid it was made from
    std::uint32_t first = 0, count = 0;
  };

  ConvexCell() = default;
  /// A box; its faces have the tags −1 … −6 (−x, +x, −y, +y, −z, +z).
  explicit ConvexCell(const geometry::Bounds3d& box);
  /// A hull without its radius; face f has the tag −1 − f.
  explicit ConvexCell(const geometry::Hull& hull);
  /// A bounded intersection of half-spaces, within `bounds`.
  ConvexCell(std::span<const HalfSpace> half_spaces, const geometry::Bounds3d& bounds);

  enum class Cut { none, part, all };
  /// Memory of cuts, to be used again.
  struct Scratch {
    struct Crossing {
      std::uint16_t inside, outside, next;
    };
    std::vector<double> distances;
    std::vector<Crossing> crossings;
    std::vector<std::uint8_t> outside;
    std::vector<std::uint16_t> remap, loops;
    std::vector<Face> faces;
  };
  /// Keeps what lies within the half-space. `all`: nothing is left.
  Cut clip(const HalfSpace& half_space, Scratch& scratch);
  Cut clip(const HalfSpace& half_space) {
    Scratch scratch;
    return clip(half_space, scratch);
  }

  bool empty() const { return faces_.empty(); }
  std::span<const math::Vec3d> vertices() const { return vertices_; }
  std::span<const Face> faces() const { return faces_; }
  std::span<const std::uint16_t> loop(const Face& face) const { return {loops_.data() + face.first, face.count}; }
  std::span<const std::uint16_t> loops() const { return loops_; }  ///< of all faces, one after the other
  int edge_count() const { return int(loops_.size() / 2); }
  /// For each corner of all the loops, that of the edge from it the other way; empty where nobody knows.
  std::span<const std::uint16_t> twins() const { return twins_; }

  double volume() const;                         ///< m³
  double area(const Face& face) const;           ///< m²
  math::Vec3d centroid(const Face& face) const;  ///< of the face's area
  /// Exact, of the density given (kg/m³).
  geometry::MassProperties3 mass_properties(double density) const;
  /// Square of the greatest distance from p to a vertex.
  double reach_squared(math::Vec3d p) const;
  double tolerance() const { return tolerance_; }  ///< m: what counts as on a plane
  /// Becomes what is left of it in the cutter. False, and to be thrown away, where it did not fit there.
  bool take(const detail::CellCutter& cutter);

 private:
  void set_tolerance();

  std::vector<math::Vec3d> vertices_;
  std::vector<Face> faces_;
  std::vector<std::uint16_t> loops_, twins_;
  double tolerance_ = 0;  // m: what counts as on a plane
};

/// The cell as a collision hull about `origin`, every face moved inward by `skin` m so that neighbours start apart.
/// Null where nothing of 10 µm thickness is left. The topology comes from the cell, not from a search for a hull.
CAROM_API std::shared_ptr<const geometry::Hull> make_cell_hull(const ConvexCell& cell, math::Vec3d origin, double skin);

}  // namespace carom::blast
