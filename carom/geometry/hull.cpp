#include "carom/geometry/hull.h"

#include <algorithm>

#include "carom/geometry/detail/hull_faces.h"
#include "carom/geometry/detail/mass_hull.h"
#include "carom/geometry/detail/text.h"
#include "carom/geometry/detail/weld.h"

namespace carom::geometry {

namespace {

namespace hull_making {

using detail::GridPoint;

struct Cloud {
  std::vector<std::uint32_t> source;  // index of the input point
  std::vector<GridPoint> points;      // no two alike
  double cell = 1;                    // m
};

struct Extent {
  Vec3d low{}, high{};
  double size() const { return max(high.x - low.x, max(high.y - low.y, high.z - low.z)); }
  double farthest() const {
    const Vec3d m = max(abs(low), abs(high));
    return max(m.x, max(m.y, m.z));
  }
};

Extent extent_of(std::span<const Vec3f> points) {
  Extent e{Vec3d(points[0]), Vec3d(points[0])};
  for (const Vec3f& p : points) e.low = min(e.low, Vec3d(p)), e.high = max(e.high, Vec3d(p));
  return e;
}

Cloud snap(std::span<const Vec3f> points, const Extent& extent) {
  Cloud cloud;
  cloud.cell = extent.size() / double(detail::grid_size);
  const double scale = 1 / cloud.cell;
  const auto cell = [scale](double x) {
    return clamp(std::int64_t(x * scale + 0.5), std::int64_t(0), detail::grid_size);
  };
  std::vector<Vec3d> snapped;
  snapped.reserve(points.size());
  for (const Vec3f& p : points) {
    const Vec3d d = Vec3d(p) - extent.low;
    snapped.push_back({double(cell(d.x)), double(cell(d.y)), double(cell(d.z))});
  }
  const std::vector<std::uint32_t> welded = detail::weld_equal(std::span<const Vec3d>(snapped));
  for (std::uint32_t i = 0; i < snapped.size(); ++i) {
    if (welded[i] != i) continue;
    cloud.source.push_back(i);
    cloud.points.push_back({std::int64_t(snapped[i].x), std::int64_t(snapped[i].y), std::int64_t(snapped[i].z)});
  }
  return cloud;
}

// Keeps only the corners that the triangles use, but for those in `surplus` (sorted).
Cloud corners_of(const Cloud& cloud, std::span<const detail::HullTriangle> triangles,
                 std::span<const std::uint32_t> surplus) {
  std::vector<bool> used(cloud.points.size(), false);
  for (const detail::HullTriangle& t : triangles)
    for (const std::uint32_t c : t.corner) used[c] = true;
  for (const std::uint32_t c : surplus) used[c] = false;
  Cloud kept;
  kept.cell = cloud.cell;
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    kept.source.push_back(cloud.source[i]);
    kept.points.push_back(cloud.points[i]);
  }
  return kept;
}

core::Error error_of(detail::HullFailure failure, std::size_t count, const Extent& extent, double tolerance,
                     int max_vertices) {
  const char* where[] = {"", "in one place", "on one line", "in one plane", ""};
  if (failure == detail::HullFailure::too_many)
    return detail::error("make_hull: the hull of the %zu points has more than %d corners: simplify it, or allow more",
                         count, max_vertices);
  return detail::error("make_hull: the %zu points lie %s (to %g m in a cloud of %g m), expected a solid", count,
                       where[int(failure)], tolerance, extent.size());
}

// Newell's normal: right for a polygon that is planar only to rounding.
HullPlane plane_of(const std::vector<Vec3f>& vertices, const std::vector<std::uint32_t>& loop) {
  const Vec3d origin(vertices[loop[0]]);
  Vec3d normal{}, mean{};
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d a = Vec3d(vertices[loop[i]]) - origin, b = Vec3d(vertices[loop[(i + 1) % loop.size()]]) - origin;
    normal += cross(a, b);
    mean += a;
  }
  normal = normalize(normal);
  return {Vec3f(normal), float(dot(normal, origin + mean / double(loop.size())))};
}

struct Side {
  std::uint32_t low, high;
  std::uint32_t face, position;
  bool forward;
};

// Half-edges in pairs: the sides of all loops sorted by their ends, so that twins stand together.
bool add_topology(Hull& hull, const std::vector<std::vector<std::uint32_t>>& loops) {
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < loops.size(); ++f)
    for (std::uint32_t k = 0; k < loops[f].size(); ++k) {
      const std::uint32_t a = loops[f][k], b = loops[f][(k + 1) % loops[f].size()];
      sides.push_back({min(a, b), max(a, b), f, k, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.forward > b.forward;
  });
  std::vector<std::vector<std::uint16_t>> edge_at(loops.size());
  for (std::size_t f = 0; f < loops.size(); ++f) edge_at[f].resize(loops[f].size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side &side = sides[i], &other = sides[i ^ 1];
    if (side.low != other.low || side.high != other.high || side.forward == other.forward) return false;
    edge_at[side.face][side.position] = std::uint16_t(i);
  }
  hull.edges.resize(sides.size());
  for (std::size_t f = 0; f < loops.size(); ++f) {
    const std::size_t n = loops[f].size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint16_t e = edge_at[f][k];
      hull.edges[e] = {std::uint16_t(loops[f][k]), std::uint16_t(e ^ 1), edge_at[f][(k + 1) % n], std::uint16_t(f)};
    }
    hull.faces.push_back({edge_at[f][0], std::uint16_t(n)});
  }
  return true;
}

