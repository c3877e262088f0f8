// Collision hulls straight from cells.
#include <algorithm>
#include <array>

#include "carom/blast/convex_cell.h"
#include "carom/blast/detail/cell_cutter.h"
#include "carom/blast/detail/solid_sum.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec3d;
using math::Vec3f;

namespace {

/// Cells have edges as short as chance makes them; floats and contacts want none shorter than this share of the size.
constexpr double shortest_edge = 2e-5;
constexpr double thinnest = 1e-5;  // m
constexpr std::size_t most_vertices = 96;
constexpr std::uint16_t nowhere = 0xffff;

/// Loops of the cell without short edges, in arrays of a fixed size: hulls are made by the hundred within a frame.
struct HullMaker {
  std::array<std::uint16_t, most_vertices> parent{}, degree{}, index{};
  std::vector<std::uint16_t> corners;
  struct Loop {
    const ConvexCell::Face* source;
    std::uint16_t first, count;
  };
  std::vector<Loop> loops;

  std::uint16_t root(std::uint16_t v) const {
    while (parent[v] != v) v = parent[v];
    return v;
  }
  /// False where what is left is not a polyhedron.
  bool collect(const ConvexCell& cell, double limit) {
    const auto points = cell.vertices();
    for (std::size_t i = 0; i < points.size(); ++i) parent[i] = std::uint16_t(i);
    bool merged = false;
    for (const ConvexCell::Face& face : cell.faces()) {
      const auto loop = cell.loop(face);
      std::uint16_t before = loop[loop.size() - 1];
      for (const std::uint16_t here : loop) {
        if (before < here && distance_squared(points[before], points[here]) < limit * limit) {
          const std::uint16_t a = root(before), b = root(here);
          parent[math::max(a, b)] = math::min(a, b);
          merged = true;
        }
        before = here;
      }
    }
    corners.reserve(2 * std::size_t(cell.edge_count()));
    loops.reserve(cell.faces().size());
    for (const ConvexCell::Face& face : cell.faces()) {
      const std::size_t first = corners.size();
      for (const std::uint16_t v : cell.loop(face)) {
        const std::uint16_t r = merged ? root(v) : v;
        if (corners.size() == first || corners.back() != r) corners.push_back(r);
      }
      while (corners.size() > first + 1 && corners.back() == corners[first]) corners.pop_back();
      if (corners.size() < first + 3) {
        corners.resize(first);
        continue;
      }
      loops.push_back({&face, std::uint16_t(first), std::uint16_t(corners.size() - first)});
    }
    if (!merged) return true;
    for (const std::uint16_t v : corners) ++degree[v];
    // Two faces at a corner: it lies within an edge, and goes from both.
    std::size_t write = 0;
    for (Loop& loop : loops) {
      const std::size_t first = write;
      for (std::size_t k = loop.first; k < std::size_t(loop.first) + loop.count; ++k)
        if (degree[corners[k]] >= 3) corners[write++] = corners[k];
      loop.first = std::uint16_t(first), loop.count = std::uint16_t(write - first);
      if (loop.count < 3) return false;
    }
    corners.resize(write);
    return loops.size() >= 4;
  }
};

void set_lanes(std::vector<float>& lanes, std::size_t count, auto&& vector) {
  lanes.resize((count + 3) / 4 * 12);
  for (std::size_t i = 0; i < lanes.size() / 3; ++i) {
    const Vec3f v = vector(i < count ? i : count - 1);
    float* const place = lanes.data() + i / 4 * 12 + i % 4;
    place[0] = v.x, place[4] = v.y, place[8] = v.z;
  }
}

/// Half-edges of the loops, in pairs in the order in which they are met first.
bool link(geometry::Hull& hull, const HullMaker& maker) {
  const std::size_t vertices = hull.vertices.size(), count = maker.corners.size();
  if (count % 2 != 0) return false;
  std::array<std::uint16_t, most_vertices * most_vertices> edge_between;  // row: from, column: to
  std::fill_n(edge_between.begin(), vertices * vertices, nowhere);
  hull.edges.resize(count);
  hull.faces.reserve(maker.loops.size());
  std::uint16_t made = 0;
  const auto loops = std::uint16_t(maker.loops.size());
  for (std::uint16_t f = 0; f < loops; ++f) {
    const HullMaker::Loop& loop = maker.loops[f];
    std::uint16_t first = nowhere, last = nowhere;
    for (std::size_t k = 0; k < loop.count; ++k) {
      const std::uint16_t a = maker.corners[loop.first + k],
                          b = maker.corners[loop.first + (k + 1 < loop.count ? k + 1 : 0)];
      std::uint16_t e = edge_between[a * vertices + b];
      if (e == nowhere) {
        if (made + 2u > count) return false;
        e = made;
        edge_between[b * vertices + a] = std::uint16_t(made + 1);
        edge_between[a * vertices + b] = e;
        hull.edges[e].face = hull.edges[e + 1u].face = nowhere;
        made = std::uint16_t(made + 2);
      }
      if (hull.edges[e].face != nowhere) return false;
      hull.edges[e] = {a, std::uint16_t(e ^ 1), 0, f};
      if (last != nowhere) hull.edges[last].next = e;
      if (first == nowhere) first = e;
      last = e;
    }
    hull.edges[last].next = first;
    hull.faces.push_back({first, loop.count});
  }
  return made == count && vertices + hull.faces.size() == count / 2 + 2;
}

std::shared_ptr<const geometry::Hull> by_search(const ConvexCell& solid, Vec3d origin) {
  std::vector<Vec3f> points;
  for (const Vec3d& v : solid.vertices()) points.push_back(Vec3f(v - origin));
  geometry::HullOptions options;
  options.simplify = true;
  const auto hull = geometry::make_hull(points, options);
  return hull.ok() ? *hull : nullptr;
}

struct Extent {
  double volume = 0, inner = 1e300, size = 0;  // m³, m, m
  Vec3d center{};
};

void finish(geometry::Hull& hull, const Extent& extent, Vec3d origin) {
  hull.bounds = {hull.vertices[0], hull.vertices[0]};
  for (const Vec3f& v : hull.vertices) hull.bounds = {min(hull.bounds.low, v), max(hull.bounds.high, v)};
  hull.volume = float(extent.volume);
  hull.centroid = Vec3f(extent.center - origin);
  hull.inner_radius = float(extent.inner);
  set_lanes(hull.vertex_lanes, hull.vertices.size(), [&](std::size_t i) { return hull.vertices[i]; });
  set_lanes(hull.normal_lanes, hull.planes.size(), [&](std::size_t i) { return hull.planes[i].normal; });
}

/// Whether a solid is one, and thick enough. Its centre is the centre of mass.
bool measure(const ConvexCell& solid, std::span<const Vec3d> corners, double inward, Extent& extent) {
  detail::FanSum sum(corners[0]);
  const std::uint16_t* loop = solid.loops().data();
  for (const ConvexCell::Face& face : solid.faces()) {
    sum.add(face.count, [&](std::size_t k) { return corners[loop[k]]; });
    loop += face.count;
  }
  extent.volume = sum.volume();
  if (!(extent.volume > 0)) return false;
  extent.center = sum.center();
  for (const ConvexCell::Face& face : solid.faces())
    extent.inner = math::min(extent.inner, face.offset - inward - dot(face.normal, extent.center));
  for (const Vec3d& v : corners) {
    const Vec3d d = v - extent.center;
    extent.size =
        math::max(extent.size, math::max(math::max(d.x, -d.x), math::max(math::max(d.y, -d.y), math::max(d.z, -d.z))));
  }
  return extent.inner > thinnest;
}

enum class Made { hull, nothing_left, not_here };

/// The hull of a cell that knows its twins, with every face moved inward by `skin` m. `not_here`: edges would turn
/// round or are too short, or more than three faces meet at a corner.
Made from_twins(const ConvexCell& cell, Vec3d origin, double skin, std::shared_ptr<const geometry::Hull>& made) {
  constexpr std::size_t most_corners = detail::CellCutter::most_corners, most_edges = detail::CellCutter::most_edges;
  const auto loops = cell.loops(), twins = cell.twins();
  const auto points = cell.vertices();
  const auto faces = cell.faces();
  if (twins.empty() || points.size() > most_corners || loops.size() > most_edges) return Made::not_here;
  // A corner moves by m with n·m = −skin for its three faces: as long as no edge turns round, none vanished on the way,
  // for its length is linear in the skin.
  std::array<Vec3d, most_corners> corners;
  if (skin > 0) {
    std::array<std::uint16_t, 4 * most_corners> faces_at;
    std::array<std::uint8_t, most_corners> degree{};
    const std::uint16_t* loop = loops.data();
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const std::uint16_t* const end = loop + faces[f].count; loop != end; ++loop)
        faces_at[4 * std::size_t(*loop) + (degree[*loop]++ & 3)] = std::uint16_t(f);
    for (std::size_t v = 0; v < points.size(); ++v) {
      const Vec3d &a = faces[faces_at[4 * v]].normal, &b = faces[faces_at[4 * v + 1]].normal,
                  &c = faces[faces_at[4 * v + 2]].normal;
      const Vec3d bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
      const double determinant = dot(a, bc);
      if (!(determinant * determinant > 1e-6)) return Made::not_here;
      corners[v] = points[v] - (skin / determinant) * (bc + ca + ab);
    }
  } else {
    std::copy(points.begin(), points.end(), corners.begin());
  }
  // Half-edges are named in pairs.
  std::array<std::uint16_t, most_edges> pair, first_of;
  std::size_t count = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    pair[i] = std::uint16_t(count), first_of[count] = std::uint16_t(i);
    count += twins[i] > i;
  }
  double shortest_squared = 1e300;
  bool turned = false;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t v = loops[first_of[k]], w = loops[twins[first_of[k]]];
    const Vec3d before = points[w] - points[v], after = corners[w] - corners[v];
    shortest_squared = math::min(shortest_squared, length_squared(after));
    turned |= !(dot(after, before) > 0.01 * length_squared(before));
  }
  if (turned) return Made::not_here;
  Extent extent;
  if (!measure(cell, {corners.data(), points.size()}, skin, extent)) return Made::nothing_left;
  if (shortest_squared < math::square(shortest_edge * extent.size)) return Made::not_here;
  std::array<std::uint16_t, most_edges> name;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const bool second = twins[i] < i;
    name[i] = std::uint16_t(2 * pair[second ? twins[i] : i] + second);
  }
  auto hull = std::make_shared<geometry::Hull>();
  hull->vertices.resize(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) hull->vertices[v] = Vec3f(corners[v] - origin);
  hull->edges.resize(loops.size()), hull->faces.resize(faces.size()), hull->planes.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const ConvexCell::Face& face = faces[f];
    std::uint16_t next = name[face.first];
    for (std::size_t i = face.first + face.count; i-- > face.first;) {
      const std::uint16_t e = name[i];
      hull->edges[e] = {loops[i], std::uint16_t(e ^ 1), next, std::uint16_t(f)};
      next = e;
    }
    hull->faces[f] = {next, std::uint16_t(face.count)};
    hull->planes[f] = {Vec3f(face.normal), float(face.offset - skin - dot(face.normal, origin))};
  }
  finish(*hull, extent, origin);
  made = std::move(hull);
  return Made::hull;
}

