// Where a solid breaks: sites and their Voronoi cells, cracks that run out from an impact, slabs and bricks.
#pragma once

#include "carom/blast/convex_cell.h"
#include "carom/core/result.h"
#include "carom/core/scheduler.h"

namespace carom::blast {

/// A solid's container cut into cells. Faces of a cell with a tag ≥ 0 are cuts, the others are the container's.
struct Pattern {
  std::vector<ConvexCell> cells;  ///< a cell may be empty
  /// Two cells that may share part of a cut: the tags of the faces along which they meet.
  struct Meeting {
    std::uint32_t cell_a, cell_b;
    int tag_a, tag_b;
    bool partial = false;  ///< others may meet the same faces
  };
  std::vector<Meeting> meetings;
};

/// Points uniform in the container (chapter 18.8). All of these are the same for the same seed on every machine.
CAROM_API std::vector<math::Vec3d> uniform_sites(const ConvexCell& container, int count, std::uint64_t seed);
/// The same, moved to the centres of their cells `rounds` times (Lloyd, "Least squares quantization in PCM", 1982):
/// pieces of about one size.
CAROM_API std::vector<math::Vec3d> even_sites(const ConvexCell& container, int count, int rounds, std::uint64_t seed);
/// Half of the points within `radius` m of the impact or so (distance exponential with that mean), the more the nearer.
CAROM_API std::vector<math::Vec3d> clustered_sites(const ConvexCell& container, math::Vec3d impact, double radius,
                                                   int count, std::uint64_t seed);

/// Cracks of a pane: rings about `axis` (unit) through the impact, each `growth` times as wide as the one before, each
/// with about `sectors` pieces; the points lie in the plane through the impact, so that cells go through the pane.
struct RadialSites {
  math::Vec3d impact{}, axis{0, 0, 1};
  double first_radius = 0.02;  ///< m, > 0
  double growth = 1.6;         ///< > 1
  int sectors = 9;             ///< ≥ 3
  double jitter = 0.35;        ///< 0 … 1 of the spacing
  double limit = 0;            ///< m: no ring farther out; 0: as far as the container reaches
};
CAROM_API core::Result<std::vector<math::Vec3d>> radial_sites(const ConvexCell& container, const RadialSites& rings,
                                                              std::uint64_t seed);

/// The cells of the sites within the container; tag of a face: the site beyond it. Neighbours are searched outward in a
/// grid until all that are farther than twice the farthest corner (the security radius: Lévy & Bonneel, "Variational
/// anisotropic surface meshing with Voronoi parallel linear enumeration", 2013). Errors: no site, a site that is not
/// finite or more than 1e30 m away, two in one place, a container that is empty or as far.
/// `scheduler`: cells on several threads, with the same bits.
CAROM_API core::Result<Pattern> voronoi_pattern(const ConvexCell& container, std::span<const math::Vec3d> sites,
                                                core::TaskScheduler* scheduler = nullptr);
/// `count` slabs square to `normal`, with borders moved by up to `jitter` (0 … 1) of half a thickness.
CAROM_API core::Result<Pattern> slab_pattern(const ConvexCell& container, math::Vec3d normal, int count,
                                             double jitter = 0, std::uint64_t seed = 0);
/// Bricks of `size` m along x, y and z in courses that rise along y, every second one shifted by half a brick along x.
/// `corner`: where a brick of the lowest course begins. Errors: more than 65536 bricks, a size that is not positive.
CAROM_API core::Result<Pattern> brick_pattern(const ConvexCell& container, math::Vec3d size, math::Vec3d corner);

}  // namespace carom::blast