void add_measures(Hull& hull) {
  hull.bounds = {hull.vertices[0], hull.vertices[0]};
  for (const Vec3f& v : hull.vertices) hull.bounds = {min(hull.bounds.low, v), max(hull.bounds.high, v)};
  const Vec3d origin(hull.bounds.center());
  const float radius = hull.radius;
  hull.radius = 0;
  const detail::VolumeIntegrals sum = detail::integrate_hull(hull, origin);
  hull.radius = radius;
  hull.volume = float(sum.volume);
  const Vec3d centroid = sum.volume > 0 ? origin + sum.first / sum.volume : origin;
  hull.centroid = Vec3f(centroid);
  double inner = -1;
  for (const HullPlane& p : hull.planes) {
    const double d = double(p.offset) - dot(Vec3d(p.normal), centroid);
    if (inner < 0 || d < inner) inner = d;
  }
  hull.inner_radius = float(max(inner, 0.0));
}

std::vector<float> lanes_of(std::size_t count, auto&& vector) {
  std::vector<float> lanes((count + 3) / 4 * 12);
  for (std::size_t i = 0; i < lanes.size() / 3; ++i) {
    const Vec3f v = vector(i < count ? i : count - 1);
    for (std::size_t axis = 0; axis < 3; ++axis) lanes[i / 4 * 12 + 4 * axis + i % 4] = v[int(axis)];
  }
  return lanes;
}

Hull assemble(std::span<const Vec3f> points, const Cloud& cloud, const detail::HullLoops& faces, float radius) {
  Hull hull;
  hull.radius = radius;
  for (const std::uint32_t i : cloud.source) hull.vertices.push_back(points[i]);
  for (const auto& loop : faces.loops) hull.planes.push_back(plane_of(hull.vertices, loop));
  if (add_topology(hull, faces.loops)) add_measures(hull);
  hull.vertex_lanes = lanes_of(hull.vertices.size(), [&](std::size_t i) { return hull.vertices[i]; });
  hull.normal_lanes = lanes_of(hull.planes.size(), [&](std::size_t i) { return hull.planes[i].normal; });
  return hull;
}

}  // namespace hull_making

}  // namespace

double hull_tolerance(std::span<const Vec3f> points) {
  if (points.empty()) return 0;
  const hull_making::Extent extent = hull_making::extent_of(points);
  // Four cells of the grid, or what float can tell apart at this distance from the origin, whichever is coarser.
  return max(extent.size() * 4 / double(detail::grid_size), extent.farthest() * 4 * 1.1920929e-7);
}

