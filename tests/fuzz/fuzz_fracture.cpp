// Any triangles, broken along any pattern: refused with a reason, or watertight pieces that together are the whole.
#include <cmath>

#include "carom/blast/fracture.h"
#include "carom/blast/fracture2.h"
#include "carom/geometry/decomposition.h"
#include "carom/geometry/mesh_builders.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/source.h"
#include "tests/fuzz/target.h"

namespace {
using namespace carom;
using namespace carom::blast;
using fuzz::Source;
using math::Vec2d;
using math::Vec3d;
using math::Vec3f;

struct Mesh {
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> triangles;
  bool simple = false;  ///< closed, and nowhere through itself
};

/// A sound solid, as it is or with corners and indices that anything may have happened to; or what the bytes are.
Mesh mesh_from(Source& in) {
  const std::uint8_t kind = in.byte();
  Mesh mesh;
  if (kind % 8 == 7) {
    const int vertices = in.byte() % 24, triangles = in.byte() % 40;
    for (int i = 0; i < vertices; ++i) {
      // In this order: an expression has none of its own.
      const double x = double(in.number()), y = double(in.number());
      mesh.vertices.push_back({x, y, double(in.number())});
    }
    for (int i = 0; i < 3 * triangles; ++i) mesh.triangles.push_back(in.byte() % 25);
    return mesh;
  }
  geometry::Triangles t;
  switch (kind % 4) {
    case 0:
      t = geometry::make_box_mesh({1, 0.6f, 0.3f});
      break;
    case 1:
      t = geometry::make_sphere_mesh(1, 9, 6);
      break;
    case 2:
      t = geometry::make_torus_mesh(1, 0.35f, 9, 6);
      break;
    default: {
      // A cup: concave, with a bottom.
      const math::Vec2f profile[] = {{0, -0.8f},    {0.7f, -0.8f},  {0.9f, 0.8f},
                                     {0.75f, 0.8f}, {0.55f, -0.6f}, {0, -0.6f}};
      t = geometry::make_lathe_mesh(profile, 8);
    }
  }
  const double scale = kind & 8 ? double(in.size()) : 1;
  const double x = kind & 8 ? double(in.number(100)) : 0, y = kind & 8 ? double(in.number(100)) : 0;
  for (const Vec3f& v : t.positions) mesh.vertices.push_back(scale * Vec3d(v) + Vec3d{x, y, 0});
  mesh.triangles = t.indices;
  mesh.simple = scale > 1e-3 && scale < 1e4 && std::fabs(x) < 1e4 && std::fabs(y) < 1e4;
  for (int harm = kind & 16 ? in.byte() % 12 : 0; harm > 0; --harm) {
    mesh.simple = false;
    const std::size_t where = in.byte();
    switch (in.byte() % 4) {
      case 0:
        mesh.triangles[where % mesh.triangles.size()] = in.byte();
        break;
      case 1:
        mesh.triangles.resize(mesh.triangles.size() - std::min<std::size_t>(mesh.triangles.size() - 3, 3));
        break;
      default: {
        const int axis = in.byte() % 3;
        mesh.vertices[where % mesh.vertices.size()][axis] = double(in.number());
      }
    }
  }
  return mesh;
}

core::Result<Pattern> pattern_from(Source& in, const ConvexCell& container) {
  const int kind = in.byte() % 6, count = 1 + in.byte() % 24;
  const std::uint64_t seed = in.byte();
  const double x = double(in.number()), y = double(in.number());
  const Vec3d point{x, y, double(in.number())};
  switch (kind) {
    case 0:
      return voronoi_pattern(container, uniform_sites(container, count, seed));
    case 1:
      return voronoi_pattern(container, even_sites(container, count, 1, seed));
    case 2:
      return voronoi_pattern(container, clustered_sites(container, point, double(in.size()), count, seed));
    case 3: {
      RadialSites rings;
      rings.impact = point, rings.first_radius = double(in.size()), rings.growth = 1.5 + double(in.size());
      rings.sectors = 3 + count / 4, rings.limit = double(in.size());
      const auto sites = radial_sites(container, rings, seed);
      if (!sites.ok()) return sites.error();
      return voronoi_pattern(container, *sites);
    }
    case 4:
      return slab_pattern(container, point, count, double(in.byte()) / 200, seed);
    default: {
      const double w = double(in.size()), h = double(in.size());
      const Vec3d size{w, h, double(in.size())};
      geometry::Bounds3d box{};
      for (const Vec3d& v : container.vertices()) box = {min(box.low, v), max(box.high, v)};
      const Vec3d extent = box.high - box.low;
      if (extent.x * extent.y * extent.z > 60 * size.x * size.y * size.z)
        return core::Error{"more bricks than there is time for"};
      return brick_pattern(container, size, point);
    }
  }
}

void check(const Mesh& mesh, const Fracture& fracture) {
  double sum = 0, extent = 0;
  for (const Vec3d& v : mesh.vertices)
    extent = std::fmax(extent, std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z))));
  for (const Piece& piece : fracture.pieces) {
    require(piece.mass.mass > 0 && std::isfinite(piece.mass.mass), "a piece has a mass");
    require(is_finite(piece.mass.center), "and a centre");
    require(!mesh.simple || is_watertight(piece), "every piece is watertight");
    require(piece.sources.size() == piece.triangles.size() / 3 && piece.texture.size() == piece.triangles.size(),
            "every triangle has its source and its texture");
    for (const auto& hull : piece.hulls)
      require(geometry::validate_hull(*hull, {}, 1e-4 * extent).ok(), "every hull is sound");
    sum += piece.mass.mass;
  }
  for (const Bond& bond : fracture.bonds)
    require(bond.a < bond.b && bond.b < fracture.pieces.size() && bond.area > 0 && std::isfinite(bond.area),
            "a bond joins two pieces");
  const auto whole = geometry::mesh_mass_properties(mesh.vertices, mesh.triangles, 1);
  require(whole.ok(), "what breaks has a volume");
  // A surface through itself has cells in which it is inside out: these are no pieces.
  const double tolerance = 1e-9 * extent * extent * extent;
  require(sum >= whole->volume - tolerance, "nothing of the whole is lost");
  if (mesh.simple) require(std::fabs(sum - whole->volume) <= tolerance, "the pieces have the volume of the whole");
}

