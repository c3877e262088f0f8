// Simple polygons with holes as convex polygons. All questions of side are answered by integers: corners are on a grid
// fine enough for floats, and products of two differences fit into 64 bits.
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "carom/geometry/decomposition.h"
#include "carom/geometry/detail/text.h"

namespace carom::geometry {
namespace {
namespace decomposition2 {

using Index = std::int32_t;
using Loop = std::vector<Index>;

struct GridPoint {
  std::int64_t x = 0, y = 0;
  friend bool operator==(const GridPoint&, const GridPoint&) = default;
  friend bool operator<(const GridPoint& a, const GridPoint& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }
};

/// Corners of all loops in one row.
struct Corners {
  std::vector<Vec2f> place;
  std::vector<GridPoint> grid;

  /// Twice the area of a triangle, positive where a, b, c go counterclockwise.
  std::int64_t turn(Index a, Index b, Index c) const {
    const GridPoint &p = at(a), &q = at(b), &r = at(c);
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  }
  std::int64_t distance_squared(Index a, Index b) const {
    const std::int64_t dx = at(a).x - at(b).x, dy = at(a).y - at(b).y;
    return dx * dx + dy * dy;
  }
  const GridPoint& at(Index i) const { return grid[std::size_t(i)]; }
  /// On the segment, ends included.
  bool on(Index p, Index a, Index b) const {
    const GridPoint &g = at(p), &s = at(a), &t = at(b);
    return turn(a, b, p) == 0 && g.x >= std::min(s.x, t.x) && g.x <= std::max(s.x, t.x) && g.y >= std::min(s.y, t.y) &&
           g.y <= std::max(s.y, t.y);
  }
  /// Do the segments have a point in common?
  bool meet(Index a, Index b, Index c, Index d) const {
    const auto sign = [](std::int64_t x) { return x > 0 ? 1 : (x < 0 ? -1 : 0); };
    const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d)), cda = sign(turn(c, d, a)),
              cdb = sign(turn(c, d, b));
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return on(c, a, b) || on(d, a, b) || on(a, c, d) || on(b, c, d);
  }
  std::int64_t twice_area(const Loop& loop) const {
    std::uint64_t sum = 0;  // on the way round a spiral it may go round once more
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += std::uint64_t(turn(loop[0], loop[i], loop[i + 1]));
    return std::int64_t(sum);
  }
  /// A corner that is on none of the loop's sides.
  bool inside(Index p, const Loop& loop) const {
    bool in = false;
    for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
      const bool up = at(loop[j]).y <= at(p).y, up_end = at(loop[i]).y <= at(p).y;
      if (up != up_end && (turn(loop[j], loop[i], p) > 0) == up) in = !in;
    }
    return in;
  }
  /// Does the inside of a loop, which is to the left of its sides, lie at `a` in the direction of p?
  bool in_cone(Index before, Index a, Index after, Index p) const {
    if (turn(before, a, after) > 0) return turn(a, p, before) > 0 && turn(p, a, after) > 0;
    return !(turn(a, p, after) >= 0 && turn(p, a, before) >= 0);
  }
};

/// "outline" or "holes[k]", and which corner of it.
struct Name {
  std::string loop;
  std::size_t corner;
};
Name name_of(const std::vector<Loop>& loops, Index corner) {
  std::size_t k = 0, first = 0;
  while (std::size_t(corner) >= first + loops[k].size()) first += loops[k++].size();
  return {k == 0 ? std::string("outline") : detail::text("holes[%zu]", k - 1), std::size_t(corner) - first};
}

