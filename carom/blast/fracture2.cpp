#include "carom/blast/fracture2.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::blast {

using math::Vec2d;
using math::Vec2f;

namespace {

struct Corner2 {
  Vec2d p;
  std::int32_t source;  // of the side that begins here
};
using Outline2 = std::vector<Corner2>;

double area_of(const Outline2& o) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < o.size(); ++i) twice += cross(o[i].p - o[0].p, o[i + 1].p - o[0].p);
  return 0.5 * twice;
}

/// Corners are within or beyond, never on the line. Crossings are joined in pairs along it, the k-th way out with the
/// k-th way in, so that loops stay closed whatever the rounding.
void cut(std::vector<Outline2>& outlines, const HalfPlane& h) {
  struct Crossing {
    std::size_t corner;
    double along;
  };
  const Vec2d along{-h.normal.y, h.normal.x};
  std::vector<Corner2> corners;
  std::vector<std::size_t> next;
  std::vector<Crossing> exits, entries;
  for (const Outline2& outline : outlines) {
    const std::size_t n = outline.size(), base = corners.size();
    for (const Corner2& c : outline) corners.push_back(c);
    next.resize(corners.size(), 0);
    for (std::size_t i = 0; i < n; ++i) next[base + i] = base + (i + 1) % n;
  }
  const std::size_t count = corners.size();
  std::vector<double> distance(count);
  for (std::size_t i = 0; i < count; ++i) distance[i] = dot(h.normal, corners[i].p) - h.offset;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = next[i];
    const double a = distance[i], b = distance[j];
    if ((a > 0) == (b > 0)) continue;
    // From the corner within, so that both sides of a cut agree.
    const Vec2d in = a > 0 ? corners[j].p : corners[i].p, out = a > 0 ? corners[i].p : corners[j].p;
    const double t = a > 0 ? b / (b - a) : a / (a - b);
    const Vec2d p = in + t * (out - in);
    const std::size_t made = corners.size();
    corners.push_back({p, a > 0 ? corners[i].source : -1 - h.tag});
    next.push_back(j);
    (a > 0 ? entries : exits).push_back({made, dot(along, p)});
    if (a <= 0) next[i] = made;
  }
  const auto order = [](const Crossing& a, const Crossing& b) {
    return a.along != b.along ? a.along < b.along : a.corner < b.corner;
  };
  std::sort(exits.begin(), exits.end(), order);
  std::sort(entries.begin(), entries.end(), order);
  for (std::size_t k = 0; k < exits.size(); ++k) next[exits[k].corner] = entries[k].corner;
  std::vector<char> used(corners.size(), 0);
  outlines.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (used[i] || (i < count && distance[i] > 0)) continue;
    Outline2 loop;
    for (std::size_t at = i; !used[at]; at = next[at]) {
      used[at] = 1;
      loop.push_back(corners[at]);
    }
    if (loop.size() >= 3) outlines.push_back(std::move(loop));
  }
}

bool in_triangle(Vec2d p, Vec2d a, Vec2d b, Vec2d c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

bool convex(const std::vector<Vec2d>& p) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (cross(p[(i + 1) % p.size()] - p[i], p[(i + 2) % p.size()] - p[(i + 1) % p.size()]) < -1e-12) return false;
  return true;
}

