// Caps of cuts: polygons with holes as triangles. Ear clipping after each hole has been joined to its outer loop by a
// bridge (Held, "FIST: fast industrial-strength triangulation of polygons", 2001, has both); where rounding leaves no
// ear, the least bad corner goes, so that the triangles always close the mesh.
#include <algorithm>

#include "carom/blast/detail/mesh_cut.h"
#include "carom/math/elementary.h"

namespace carom::blast::detail {

using math::Vec2d;
using math::Vec3d;

namespace {

struct Corner {
  Vec2d p;
  std::uint32_t vertex;
};
using Loop = std::vector<Corner>;

double twice_area(const Loop& loop) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += cross(loop[i].p - loop[0].p, loop[i + 1].p - loop[0].p);
  return sum;
}

bool contains(const Loop& loop, Vec2d p) {
  bool in = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Vec2d a = loop[i].p, b = loop[j].p;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y))) in = !in;
  }
  return in;
}

bool in_triangle(Vec2d p, Vec2d a, Vec2d b, Vec2d c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

/// Joins the hole to the outer loop by a pair of edges from its rightmost corner to one that it sees.
void join(Loop& outer, Loop hole) {
  std::size_t right = 0;
  for (std::size_t i = 1; i < hole.size(); ++i)
    if (hole[i].p.x > hole[right].p.x) right = i;
  const Vec2d m = hole[right].p;
  // The nearest edge to the right of m at its height.
  double nearest = 1e300;
  std::size_t bridge = outer.size();
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const Vec2d a = outer[i].p, b = outer[(i + 1) % outer.size()].p;
    if (!(a.y <= m.y && b.y > m.y)) continue;  // the inside lies to its left
    const double x = a.x + (b.x - a.x) * ((m.y - a.y) / (b.y - a.y));
    if (x >= m.x && x < nearest) {
      nearest = x;
      bridge = a.x > b.x ? i : (i + 1) % outer.size();
    }
  }
  if (bridge == outer.size()) {  // rounding: the nearest corner
    double best = 1e300;
    for (std::size_t i = 0; i < outer.size(); ++i)
      if (const double d = distance_squared(outer[i].p, m); d < best) best = d, bridge = i;
  } else {
    // Corners within the triangle to that end hide it: the one in the flattest direction is seen.
    const Vec2d end = outer[bridge].p, at{nearest, m.y};
    double flattest = 1e300, least = 1e300;
    for (std::size_t i = 0; i < outer.size(); ++i) {
      const Vec2d p = outer[i].p;
      const bool within = end.y >= m.y ? in_triangle(p, m, at, end) : in_triangle(p, m, end, at);
      if (!within || !(p.x > m.x)) continue;
      // Of corners in one place the one whose angle opens toward m.
      const Vec2d before = outer[(i + outer.size() - 1) % outer.size()].p, after = outer[(i + 1) % outer.size()].p;
      const bool convex = cross(p - before, after - p) > 0;
      const bool left_of_in = cross(p - before, m - before) > 0, left_of_out = cross(after - p, m - p) > 0;
      if (!(convex ? left_of_in && left_of_out : left_of_in || left_of_out)) continue;
      const double slope = math::abs(p.y - m.y) / (p.x - m.x), far = p.x - m.x;
      if (slope < flattest || (slope == flattest && far < least)) flattest = slope, least = far, bridge = i;
    }
  }
  Loop joined(outer.begin(), outer.begin() + std::ptrdiff_t(bridge) + 1);
  for (std::size_t i = 0; i <= hole.size(); ++i) joined.push_back(hole[(right + i) % hole.size()]);
  joined.insert(joined.end(), outer.begin() + std::ptrdiff_t(bridge), outer.end());
  outer = std::move(joined);
}