/// What is wrong with the loops, which are as they were given.
core::Status check_loops(const Corners& c, const std::vector<Loop>& loops) {
  Loop order;
  for (const Loop& loop : loops) order.insert(order.end(), loop.begin(), loop.end());
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return c.at(a) == c.at(b) ? a < b : c.at(a) < c.at(b); });
  for (std::size_t i = 0; i + 1 < order.size(); ++i)
    if (c.at(order[i]) == c.at(order[i + 1])) {
      const Name a = name_of(loops, order[i]), b = name_of(loops, order[i + 1]);
      return detail::error(
          "decompose_convex: corner %zu of %s and corner %zu of %s are at one place, expected them apart", a.corner,
          a.loop.c_str(), b.corner, b.loop.c_str());
    }
  // Sides by their left ends: only those that overlap in x are compared.
  struct Side {
    Index a, b;
    std::int64_t left, right;
  };
  std::vector<Side> sides;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index a = loop[i], b = loop[(i + 1) % loop.size()];
      sides.push_back({a, b, std::min(c.at(a).x, c.at(b).x), std::max(c.at(a).x, c.at(b).x)});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& l, const Side& r) { return l.left != r.left ? l.left < r.left : l.a < r.a; });
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size() && sides[j].left <= sides[i].right; ++j) {
      const Side &s = sides[i], &t = sides[j];
      const bool follows = s.b == t.a, leads = t.b == s.a;
      const bool meets = follows ? c.on(t.b, s.a, s.b) || c.on(s.a, t.a, t.b)
                                 : (leads ? c.on(s.b, t.a, t.b) || c.on(t.a, s.a, s.b) : c.meet(s.a, s.b, t.a, t.b));
      if (!meets) continue;
      const Name a = name_of(loops, s.a), b = name_of(loops, t.a);
      return detail::error(
          "decompose_convex: the side behind corner %zu of %s meets the side behind corner %zu of %s, expected "
          "outlines "
          "that meet neither themselves nor each other",
          a.corner, a.loop.c_str(), b.corner, b.loop.c_str());
    }
  for (std::size_t k = 1; k < loops.size(); ++k) {
    if (!c.inside(loops[k][0], loops[0]))
      return detail::error("decompose_convex: holes[%zu] lies outside the outline, expected it inside", k - 1);
    for (std::size_t m = 1; m < loops.size(); ++m)
      if (m != k && c.inside(loops[k][0], loops[m]))
        return detail::error("decompose_convex: holes[%zu] lies in holes[%zu], expected them apart", k - 1, m - 1);
  }
  return {};
}

/// Joins a hole to the loop round it by a bridge, there and back, from its rightmost corner to the nearest that it
/// sees. Of what lies further right all is joined already: there is one to see.
bool bridge(const Corners& c, Loop& loop, const Loop& hole, std::span<const Loop> others) {
  const std::size_t from = std::size_t(
      std::max_element(hole.begin(), hole.end(), [&](Index a, Index b) { return c.at(a) < c.at(b); }) - hole.begin());
  const std::size_t n = hole.size();
  const Index m = hole[from];
  std::vector<std::size_t> near(loop.size());
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = i;
  std::sort(near.begin(), near.end(), [&](std::size_t a, std::size_t b) {
    const std::int64_t da = c.distance_squared(m, loop[a]), db = c.distance_squared(m, loop[b]);
    return da != db ? da < db : a < b;
  });
  const auto crosses = [&](const Loop& sides, Index v) {
    for (std::size_t i = 0, j = sides.size() - 1; i < sides.size(); j = i++) {
      const Index a = sides[j], b = sides[i];
      if (a == v || b == v || a == m || b == m) {
        // A side that begins at an end of the bridge may not run along it.
        const Index far = a == v || a == m ? b : a;
        if (far != v && far != m && c.on(far, m, v)) return true;
        continue;
      }
      if (c.meet(m, v, a, b)) return true;
    }
    return false;
  };
  for (const std::size_t to : near) {
    const Index v = loop[to];
    if (!c.in_cone(loop[(to + loop.size() - 1) % loop.size()], v, loop[(to + 1) % loop.size()], m) ||
        !c.in_cone(hole[(from + n - 1) % n], m, hole[(from + 1) % n], v) || crosses(loop, v) || crosses(hole, v) ||
        std::any_of(others.begin(), others.end(), [&](const Loop& other) { return crosses(other, v); }))
      continue;
    Loop joined(loop.begin(), loop.begin() + std::ptrdiff_t(to) + 1);
    for (std::size_t i = 0; i <= n; ++i) joined.push_back(hole[(from + i) % n]);
    joined.insert(joined.end(), loop.begin() + std::ptrdiff_t(to), loop.end());
    loop = std::move(joined);
    return true;
  }
  return false;
}

using Triangle = std::array<Index, 3>;

/// Cuts ears off until nothing is left.
bool cut_ears(const Corners& c, const Loop& loop, std::vector<Triangle>& out) {
  const std::size_t n = loop.size();
  std::vector<std::size_t> before(n), after(n);
  for (std::size_t i = 0; i < n; ++i) before[i] = (i + n - 1) % n, after[i] = (i + 1) % n;
  const auto turn_at = [&](std::size_t i) { return c.turn(loop[before[i]], loop[i], loop[after[i]]); };
  const auto is_ear = [&](std::size_t i) {
    if (turn_at(i) <= 0) return false;
    const Index p = loop[before[i]], q = loop[i], r = loop[after[i]];
    for (std::size_t k = after[after[i]]; k != before[i]; k = after[k]) {
      const Index v = loop[k];
      if (v == p || v == q || v == r || turn_at(k) > 0) continue;
      if (c.turn(p, q, v) >= 0 && c.turn(q, r, v) >= 0 && c.turn(r, p, v) >= 0) return false;
    }
    return true;
  };
  std::size_t at = 0, left = n, looked = 0;
  while (left > 2) {
    // What lies on one line with its neighbours is no corner, and goes once it stands in the way of the last ears.
    const bool flat = looked >= left && turn_at(at) == 0;
    if (!flat && !is_ear(at)) {
      if (++looked > 2 * left) return false;
      at = after[at];
      continue;
    }
    if (!flat) out.push_back({loop[before[at]], loop[at], loop[after[at]]});
    after[before[at]] = after[at];
    before[after[at]] = before[at];
    // On from the one behind the next: ears all round make better triangles than a fan.
    at = after[after[at]];
    --left;
    looked = 0;
  }
  return true;
}

