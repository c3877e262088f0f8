#include "carom/geometry/detail/hull_faces.h"

#include <algorithm>

namespace carom::geometry::detail {

namespace {

namespace hull_faces {

constexpr std::uint32_t none = 0xFFFFFFFF;

struct Grouping {
  std::span<const GridPoint> points;
  std::span<const HullTriangle> triangles;
  std::vector<std::uint32_t> group;  // of each triangle
  std::uint32_t groups = 0;

  GridPoint normal(std::uint32_t t) const {
    const auto& c = triangles[t].corner;
    return normal_of(points[c[0]], points[c[1]], points[c[2]]);
  }
};

// Every group lies within tolerance of the plane of its largest triangle, which started it: no plane can drift round a
// smooth body.
void group_by_plane(Grouping& g, double tolerance) {
  const std::uint32_t n = std::uint32_t(g.triangles.size());
  std::vector<std::pair<double, std::uint32_t>> by_area(n);
  for (std::uint32_t t = 0; t < n; ++t) by_area[t] = {-math::length(to_vector(g.normal(t))), t};
  std::sort(by_area.begin(), by_area.end());
  g.group.assign(n, none);
  std::vector<std::uint32_t> open;
  for (const auto& [negative_area, seed] : by_area) {
    if (g.group[seed] != none) continue;
    const GridPoint plane = g.normal(seed);
    const GridPoint origin = g.points[g.triangles[seed].corner[0]];
    const double limit = tolerance * -negative_area;
    const auto lies_in_plane = [&](std::uint32_t t) {
      for (const std::uint32_t c : g.triangles[t].corner)
        if (math::abs(double(orient(plane, origin, g.points[c]))) > limit) return false;
      return true;
    };
    g.group[seed] = g.groups;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t other : g.triangles[t].neighbor) {
        if (g.group[other] != none || !lies_in_plane(other)) continue;
        g.group[other] = g.groups;
        open.push_back(other);
      }
    }
    ++g.groups;
  }
}

std::uint32_t edge_from(const HullTriangle& t, std::uint32_t corner) {
  return t.corner[0] == corner ? 0u : (t.corner[1] == corner ? 1u : 2u);
}

// The groups met on the way round a corner, once for each run of triangles.
std::vector<std::uint32_t> groups_around(const Grouping& g, std::uint32_t start, std::uint32_t corner) {
  std::vector<std::uint32_t> runs;
  std::uint32_t t = start;
  do {
    if (runs.empty() || runs.back() != g.group[t]) runs.push_back(g.group[t]);
    t = g.triangles[t].neighbor[(edge_from(g.triangles[t], corner) + 2) % 3];
  } while (t != start);
  if (runs.size() > 1 && runs.front() == runs.back()) runs.pop_back();
  return runs;
}

// Gives the triangles of a group whose border touches itself back to groups of their own.
bool split_pinched(Grouping& g) {
  std::vector<bool> pinched(g.groups, false);
  bool any = false;
  for (std::uint32_t t = 0; t < g.triangles.size(); ++t)
    for (const std::uint32_t c : g.triangles[t].corner) {
      std::vector<std::uint32_t> runs = groups_around(g, t, c);
      std::sort(runs.begin(), runs.end());
      for (std::size_t i = 1; i < runs.size(); ++i)
        if (runs[i] == runs[i - 1]) pinched[runs[i]] = any = true;
    }
  if (!any) return false;
  for (std::uint32_t& group : g.group)
    if (pinched[group]) group = g.groups++;
  return true;
}

}  // namespace hull_faces

}  // namespace

HullLoops merge_coplanar(std::span<const GridPoint> points, std::span<const HullTriangle> triangles, double tolerance) {
  using namespace hull_faces;
  Grouping g{points, triangles, {}, 0};
  group_by_plane(g, tolerance);
  if (split_pinched(g)) split_pinched(g);

  HullLoops result;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t c : triangles[t].corner)
      if (groups_around(g, t, c).size() < 3) result.surplus.push_back(c);
  std::sort(result.surplus.begin(), result.surplus.end());
  result.surplus.erase(std::unique(result.surplus.begin(), result.surplus.end()), result.surplus.end());
  if (!result.surplus.empty()) return result;

  std::vector<bool> done(g.groups, false);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t e = 0; e < 3; ++e) {
      if (done[g.group[t]] || g.group[triangles[t].neighbor[e]] == g.group[t]) continue;
      done[g.group[t]] = true;
      std::vector<std::uint32_t> loop;
      std::uint32_t triangle = t, edge = e;
      do {
        loop.push_back(triangles[triangle].corner[edge]);
        // To the next border edge: round the end of this one, through triangles of the same group.
        const std::uint32_t end = triangles[triangle].corner[(edge + 1) % 3];
        edge = (edge + 1) % 3;
        while (g.group[triangles[triangle].neighbor[edge]] == g.group[t]) {
          triangle = triangles[triangle].neighbor[edge];
          edge = edge_from(triangles[triangle], end);
        }
      } while (triangle != t || edge != e);
      result.loops.push_back(std::move(loop));
    }
  return result;
}

}  // namespace carom::geometry::detail