/// Ears, put together again while the sum stays convex (Hertel & Mehlhorn, "Fast triangulation of simple polygons",
/// 1983).
std::vector<std::vector<Vec2d>> convex_parts(const std::vector<Vec2d>& outline) {
  if (outline.size() <= std::size_t(geometry::max_polygon_vertices) && convex(outline)) return {outline};
  std::vector<std::vector<std::size_t>> parts;
  std::vector<std::size_t> left(outline.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t ear = n, best = 0;
    double largest = -1e300;
    for (std::size_t i = 0; i < n && ear == n; ++i) {
      const Vec2d a = outline[left[(i + n - 1) % n]], b = outline[left[i]], c = outline[left[(i + 1) % n]];
      const double turn = cross(b - a, c - b);
      if (turn > largest) largest = turn, best = i;
      if (!(turn > 0)) continue;
      bool empty = true;
      for (const std::size_t v : left) {
        const Vec2d p = outline[v];
        if (p == a || p == b || p == c) continue;
        empty = empty && !in_triangle(p, a, b, c);
      }
      if (empty) ear = i;
    }
    if (ear == n) ear = best;
    parts.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + std::ptrdiff_t(ear));
  }
  parts.push_back(left);
  const auto points = [&](const std::vector<std::size_t>& part) {
    std::vector<Vec2d> p;
    for (const std::size_t i : part) p.push_back(outline[i]);
    return p;
  };
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < parts.size() && !again; ++i)
      for (std::size_t j = i + 1; j < parts.size() && !again; ++j)
        for (std::size_t k = 0; k < parts[i].size() && !again; ++k)
          for (std::size_t l = 0; l < parts[j].size() && !again; ++l) {
            const std::size_t n = parts[i].size(), m = parts[j].size();
            if (parts[i][k] != parts[j][(l + 1) % m] || parts[i][(k + 1) % n] != parts[j][l]) continue;
            if (n + m - 2 > std::size_t(geometry::max_polygon_vertices)) continue;
            std::vector<std::size_t> sum;
            for (std::size_t s = 0; s < n; ++s) sum.push_back(parts[i][(k + 1 + s) % n]);
            for (std::size_t s = 0; s + 2 < m; ++s) sum.push_back(parts[j][(l + 2 + s) % m]);
            if (!convex(points(sum))) continue;
            parts[i] = sum;
            parts.erase(parts.begin() + std::ptrdiff_t(j));
            again = true;
          }
  }
  std::vector<std::vector<Vec2d>> result;
  for (const auto& part : parts) result.push_back(points(part));
  return result;
}

geometry::MassProperties2 mass_of(const std::vector<Vec2d>& outline) {
  geometry::MassProperties2 m;
  const Vec2d o = outline[0];
  Vec2d first{};
  double second = 0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    const Vec2d a = outline[i] - o, b = outline[i + 1] - o;
    const double part = 0.5 * cross(a, b);
    m.mass += part;
    first += (part / 3) * (a + b);
    second += part / 6 * (dot(a, a) + dot(a, b) + dot(b, b));
  }
  if (!(m.mass > 0)) return {};
  const Vec2d c = first / m.mass;
  m.center = o + c;
  m.inertia = second - m.mass * length_squared(c);
  return m;
}

void add_polygons(Piece2& piece, double skin) {
  for (const std::vector<Vec2d>& part : convex_parts(piece.outline)) {
    const geometry::MassProperties2 mass = mass_of(part);
    if (!(mass.mass > 0)) continue;
    double inner = 1e300;
    const auto normal = [&](std::size_t i) {
      const Vec2d side = part[(i + 1) % part.size()] - part[i];
      return normalize(Vec2d{side.y, -side.x});
    };
    for (std::size_t i = 0; i < part.size(); ++i) inner = math::min(inner, dot(normal(i), part[i] - mass.center));
    if (!(inner > 1e-5)) continue;
    std::vector<Outline2> shrunk(1);
    for (const Vec2d& p : part) shrunk[0].push_back({p, 0});
    const double back = math::min(skin, 0.1 * inner);
    for (std::size_t i = 0; i < part.size() && !shrunk.empty(); ++i)
      cut(shrunk, {normal(i), dot(normal(i), part[i]) - back, 0});
    if (shrunk.empty()) continue;
    std::vector<Vec2f> points;
    for (const Corner2& c : shrunk[0]) points.push_back(Vec2f(c.p - piece.mass.center));
    const auto polygon = geometry::make_polygon(points);
    if (polygon.ok()) piece.polygons.push_back(*polygon);
  }
}

bool sides_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

}  // namespace