/// Makes sides between triangles shorter while that can be done by turning one in its quadrangle.
void shorten_sides(const Corners& c, std::vector<Triangle>& triangles) {
  std::map<std::pair<Index, Index>, std::size_t> of;
  const auto enter = [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) of[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) enter(t);
  std::vector<std::pair<Index, Index>> sides;
  for (const auto& [side, t] : of)
    if (side.first < side.second) sides.push_back(side);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto [u, v] = sides[i];
    const auto left = of.find({u, v}), right = of.find({v, u});
    if (left == of.end() || right == of.end()) continue;
    const std::size_t a = left->second, b = right->second;
    const auto third = [&](std::size_t t) {
      for (const Index w : triangles[t])
        if (w != u && w != v) return w;
      return u;
    };
    const Index w = third(a), x = third(b);
    if (c.distance_squared(w, x) >= c.distance_squared(u, v) || c.turn(x, v, w) <= 0 || c.turn(w, u, x) <= 0) continue;
    of.erase(left), of.erase(of.find({v, u}));
    triangles[a] = {x, v, w}, triangles[b] = {w, u, x};
    enter(a), enter(b);
    for (const auto& [p, q] : {std::pair{u, x}, {x, v}, {v, w}, {w, u}})
      sides.push_back({std::min(p, q), std::max(p, q)});
  }
}

/// In which order sides are taken away: none is best for all polygons, so all are tried.
enum class Order : std::uint8_t { longest, shortest, by_corner };

/// Puts triangles together over their sides while the sum is convex.
std::vector<Loop> join(const Corners& c, const std::vector<Triangle>& triangles, Order order) {
  struct Side {
    Index a, b;
    std::int64_t length;
  };
  std::map<std::pair<Index, Index>, std::size_t> of;
  std::vector<Loop> parts;
  std::vector<std::size_t> part_of(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    parts.emplace_back(triangles[t].begin(), triangles[t].end());
    part_of[t] = t;
    for (std::size_t k = 0; k < 3; ++k) of[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  }
  const auto find = [&](std::size_t t) {
    while (part_of[t] != t) t = part_of[t] = part_of[part_of[t]];
    return t;
  };
  std::vector<Side> sides;
  for (const auto& [side, t] : of)
    if (side.first < side.second && of.contains({side.second, side.first}))
      sides.push_back({side.first, side.second, c.distance_squared(side.first, side.second)});
  if (order == Order::longest)
    std::stable_sort(sides.begin(), sides.end(), [](const Side& l, const Side& r) { return l.length > r.length; });
  if (order == Order::shortest)
    std::stable_sort(sides.begin(), sides.end(), [](const Side& l, const Side& r) { return l.length < r.length; });
  for (const Side& side : sides) {
    const std::size_t p = find(of[{side.a, side.b}]), q = find(of[{side.b, side.a}]);
    if (p == q) continue;
    // Both begin behind the common side: from b round to a, and from a round to b.
    Loop l = parts[p], r = parts[q];
    std::rotate(l.begin(), std::find(l.begin(), l.end(), side.b), l.end());
    std::rotate(r.begin(), std::find(r.begin(), r.end(), side.a), r.end());
    l.insert(l.end(), r.begin() + 1, r.end() - 1);
    const std::size_t n = l.size();
    bool convex = true;
    int corners = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t turn = c.turn(l[(i + n - 1) % n], l[i], l[(i + 1) % n]);
      convex = convex && turn >= 0;
      corners += turn > 0 ? 1 : 0;
    }
    if (!convex || corners > max_polygon_vertices) continue;
    parts[p] = std::move(l);
    parts[q].clear();
    part_of[q] = p;
  }
  std::erase_if(parts, [](const Loop& part) { return part.empty(); });
  for (Loop& part : parts) std::rotate(part.begin(), std::min_element(part.begin(), part.end()), part.end());
  std::sort(parts.begin(), parts.end());
  return parts;
}

/// A loop that needs no cut: convex, and of no more corners than a polygon has.
bool is_part(const Corners& c, const Loop& loop) {
  int corners = 0;
  for (std::size_t i = 0, n = loop.size(); i < n; ++i) {
    const std::int64_t turn = c.turn(loop[(i + n - 1) % n], loop[i], loop[(i + 1) % n]);
    if (turn < 0) return false;
    corners += turn > 0 ? 1 : 0;
  }
  return corners <= max_polygon_vertices;
}