core::Result<std::shared_ptr<const Hull>> make_hull(std::span<const Vec3f> points, const HullOptions& options) {
  using namespace hull_making;
  if (points.size() < 4) return detail::error("make_hull: %zu points, expected at least 4", points.size());
  constexpr std::size_t max_points = std::size_t(1) << 24;
  if (points.size() > max_points)
    return detail::error("make_hull: %zu points, expected at most %zu", points.size(), max_points);
  if (options.max_vertices < 4 || options.max_vertices > 255)
    return detail::error("make_hull: max_vertices is %d, expected 4 to 255", options.max_vertices);
  if (auto s = detail::check_range("make_hull: radius", options.radius, 0, max_shape_size); !s) return s.error();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (auto s = detail::check_point("it", points[i], max_shape_size); !s)
      return detail::error("make_hull: point %zu: %s", i, s.error().message.c_str());

  const Extent extent = extent_of(points);
  const double tolerance = hull_tolerance(points);
  if (!(extent.size() >= min_shape_size))
    return error_of(detail::HullFailure::point, points.size(), extent, tolerance, 0);
  Cloud cloud = snap(points, extent);
  const double grid_tolerance = tolerance / cloud.cell;
  const std::size_t limit = std::size_t(options.max_vertices);
  // Some corners may go when faces are merged, so that a few more than the limit are no error yet.
  detail::TriangulatedHull solid =
      detail::triangulate_hull(cloud.points, grid_tolerance, options.simplify ? limit : 4 * limit, options.simplify);
  std::vector<std::uint32_t> surplus;
  while (solid.failure == detail::HullFailure::none) {
    const Cloud corners = corners_of(cloud, solid.triangles, surplus);
    const bool settled = corners.points.size() == cloud.points.size();
    cloud = corners;
    if (!settled) {
      surplus.clear();
      solid = detail::triangulate_hull(cloud.points, 0, cloud.points.size(), true);
      continue;
    }
    const detail::HullLoops faces = detail::merge_coplanar(cloud.points, solid.triangles, 2 * grid_tolerance);
    if (!faces.surplus.empty()) {
      surplus = faces.surplus;
      continue;
    }
    if (cloud.points.size() > limit) {
      solid.failure = detail::HullFailure::too_many;
      break;
    }
    Hull hull = assemble(points, cloud, faces, options.radius);
    if (auto s = validate_hull(hull, {}, 4 * tolerance); !s)
      return detail::error("make_hull: no sound hull of these %zu points: %s", points.size(),
                           s.error().message.c_str());
    return std::shared_ptr<const Hull>(std::make_shared<Hull>(std::move(hull)));
  }
  return error_of(solid.failure, points.size(), extent, tolerance, options.max_vertices);
}

core::Status validate_hull(const Hull& hull, std::span<const Vec3f> points, double tolerance) {
  const std::size_t vertices = hull.vertices.size(), faces = hull.faces.size(), edges = hull.edges.size();
  if (vertices < 4 || vertices > 255 || faces < 4 || edges % 2 != 0 || hull.planes.size() != faces)
    return detail::error("hull: %zu vertices, %zu faces, %zu planes, %zu half-edges", vertices, faces,
                         hull.planes.size(), edges);
  if (vertices + faces != edges / 2 + 2)
    return detail::error("hull: %zu vertices − %zu edges + %zu faces is not 2", vertices, edges / 2, faces);
  std::vector<int> degree(vertices, 0);
  for (std::size_t e = 0; e < edges; ++e) {
    const HullEdge& edge = hull.edges[e];
    if (edge.twin != (e ^ 1) || edge.next >= edges || edge.origin >= vertices || edge.face >= faces)
      return detail::error("hull: half-edge %zu has twin %d, next %d, origin %d, face %d", e, edge.twin, edge.next,
                           edge.origin, edge.face);
    if (hull.edges[edge.next].origin != hull.edges[edge.twin].origin || hull.edges[edge.next].face != edge.face)
      return detail::error("hull: half-edge %zu is not followed by one that starts where it ends", e);
    ++degree[edge.origin];
  }
  for (std::size_t v = 0; v < vertices; ++v)
    if (degree[v] < 3) return detail::error("hull: vertex %zu has %d edges, expected at least 3", v, degree[v]);
  for (std::size_t f = 0; f < faces; ++f) {
    const HullFace& face = hull.faces[f];
    const HullPlane& plane = hull.planes[f];
    const Vec3d normal(plane.normal);
    if (face.edge_count < 3 || face.first_edge >= edges || !(abs(length(normal) - 1) < 1e-5))
      return detail::error("hull: face %zu has %d edges and a normal of length %g", f, face.edge_count, length(normal));
    std::size_t e = face.first_edge, n = 0;
    do {
      if (hull.edges[e].face != f || n > edges)
        return detail::error("hull: half-edge %zu on the way round face %zu belongs to another", e, f);
      const double off = dot(normal, Vec3d(hull.vertices[hull.edges[e].origin])) - double(plane.offset);
      if (!(abs(off) <= tolerance))
        return detail::error("hull: vertex %d stands %g m off its face %zu", hull.edges[e].origin, off, f);
      e = hull.edges[e].next, ++n;
    } while (e != face.first_edge);
    if (n != face.edge_count) return detail::error("hull: face %zu has %zu edges, says %d", f, n, face.edge_count);
    for (const auto& set : {std::span<const Vec3f>(hull.vertices), points})
      for (std::size_t i = 0; i < set.size(); ++i)
        if (const double above = dot(normal, Vec3d(set[i])) - double(plane.offset); !(above <= tolerance))
          return detail::error("hull: %s %zu stands %g m above face %zu",
                               set.data() == points.data() ? "point" : "vertex", i, above, f);
  }
  if (!(hull.volume > 0) || !(hull.inner_radius >= 0)) return detail::error("hull: volume %g", double(hull.volume));
  return {};
}

}  // namespace carom::geometry