core::Result<Pattern2> voronoi_pattern2(std::span<const Vec2d> sites) {
  if (sites.empty() || sites.size() > 10000)
    return core::Error{core::text("voronoi_pattern2: ", sites.size(), " sites, expected 1 to 10000")};
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (!is_finite(sites[i])) return core::Error{core::text("voronoi_pattern2: site ", i, " is not finite")};
  Vec2d low = sites[0], high = sites[0];
  for (const Vec2d& s : sites) low = min(low, s), high = max(high, s);
  const double far = 1e3 * (1 + length(high - low));  // cells at the border are open: as good as
  Pattern2 pattern;
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t i = 0; i < sites.size(); ++i) {
    near.clear();
    for (std::uint32_t j = 0; j < sites.size(); ++j)
      if (j != i) near.push_back({distance_squared(sites[i], sites[j]), j});
    std::sort(near.begin(), near.end());
    std::vector<Outline2> cell{{{sites[i] + Vec2d{-far, -far}, 0},
                                {sites[i] + Vec2d{far, -far}, 0},
                                {sites[i] + Vec2d{far, far}, 0},
                                {sites[i] + Vec2d{-far, far}, 0}}};
    std::vector<HalfPlane> planes;
    double reach = 2 * far * far;
    for (const auto& [d, j] : near) {
      if (!(d > 0)) return core::Error{core::text("voronoi_pattern2: sites ", i, " and ", j, " are in one place")};
      if (d > 4 * reach) break;
      const Vec2d n = (sites[j] - sites[i]) / math::sqrt(d);
      const HalfPlane plane{n, dot(n, 0.5 * (sites[i] + sites[j])), int(j)};
      cut(cell, plane);
      if (cell.empty()) break;
      planes.push_back(plane);
      reach = 0;
      for (const Corner2& c : cell[0]) reach = math::max(reach, distance_squared(c.p, sites[i]));
    }
    std::erase_if(planes, [&](const HalfPlane& plane) {
      for (const Outline2& o : cell)
        for (const Corner2& c : o)
          if (c.source == -1 - plane.tag) return false;
      return true;
    });
    pattern.cells.push_back(std::move(planes));
  }
  return pattern;
}

std::vector<Vec2d> uniform_sites2(const geometry::Bounds2d& box, int count, std::uint64_t seed) {
  math::Random random(seed);
  std::vector<Vec2d> sites;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(box.low.x, box.high.x);
    sites.push_back({x, random.uniform(box.low.y, box.high.y)});
  }
  return sites;
}

core::Result<std::vector<Vec2d>> radial_sites2(const RadialSites2& r, std::uint64_t seed) {
  if (!(r.first_radius > 0) || !math::is_finite(r.first_radius))
    return core::Error{core::refused("first_radius", r.first_radius, "a finite number of metres > 0")};
  if (!(r.growth > 1) || !math::is_finite(r.growth))
    return core::Error{core::refused("growth", r.growth, "a number > 1")};
  if (r.sectors < 3 || r.sectors > 1000) return core::Error{core::refused("sectors", r.sectors, "3 to 1000")};
  if (!(r.jitter >= 0 && r.jitter <= 1)) return core::Error{core::refused("jitter", r.jitter, "0 to 1")};
  if (!(r.limit > 0) || !math::is_finite(r.limit)) return core::Error{core::refused("limit", r.limit, "metres > 0")};
  if (!is_finite(r.impact)) return core::Error{"impact is not finite"};
  math::Random random(seed);
  std::vector<Vec2d> sites{r.impact};
  double inner = r.first_radius;
  for (int ring = 0; inner < r.limit && ring < 64; ++ring) {
    const double outer = inner * r.growth, turn = random.uniform(0.0, 2 * math::pi);
    for (int k = 0; k < r.sectors; ++k) {
      const double angle = turn + 2 * math::pi * (k + 0.5 * r.jitter * random.uniform(-1.0, 1.0)) / double(r.sectors);
      const double radius = 0.5 * (inner + outer) + 0.5 * r.jitter * (outer - inner) * random.uniform(-1.0, 1.0);
      sites.push_back(r.impact + radius * Vec2d{math::cos(angle), math::sin(angle)});
    }
    inner = outer;
  }
  return sites;
}