/// False where no triangles were found that have the area. The outline, then its holes from right to left.
bool cut_into_parts(const Corners& c, const std::vector<Loop>& loops, std::int64_t area, std::vector<Loop>& parts) {
  Loop whole = loops[0];
  std::vector<Triangle> triangles;
  for (std::size_t k = 1; k < loops.size(); ++k)
    if (!bridge(c, whole, loops[k], std::span<const Loop>(loops).subspan(k + 1))) return false;
  if (!cut_ears(c, whole, triangles)) return false;
  std::int64_t cut = 0;
  for (const Triangle& t : triangles) cut += c.turn(t[0], t[1], t[2]);
  if (cut != area) return false;
  for (const bool shortened : {true, false}) {
    std::vector<Triangle> these = triangles;
    if (shortened) shorten_sides(c, these);
    for (const Order order : {Order::longest, Order::shortest, Order::by_corner}) {
      std::vector<Loop> joined = join(c, these, order);
      if (parts.empty() || joined.size() < parts.size()) parts = std::move(joined);
    }
  }
  return true;
}

/// The least power of two of which 2²⁸ make up the extent.
double grid_unit(double extent) {
  double unit = 1;
  while (extent > unit * double(1 << 28)) unit *= 2;
  while (extent <= unit * double(1 << 27)) unit /= 2;
  return unit;
}

}  // namespace decomposition2
}  // namespace

core::Result<std::vector<Polygon>> decompose_convex(std::span<const Vec2f> outline,
                                                    std::span<const std::vector<Vec2f>> holes) {
  using namespace decomposition2;
  Corners c;
  std::vector<Loop> loops(1 + holes.size());
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const std::span<const Vec2f> points = k == 0 ? outline : std::span<const Vec2f>(holes[k - 1]);
    if (points.size() < 3 || points.size() > 100000)
      return detail::error("decompose_convex: an outline or hole has %zu corners, expected 3 to 100000", points.size());
    for (const Vec2f p : points) {
      if (auto s = detail::check_point("decompose_convex: a corner", p, 1e6); !s) return s.error();
      loops[k].push_back(Index(c.place.size()));
      c.place.push_back(p);
    }
  }
  Vec2d low(c.place[0]), high = low;
  for (const Vec2f p : c.place) low = min(low, Vec2d(p)), high = max(high, Vec2d(p));
  const double extent = max(high.x - low.x, high.y - low.y);
  if (!(extent > 1e-6))
    return detail::error("decompose_convex: the outline is %g m across, expected more than 1e-6 m", extent);
  const double unit = grid_unit(extent);
  for (const Vec2f p : c.place) {
    const Vec2d g = (Vec2d(p) - low) / unit;
    c.grid.push_back({std::int64_t(g.x + 0.5), std::int64_t(g.y + 0.5)});
  }
  if (auto s = check_loops(c, loops); !s) return s.error();

  // The inside to the left of every side.
  std::int64_t area = 0;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if ((c.twice_area(loops[k]) > 0) != (k == 0)) std::reverse(loops[k].begin(), loops[k].end());
    area += c.twice_area(loops[k]);
  }
  std::sort(loops.begin() + 1, loops.end(), [&](const Loop& l, const Loop& r) {
    const auto rightmost = [&](const Loop& loop) {
      return c.at(*std::max_element(loop.begin(), loop.end(), [&](Index a, Index b) { return c.at(a) < c.at(b); }));
    };
    return rightmost(r) < rightmost(l);
  });
  std::vector<Loop> parts;
  if (holes.empty() && is_part(c, loops[0]))
    parts.push_back(loops[0]);
  else if (!cut_into_parts(c, loops, area, parts))
    return detail::error("decompose_convex: the outlines could not be cut into triangles");

  std::vector<Polygon> result;
  for (const Loop& part : parts) {
    std::vector<Vec2f> points;
    for (std::size_t i = 0, n = part.size(); i < n; ++i)
      if (c.turn(part[(i + n - 1) % n], part[i], part[(i + 1) % n]) > 0)
        points.push_back(c.place[std::size_t(part[i])]);
    auto polygon = make_polygon(points);
    if (!polygon && double(c.twice_area(part)) < 1e-6 * double(area)) continue;
    if (!polygon)
      return detail::error(
          "decompose_convex: between the corners at (%g, %g) and (%g, %g) a part is too thin to be a polygon, expected "
          "corners further from the sides of others",
          double(points[0].x), double(points[0].y), double(points[1].x), double(points[1].y));
    result.push_back(*polygon);
  }
  if (result.empty())
    return detail::error("decompose_convex: the polygon is too thin, expected one that has an inside");
  return result;
}

}  // namespace carom::geometry
