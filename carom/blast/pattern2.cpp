// Where a polygon breaks.
#include <algorithm>

#include "carom/blast/detail/lattice.h"
#include "carom/blast/detail/outline_cut.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::blast {

using detail::Outline2;
using math::Vec2d;

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
  std::vector<Outline2> cell;
  detail::CutScratch2 scratch;
  for (std::uint32_t i = 0; i < sites.size(); ++i) {
    near.clear();
    for (std::uint32_t j = 0; j < sites.size(); ++j)
      if (j != i) near.push_back({distance_squared(sites[i], sites[j]), j});
    // The nearest first: what they leave of a cell leaves few of the others to be sorted.
    const std::size_t nearest = math::min(near.size(), std::size_t(16));
    std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(nearest), near.end());
    cell = {{{sites[i] + Vec2d{-far, -far}, 0},
             {sites[i] + Vec2d{far, -far}, 0},
             {sites[i] + Vec2d{far, far}, 0},
             {sites[i] + Vec2d{-far, far}, 0}}};
    std::vector<HalfPlane> planes;
    double reach = 2 * far * far;
    for (std::size_t k = 0; k < near.size(); ++k) {
      if (k == nearest) {
        const auto rest = near.begin() + std::ptrdiff_t(nearest);
        near.erase(std::remove_if(rest, near.end(), [&](const auto& n) { return n.first > 4 * reach; }), near.end());
        std::sort(near.begin() + std::ptrdiff_t(nearest), near.end());
        if (k == near.size()) break;
      }
      const auto [d, j] = near[k];
      if (!(d > 0)) return core::Error{core::text("voronoi_pattern2: sites ", i, " and ", j, " are in one place")};
      if (d > 4 * reach) break;
      const Vec2d n = (sites[j] - sites[i]) / math::sqrt(d);
      const HalfPlane plane{n, dot(n, 0.5 * (sites[i] + sites[j])), int(j)};
      detail::cut(cell, plane, scratch);
      if (cell.empty()) break;
      planes.push_back(plane);
      reach = 0;
      for (const detail::Corner2& c : cell[0]) reach = math::max(reach, distance_squared(c.p, sites[i]));
    }
    std::erase_if(planes, [&](const HalfPlane& plane) {
      for (const Outline2& o : cell)
        for (const detail::Corner2& c : o)
          if (c.source == -1 - plane.tag) return false;
      return true;
    });
    for (const HalfPlane& plane : planes)
      if (plane.tag > int(i)) pattern.meetings.push_back({i, std::uint32_t(plane.tag), plane.tag, int(i)});
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

namespace {
core::Status check(std::span<const Vec2d> outline) {
  if (outline.empty()) return core::Error{"fracture: the outline has no corners"};
  for (std::size_t i = 0; i < outline.size(); ++i)
    if (!is_finite(outline[i])) return core::Error{core::text("fracture: corner ", i, " of the outline is not finite")};
  return {};
}
}  // namespace

core::Result<Pattern2> slab_pattern2(std::span<const Vec2d> outline, Vec2d normal, int count, double jitter,
                                     std::uint64_t seed) {
  if (auto s = check(outline); !s) return s.error();
  if (auto s = detail::check_slabs(normal, count, 10000, jitter); !s) return s.error();
  normal = normalize(normal);
  double low = dot(normal, outline[0]), high = low;
  for (const Vec2d& p : outline) low = math::min(low, dot(normal, p)), high = math::max(high, dot(normal, p));
  const std::vector<double> borders = detail::slab_borders(low, high, count, jitter, seed);
  Pattern2 pattern;
  pattern.cells.resize(std::size_t(count));
  for (int k = 1; k < count; ++k) {
    const double border = borders[std::size_t(k - 1)];
    pattern.cells[std::size_t(k - 1)].push_back({normal, border, k});
    pattern.cells[std::size_t(k)].push_back({-normal, -border, k - 1});
    pattern.meetings.push_back({std::uint32_t(k - 1), std::uint32_t(k), k, k - 1});
  }
  return pattern;
}

core::Result<Pattern2> brick_pattern2(std::span<const Vec2d> outline, Vec2d size, Vec2d corner) {
  if (auto s = check(outline); !s) return s.error();
  if (!(size.x > 0 && size.y > 0) || !is_finite(size))
    return core::Error{core::text("size is (", size.x, ", ", size.y, "), expected metres > 0")};
  if (!is_finite(corner)) return core::Error{"corner is not finite"};
  geometry::Bounds2d box{outline[0], outline[0]};
  for (const Vec2d& p : outline) box = {min(box.low, p), max(box.high, p)};
  const detail::BrickRow courses(box.low.y, box.high.y, corner.y, size.y, 0);
  const detail::BrickRow rows[] = {{box.low.x, box.high.x, corner.x, size.x, 0},
                                   {box.low.x, box.high.x, corner.x, size.x, 0.5}};
  const auto count = [](const detail::BrickRow& row) { return row.last - row.first + 1; };
  if (!courses.countable || !rows[0].countable || !rows[1].countable ||
      count(courses) * math::max(count(rows[0]), count(rows[1])) > 10000)
    return core::Error{"brick_pattern2: more than 10000 bricks"};
  // The outline closes the outermost.
  constexpr int left = 0, right = 1, below = 2, above = 3;
  Pattern2 pattern;
  for (std::int64_t y = courses.first; y <= courses.last; ++y) {
    const bool odd = (y & 1) != 0;
    const detail::BrickRow &row = rows[odd], &next = rows[!odd];
    const std::int64_t first_above = std::int64_t(pattern.cells.size()) + count(row);
    for (std::int64_t x = row.first; x <= row.last; ++x) {
      const auto across = [&](std::int64_t i) {
        return corner.x + (double(i) + (odd ? 0.5 : 0.0) + detail::off_lattice) * size.x;
      };
      const auto up = [&](std::int64_t i) { return corner.y + (double(i) + detail::off_lattice) * size.y; };
      const std::uint32_t here = std::uint32_t(pattern.cells.size());
      std::vector<HalfPlane>& cell = pattern.cells.emplace_back();
      if (x > row.first) cell.push_back({{-1, 0}, -across(x), left});
      if (x < row.last) {
        cell.push_back({{1, 0}, across(x + 1), right});
        pattern.meetings.push_back({here, here + 1, right, left});
      }
      if (y > courses.first) cell.push_back({{0, -1}, -up(y), below});
      if (y == courses.last) continue;
      cell.push_back({{0, 1}, up(y + 1), above});
      // The course above is shifted: two bricks of it lie on each.
      for (const std::int64_t other : {odd ? x : x - 1, odd ? x + 1 : x})
        if (other >= next.first && other <= next.last)
          pattern.meetings.push_back({here, std::uint32_t(first_above + other - next.first), above, below});
    }
  }
  return pattern;
}

}  // namespace carom::blast