core::Result<Fracture2> fracture_polygon(std::span<const Vec2d> outline, const Pattern2& pattern, double skin) {
  if (outline.size() < 3 || outline.size() > 4096)
    return core::Error{core::text("fracture_polygon: ", outline.size(), " corners, expected 3 to 4096")};
  if (!(skin >= 0 && skin <= 0.1)) return core::Error{core::refused("skin", skin, "0 to 0.1 m")};
  Outline2 whole;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!is_finite(outline[i])) return core::Error{core::text("fracture_polygon: corner ", i, " is not finite")};
    whole.push_back({outline[i], std::int32_t(i)});
  }
  if (!(area_of(whole) > 0))
    return core::Error{
        core::refused("fracture_polygon: area", area_of(whole), "more than 0 (counterclockwise corners)")};
  for (std::size_t i = 0; i < outline.size(); ++i)
    for (std::size_t j = i + 2; j < outline.size(); ++j)
      if (sides_cross(outline[i], outline[(i + 1) % outline.size()], outline[j], outline[(j + 1) % outline.size()]))
        return core::Error{core::text("fracture_polygon: sides ", i, " and ", j, " cross, expected a simple polygon")};
  Fracture2 fracture;
  std::vector<std::uint32_t> first(pattern.cells.size() + 1, 0);
  for (std::uint32_t c = 0; c < pattern.cells.size(); ++c) {
    std::vector<Outline2> outlines{whole};
    for (const HalfPlane& h : pattern.cells[c]) cut(outlines, h);
    for (const Outline2& o : outlines) {
      Piece2 piece;
      piece.cell = c;
      for (const Corner2& corner : o) piece.outline.push_back(corner.p), piece.sources.push_back(corner.source);
      piece.mass = mass_of(piece.outline);
      if (!(piece.mass.mass > 0)) continue;
      add_polygons(piece, skin);
      fracture.pieces.push_back(std::move(piece));
    }
    first[c + 1] = std::uint32_t(fracture.pieces.size());
  }
  // Sides on the same cut that lie over each other.
  for (std::uint32_t c = 0; c < pattern.cells.size(); ++c)
    for (const HalfPlane& h : pattern.cells[c]) {
      if (h.tag <= int(c) || std::size_t(h.tag) >= pattern.cells.size()) continue;
      const Vec2d t{-h.normal.y, h.normal.x};
      for (std::uint32_t a = first[c]; a < first[c + 1]; ++a)
        for (std::uint32_t b = first[std::size_t(h.tag)]; b < first[std::size_t(h.tag) + 1]; ++b) {
          Bond2 bond{a, b, 0, {}, h.normal};
          const Piece2 &pa = fracture.pieces[a], &pb = fracture.pieces[b];
          for (std::size_t i = 0; i < pa.outline.size(); ++i)
            for (std::size_t j = 0; j < pb.outline.size() && pa.sources[i] == -1 - h.tag; ++j) {
              if (pb.sources[j] != -1 - std::int32_t(c)) continue;
              const Vec2d a0 = pa.outline[i], a1 = pa.outline[(i + 1) % pa.outline.size()];
              const Vec2d b0 = pb.outline[j], b1 = pb.outline[(j + 1) % pb.outline.size()];
              const double low = math::max(dot(t, a0), dot(t, b1)), high = math::min(dot(t, a1), dot(t, b0));
              if (!(high > low)) continue;
              bond.length += high - low;
              bond.center += (high - low) * (h.offset * h.normal + (0.5 * (low + high)) * t);
            }
          if (!(bond.length > 1e-9)) continue;
          bond.center = bond.center / bond.length;
          fracture.bonds.push_back(bond);
        }
    }
  return fracture;
}

}  // namespace carom::blast