void clip_ears(const Loop& loop, std::int32_t source, std::vector<CutMesh::Triangle>& out) {
  std::vector<std::uint32_t> left(loop.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<char> reflex(loop.size());
  const auto turn = [&](std::size_t i) {
    const std::size_t n = left.size();
    const Vec2d a = loop[left[(i + n - 1) % n]].p, b = loop[left[i]].p, c = loop[left[(i + 1) % n]].p;
    return cross(b - a, c - b);
  };
  for (std::size_t i = 0; i < left.size(); ++i) reflex[left[i]] = !(turn(i) > 0);
  const auto is_ear = [&](std::size_t i) {
    const std::size_t n = left.size();
    if (reflex[left[i]]) return false;
    const Vec2d a = loop[left[(i + n - 1) % n]].p, b = loop[left[i]].p, c = loop[left[(i + 1) % n]].p;
    for (const std::uint32_t v : left) {
      if (!reflex[v]) continue;
      const Vec2d p = loop[v].p;
      if (p == a || p == b || p == c) continue;
      if (in_triangle(p, a, b, c)) return false;
    }
    return true;
  };
  std::size_t start = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t ear = n;
    for (std::size_t tries = 0; tries < n && ear == n; ++tries)
      if (is_ear((start + tries) % n)) ear = (start + tries) % n;
    if (ear == n) {
      ear = 0;
      for (std::size_t i = 1; i < n; ++i)
        if (turn(i) > turn(ear)) ear = i;
    }
    const std::size_t before = (ear + n - 1) % n, after = (ear + 1) % n;
    out.push_back({{loop[left[before]].vertex, loop[left[ear]].vertex, loop[left[after]].vertex}, source});
    left.erase(left.begin() + std::ptrdiff_t(ear));
    for (const std::size_t i : {ear % (n - 1), (ear + n - 2) % (n - 1)}) reflex[left[i]] = !(turn(i) > 0);
    start = (ear + n - 2) % (n - 1);
  }
  out.push_back({{loop[left[0]].vertex, loop[left[1]].vertex, loop[left[2]].vertex}, source});
}

}  // namespace

void triangulate_loops(const std::vector<Vec3d>& vertices, std::vector<std::vector<std::uint32_t>>& loops, Vec3d normal,
                       std::int32_t source, std::vector<CutMesh::Triangle>& out) {
  const Vec3d u = normalize(perpendicular(normal)), v = cross(normal, u);
  struct Flat {
    Loop loop;
    double area;
    std::vector<std::size_t> holes;
  };
  std::vector<Flat> outer, holes;
  for (const auto& corners : loops) {
    if (corners.size() < 3) continue;  // cannot be: a loop goes through three triangles at least
    const Vec3d o = vertices[loops[0][0]];
    Flat flat;
    for (const std::uint32_t c : corners) flat.loop.push_back({{dot(vertices[c] - o, u), dot(vertices[c] - o, v)}, c});
    flat.area = twice_area(flat.loop);
    (flat.area >= 0 ? outer : holes).push_back(std::move(flat));
  }
  for (std::size_t h = 0; h < holes.size(); ++h) {
    std::size_t best = outer.size();
    for (std::size_t o = 0; o < outer.size(); ++o)
      if (outer[o].area > -holes[h].area && contains(outer[o].loop, holes[h].loop[0].p) &&
          (best == outer.size() || outer[o].area < outer[best].area))
        best = o;
    if (best < outer.size())
      outer[best].holes.push_back(h);
    else
      clip_ears(holes[h].loop, source, out);  // closed all the same
  }
  for (Flat& flat : outer) {
    // From the right: a bridge may end on a hole that was joined before.
    const auto right = [&](std::size_t h) {
      double x = holes[h].loop[0].p.x;
      for (const Corner& c : holes[h].loop) x = math::max(x, c.p.x);
      return x;
    };
    std::sort(flat.holes.begin(), flat.holes.end(), [&](std::size_t a, std::size_t b) {
      const double xa = right(a), xb = right(b);
      return xa != xb ? xa > xb : a < b;
    });
    for (const std::size_t h : flat.holes) join(flat.loop, holes[h].loop);
    clip_ears(flat.loop, source, out);
  }
}

}  // namespace carom::blast::detail
