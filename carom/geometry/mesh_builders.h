// Triangles made from numbers: closed primitives, terrains, and every shape as triangles to draw.
// All are counterclockwise seen from outside (or from above); closed ones pass mesh_mass_properties.
#pragma once

#include "carom/geometry/hull.h"
#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"

namespace carom::geometry {

struct Triangles {
  std::vector<Vec3f> positions;        ///< m
  std::vector<std::uint32_t> indices;  ///< three a triangle
};

/// A box with half extents h.
CAROM_API Triangles make_box_mesh(Vec3f half_extents);
/// `slices` ≥ 3 round the y axis, `stacks` ≥ 2 from pole to pole; vertices on the sphere.
CAROM_API Triangles make_sphere_mesh(float radius, int slices = 32, int stacks = 16);
/// The tube's centre line runs in the plane z = 0 at `major` radius, with `major_segments` ≥ 3; the tube has radius
/// `minor`, with `minor_segments` ≥ 3.
CAROM_API Triangles make_torus_mesh(float major, float minor, int major_segments = 32, int minor_segments = 16);
/// A surface of revolution round y through the given (radius, y) points, from bottom to top, closed by discs or cones
/// where the first or last radius is not zero.
CAROM_API Triangles make_lathe_mesh(std::span<const Vec2f> profile, int slices = 32);
/// A prism over a polygon with `sides` ≥ 3 of circumradius `radius`, along y from −half_height to +half_height.
CAROM_API Triangles make_prism_mesh(float radius, float half_height, int sides);
/// A flat surface of columns × rows cells (≥ 1) with corners on the grid, from (0, 0, 0) along +x and +z, facing up.
CAROM_API Triangles make_grid_mesh(int columns, int rows, Vec2f cell);
/// The same with the height of vertex (i, j) given by height(i, j).
template <class Height>
Triangles make_terrain_mesh(int columns, int rows, Vec2f cell, Height&& height) {
  Triangles t = make_grid_mesh(columns, rows, cell);
  for (std::size_t v = 0; v < t.positions.size(); ++v)
    t.positions[v].y = float(height(int(v) % (columns + 1), int(v) / (columns + 1)));
  return t;
}

/// `detail`: segments of a full circle, 8 to 256. Rounded shapes are drawn rounded. A plane is a square of 200 m.
CAROM_API Triangles to_triangles(const Shape3& shape, int detail = 32);
CAROM_API Triangles to_triangles(const Hull& hull, int detail = 32);
/// The outline of a shape of the plane: closed counterclockwise for solids, open for segments and open chains.
struct Outline {
  std::vector<Vec2f> points;
  bool closed = true;
};
CAROM_API Outline to_outline(const Shape2& shape, int detail = 32);

}  // namespace carom::geometry