/// The same in the plane: any outline, any pattern.
void break_outline(Source& in) {
  std::vector<Vec2d> outline;
  for (int corners = in.byte() % 40; corners > 0; --corners) {
    const double x = double(in.number());
    outline.push_back({x, double(in.number())});
  }
  const int count = 1 + in.byte() % 30;
  const double x = double(in.number());
  const Vec2d point{x, double(in.number())};
  core::Result<Pattern2> pattern = core::Error{};
  switch (in.byte() % 4) {
    case 0:
      pattern = voronoi_pattern2(uniform_sites2({{-2, -2}, {2, 2}}, count, 1));
      break;
    case 1: {
      const auto sites = radial_sites2({.impact = point, .first_radius = double(in.size()), .limit = 4}, 2);
      pattern = sites.ok() ? voronoi_pattern2(*sites) : core::Result<Pattern2>(sites.error());
      break;
    }
    case 2:
      pattern = slab_pattern2(outline, point, count, 0.4, 3);
      break;
    default: {
      const double w = double(in.size());
      pattern = brick_pattern2(outline, {w, double(in.size())}, point);
      if (pattern.ok() && pattern->cells.size() > 1000) return;
    }
  }
  if (!pattern.ok()) return require(!pattern.error().message.empty(), "a refusal says why");
  const auto fracture = fracture_polygon(outline, *pattern, 1e-3);
  if (!fracture.ok()) return require(!fracture.error().message.empty(), "a refusal says why");
  double area = 0, sum = 0, extent = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    area += cross(outline[i] - outline[0], outline[(i + 1) % outline.size()] - outline[0]) / 2;
    extent = std::fmax(extent, std::fmax(std::fabs(outline[i].x), std::fabs(outline[i].y)));
  }
  for (const Piece2& piece : fracture->pieces) {
    require(piece.mass.mass > 0 && is_finite(piece.mass.center), "a piece has a mass and a centre");
    for (const geometry::Polygon& polygon : piece.polygons)
      require(geometry::validate(geometry::Shape2(polygon)).ok(), "every polygon is sound");
    sum += piece.mass.mass;
  }
  // An outline that touches itself may be inside out beyond: that is no piece.
  std::vector<math::Vec2f> corners(outline.begin(), outline.end());
  const bool simple = geometry::decompose_convex(corners).ok();
  require(sum >= area - 1e-9 * extent * extent, "nothing of the whole is lost");
  require(!simple || sum <= area + 1e-9 * extent * extent, "the pieces have the area of the whole");
  for (const Bond2& bond : fracture->bonds)
    require(bond.a != bond.b && bond.a < fracture->pieces.size() && bond.b < fracture->pieces.size() && bond.length > 0,
            "a bond joins two pieces");
}

}  // namespace

FUZZ_TARGET(fracture) {
  if (size < 2 || size > 2000) return;
  Source in(data, size);
  if (in.byte() % 4 == 3) return break_outline(in);
  const Mesh mesh = mesh_from(in);
  const auto pattern = pattern_from(in, container_of(mesh.vertices));
  if (!pattern.ok()) return require(!pattern.error().message.empty(), "a refusal says why");
  FractureOptions options;
  options.skin = double(in.byte()) / 2550;
  options.least_solidity = double(in.byte()) / 255;
  options.max_hulls = 1 + in.byte() % 3;
  const auto fracture = fracture_mesh(mesh.vertices, mesh.triangles, *pattern, options);
  if (!fracture.ok()) return require(!fracture.error().message.empty(), "a refusal says why");
  check(mesh, *fracture);
}
