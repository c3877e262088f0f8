// Collision hulls straight from cells.
#include <algorithm>
#include <array>

#include "carom/blast/convex_cell.h"
#include "carom/blast/detail/cell_cutter.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec3d;
using math::Vec3f;

namespace {

/// Cells have edges as short as chance makes them; floats and contacts want none shorter than this share of the size.
constexpr double shortest_edge = 2e-5;
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

/// Volume (m³) and centre of a cell, without the second moments that a hull does not ask for.
struct Bulk {
  double volume = 0;
  Vec3d center{};
};
Bulk bulk_of(const ConvexCell& cell) {
  const auto points = cell.vertices();
  const Vec3d o = points[0];
  double six = 0;
  Vec3d sum{};
  for (const ConvexCell::Face& face : cell.faces()) {
    const auto loop = cell.loop(face);
    const Vec3d a = points[loop[0]] - o;
    Vec3d b = points[loop[1]] - o;
    for (std::size_t k = 2; k < loop.size(); ++k) {
      const Vec3d c = points[loop[k]] - o;
      const double part = triple(a, b, c);
      six += part;
      sum += part * (a + b + c);
      b = c;
    }
  }
  if (!(six > 0)) return {};
  return {six / 6, o + sum / (4 * six)};
}

std::shared_ptr<const geometry::Hull> by_search(const ConvexCell& solid, Vec3d origin) {
  std::vector<Vec3f> points;
  for (const Vec3d& v : solid.vertices()) points.push_back(Vec3f(v - origin));
  geometry::HullOptions options;
  options.simplify = true;
  const auto hull = geometry::make_hull(points, options);
  return hull.ok() ? *hull : nullptr;
}

}  // namespace

std::shared_ptr<const geometry::Hull> make_cell_hull(const ConvexCell& cell, Vec3d origin, double skin) {
  constexpr double thinnest = 1e-5;
  const ConvexCell* solid = &cell;
  ConvexCell shrunk;
  if (skin > 0) {
    shrunk = cell;
    if (!shrunk.shrink(skin)) {
      detail::CellCutter cutter;
      bool fits = cutter.load(cell, cell.tolerance());
      for (std::size_t f = 0; f < cell.faces().size() && fits; ++f) {
        const ConvexCell::Face& face = cell.faces()[f];
        if (cutter.clip(face.normal, face.offset - skin, face.tag) == ConvexCell::Cut::all) return nullptr;
        fits = cutter.fits();
      }
      if (fits) {
        shrunk.take(cutter, cell.tolerance());
      } else {
        ConvexCell::Scratch scratch;
        for (const ConvexCell::Face& face : cell.faces())
          if (shrunk.clip({face.normal, face.offset - skin, face.tag}, scratch) == ConvexCell::Cut::all) return nullptr;
      }
    }
    solid = &shrunk;
  }
  if (solid->empty()) return nullptr;
  const Bulk bulk = bulk_of(*solid);
  if (!(bulk.volume > 0)) return nullptr;
  double inner = 1e300, size = 0;
  for (const ConvexCell::Face& face : solid->faces())
    inner = math::min(inner, face.offset - dot(face.normal, bulk.center));
  for (const Vec3d& v : solid->vertices()) {
    const Vec3d d = abs(v - bulk.center);
    size = math::max(size, math::max(d.x, math::max(d.y, d.z)));
  }
  if (!(inner > thinnest)) return nullptr;

  HullMaker maker;
  if (solid->vertices().size() > most_vertices || !maker.collect(*solid, shortest_edge * size))
    return by_search(*solid, origin);
  auto hull = std::make_shared<geometry::Hull>();
  hull->vertices.reserve(solid->vertices().size());
  maker.index.fill(nowhere);
  for (std::uint16_t& v : maker.corners) {
    if (maker.index[v] == nowhere) {
      maker.index[v] = std::uint16_t(hull->vertices.size());
      hull->vertices.push_back(Vec3f(solid->vertices()[v] - origin));
    }
    v = maker.index[v];
  }
  hull->planes.reserve(maker.loops.size());
  for (const HullMaker::Loop& loop : maker.loops)
    hull->planes.push_back({Vec3f(loop.source->normal), float(loop.source->offset - dot(loop.source->normal, origin))});
  if (!link(*hull, maker)) return by_search(*solid, origin);
  hull->bounds = {hull->vertices[0], hull->vertices[0]};
  for (const Vec3f& v : hull->vertices) hull->bounds = {min(hull->bounds.low, v), max(hull->bounds.high, v)};
  hull->volume = float(bulk.volume);
  hull->centroid = Vec3f(bulk.center - origin);
  hull->inner_radius = float(inner);
  set_lanes(hull->vertex_lanes, hull->vertices.size(), [&](std::size_t i) { return hull->vertices[i]; });
  set_lanes(hull->normal_lanes, hull->planes.size(), [&](std::size_t i) { return hull->planes[i].normal; });
  return hull;
}

}  // namespace carom::blast