/// Of cells with short edges, or of many corners.
std::shared_ptr<const geometry::Hull> from_loops(const ConvexCell& solid, Vec3d origin) {
  Extent extent;
  if (!measure(solid, solid.vertices(), 0, extent)) return nullptr;
  HullMaker maker;
  if (solid.vertices().size() > most_vertices || !maker.collect(solid, shortest_edge * extent.size))
    return by_search(solid, origin);
  auto hull = std::make_shared<geometry::Hull>();
  hull->vertices.reserve(solid.vertices().size());
  maker.index.fill(nowhere);
  for (std::uint16_t& v : maker.corners) {
    if (maker.index[v] == nowhere) {
      maker.index[v] = std::uint16_t(hull->vertices.size());
      hull->vertices.push_back(Vec3f(solid.vertices()[v] - origin));
    }
    v = maker.index[v];
  }
  hull->planes.reserve(maker.loops.size());
  for (const HullMaker::Loop& loop : maker.loops)
    hull->planes.push_back({Vec3f(loop.source->normal), float(loop.source->offset - dot(loop.source->normal, origin))});
  if (!link(*hull, maker)) return by_search(solid, origin);
  finish(*hull, extent, origin);
  return hull;
}

}  // namespace

std::shared_ptr<const geometry::Hull> make_cell_hull(const ConvexCell& cell, Vec3d origin, double skin) {
  if (cell.empty()) return nullptr;
  std::shared_ptr<const geometry::Hull> hull;
  if (from_twins(cell, origin, skin, hull) != Made::not_here) return hull;
  ConvexCell solid;
  detail::CellCutter cutter;
  bool fits = cutter.load(cell, {});
  for (std::size_t f = 0; f < cell.faces().size() && fits && skin > 0; ++f) {
    const ConvexCell::Face& face = cell.faces()[f];
    if (cutter.clip(face.normal, face.offset - skin, face.tag) == ConvexCell::Cut::all) return nullptr;
    fits = cutter.fits();
  }
  if (!fits || !solid.take(cutter)) {
    solid = cell;
    ConvexCell::Scratch scratch;
    for (const ConvexCell::Face& face : cell.faces())
      if (skin > 0 && solid.clip({face.normal, face.offset - skin, face.tag}, scratch) == ConvexCell::Cut::all)
        return nullptr;
  }
  if (from_twins(solid, origin, 0, hull) != Made::not_here) return hull;
  return from_loops(solid, origin);
}

}  // namespace carom::blast
