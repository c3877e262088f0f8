#include "carom/blast/pattern.h"

#include <limits>
#include <utility>

#include "carom/blast/detail/cell_cutter.h"
#include "carom/blast/detail/lattice.h"
#include "carom/blast/detail/site_grid.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::blast {

using math::Vec3d;

namespace {

geometry::Bounds3d bounds_of(const ConvexCell& cell) {
  if (cell.empty()) return {};
  geometry::Bounds3d b{cell.vertices()[0], cell.vertices()[0]};
  for (const Vec3d& v : cell.vertices()) b = {min(b.low, v), max(b.high, v)};
  return b;
}

bool inside(const ConvexCell& cell, Vec3d p) {
  for (const ConvexCell::Face& face : cell.faces())
    if (dot(face.normal, p) > face.offset) return false;
  return true;
}

/// Uniform in the container; after many misses (a sliver in its box) the box's own.
Vec3d draw_inside(const ConvexCell& cell, const geometry::Bounds3d& box, math::Random& random) {
  Vec3d p{};
  for (int tries = 0; tries < 1000; ++tries) {
    p = {random.uniform(box.low.x, box.high.x), random.uniform(box.low.y, box.high.y),
         random.uniform(box.low.z, box.high.z)};
    if (inside(cell, p)) break;
  }
  return p;
}

/// How far a cell goes from its site: a sphere and a box.
struct Reach {
  double squared = 0;
  Vec3d low{}, high{};
  void add(Vec3d d) {
    squared = math::max(squared, length_squared(d));
    low = min(low, d), high = max(high, d);
  }
  static Reach of(const ConvexCell& cell, Vec3d site) {
    Reach reach;
    for (const Vec3d& v : cell.vertices()) reach.add(v - site);
    return reach;
  }
  static Reach of(const detail::CellCutter& cell) {
    Reach reach;
    cell.reach(reach.squared, reach.low, reach.high);
    return reach;
  }
  /// No less than the greatest of `way`·(v − site) over the corners v.
  double along(Vec3d way) const {
    return math::max(way.x * low.x, way.x * high.x) + math::max(way.y * low.y, way.y * high.y) +
           math::max(way.z * low.z, way.z * high.z);
  }
};

/// A container that is cut to the cell of a site, in the fast way as soon as what is left of it fits there.
class Cutting {
 public:
  explicit Cutting(const ConvexCell& container)
      : container_(&container), whole_fits_(whole_.load(container, {})), may_be_fast_(whole_fits_) {}

  Reach start(Vec3d site, bool may_be_fast) {
    site_ = site, may_be_fast_ = may_be_fast, fast_ = may_be_fast && whole_fits_;
    if (fast_)
      cutter_.start(whole_, site);
    else
      cell_ = *container_;
    return fast_ ? Reach::of(cutter_) : Reach::of(cell_, site);
  }
  ConvexCell::Cut clip(Vec3d normal, double offset, int tag) {
    if (fast_) return cutter_.clip(normal, offset, tag);
    const ConvexCell::Cut cut = cell_.clip({normal, offset, tag}, scratch_);
    if (cut == ConvexCell::Cut::part && may_be_fast_) fast_ = cutter_.load(cell_, site_);
    return cut;
  }
  Reach reach() const { return fast_ ? Reach::of(cutter_) : Reach::of(cell_, site_); }
  bool failed() const { return fast_ && !cutter_.fits(); }
  /// False where it must be cut again in the general way.
  bool store(ConvexCell& cell) {
    if (fast_) return cell.take(cutter_);
    std::swap(cell, cell_);
    return true;
  }

 private:
  const ConvexCell* container_;
  detail::CellCutter whole_, cutter_;
  ConvexCell cell_;
  ConvexCell::Scratch scratch_;
  Vec3d site_{};
  bool whole_fits_, may_be_fast_, fast_ = false;
};

/// Cuts the cell of a site by the planes halfway to its neighbours, nearest first, as long as they can reach it.
ConvexCell::Cut cut_cell(const detail::SiteGrid& grid, std::span<const Vec3d> sites, std::uint32_t i, Reach reach,
                         std::vector<detail::SiteGrid::Near>& near, std::uint32_t& twin, Cutting& cell) {
  const Vec3d site = sites[i];
  // How far the cell goes is looked up again where a plane missed it: the nearest seldom do.
  bool stale = false;
  const auto look = [&] {
    if (stale) reach = cell.reach();
    stale = false;
  };
  for (int ring = 1; ring <= grid.rings(); ++ring) {
    look();
    if (ring > 1 && math::square((ring - 1) * grid.edge()) > 4 * reach.squared) break;
    std::span<detail::SiteGrid::Near> left = grid.ring(i, ring, 4 * reach.squared, near);
    // The nearest first: what they leave of the cell leaves few of the others to be sorted.
    for (const double within : {1.5 * math::square(grid.edge()), std::numeric_limits<double>::infinity()}) {
      look();
      detail::SiteGrid::Near* first = left.data();
      for (detail::SiteGrid::Near& n : left)
        if (n.distance_squared <= within && n.distance_squared <= 4 * reach.squared &&
            !(reach.along(grid.place(n) - site) <= 0.5 * n.distance_squared && n.distance_squared > 0))
          std::swap(*first++, n);
      grid.sort(left.data(), first);
      for (const detail::SiteGrid::Near& n : std::span(left.data(), first)) {
        if (n.distance_squared > 4 * reach.squared) break;
        if (!(n.distance_squared > 0)) {
          twin = grid.site(n);
          return ConvexCell::Cut::all;
        }
        const Vec3d place = grid.place(n), way = place - site;
        if (!stale && reach.along(way) <= 0.5 * n.distance_squared) continue;
        const Vec3d middle = 0.5 * (site + place), normal = way / math::sqrt(n.distance_squared);
        const ConvexCell::Cut cut = cell.clip(normal, dot(normal, middle), int(grid.site(n)));
        if (cut == ConvexCell::Cut::all || cell.failed()) return cut;
        if (cut == ConvexCell::Cut::part)
          stale = true;
        else
          look();
      }
      left = left.subspan(std::size_t(first - left.data()));
    }
  }
  return ConvexCell::Cut::part;
}

/// m, along each axis: volumes and squares of distances stay finite.
bool within_reach(Vec3d p) {
  constexpr double most = 1e30;
  return math::abs(p.x) <= most && math::abs(p.y) <= most && math::abs(p.z) <= most;
}
core::Status check(const ConvexCell& container) {
  if (container.empty()) return core::Error{"fracture: the container is empty, expected a convex solid"};
  const geometry::Bounds3d box = bounds_of(container);
  if (!within_reach(box.low) || !within_reach(box.high))
    return core::Error{"fracture: the container has a corner more than 1e30 m away"};
  return {};
}

}  // namespace

std::vector<Vec3d> uniform_sites(const ConvexCell& container, int count, std::uint64_t seed) {
  math::Random random(seed);
  const geometry::Bounds3d box = bounds_of(container);
  std::vector<Vec3d> sites;
  if (container.empty()) return sites;
  for (int i = 0; i < count; ++i) sites.push_back(draw_inside(container, box, random));
  return sites;
}

std::vector<Vec3d> even_sites(const ConvexCell& container, int count, int rounds, std::uint64_t seed) {
  std::vector<Vec3d> sites = uniform_sites(container, count, seed);
  for (int round = 0; round < rounds; ++round) {
    const auto pattern = voronoi_pattern(container, sites);
    if (!pattern.ok()) break;
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (!pattern->cells[i].empty()) sites[i] = pattern->cells[i].mass_properties(1).center;
  }
  return sites;
}

std::vector<Vec3d> clustered_sites(const ConvexCell& container, Vec3d impact, double radius, int count,
                                   std::uint64_t seed) {
  math::Random random(seed);
  const geometry::Bounds3d box = bounds_of(container);
  std::vector<Vec3d> sites;
  if (container.empty()) return sites;
  for (int i = 0; i < count; ++i) {
    Vec3d p{};
    bool found = false;
    for (int tries = 0; tries < 60 && i % 2 == 0 && !found; ++tries) {
      const double reach = radius * random.exponential();  // drawn first: an expression has no order of its own
      p = impact + reach * random.on_sphere();
      found = inside(container, p);
    }
    sites.push_back(found ? p : draw_inside(container, box, random));
  }
  return sites;
}

core::Result<std::vector<Vec3d>> radial_sites(const ConvexCell& container, const RadialSites& r, std::uint64_t seed) {
  if (auto s = check(container); !s) return s.error();
  if (!(r.first_radius > 0) || !math::is_finite(r.first_radius))
    return core::Error{core::refused("first_radius", r.first_radius, "a finite number of metres > 0")};
  if (!(r.growth > 1) || !math::is_finite(r.growth))
    return core::Error{core::refused("growth", r.growth, "a number > 1")};
  if (r.sectors < 3 || r.sectors > 1000) return core::Error{core::refused("sectors", r.sectors, "3 to 1000")};
  if (!(r.jitter >= 0 && r.jitter <= 1)) return core::Error{core::refused("jitter", r.jitter, "0 to 1")};
  if (!(math::abs(length_squared(r.axis) - 1) < 1e-6)) return core::Error{"axis: expected a unit vector"};
  if (!is_finite(r.impact)) return core::Error{"impact is not finite"};
  math::Random random(seed);
  const Vec3d u = normalize(perpendicular(r.axis)), v = cross(r.axis, u);
  double reach = 0;  // square to the axis
  for (const Vec3d& p : container.vertices())
    reach = math::max(reach, math::hypot(dot(p - r.impact, u), dot(p - r.impact, v)));
  if (r.limit > 0) reach = math::min(reach, r.limit);
  std::vector<Vec3d> sites{r.impact};
  double inner = r.first_radius;
  for (int ring = 0; inner < reach && ring < 64; ++ring) {
    const double outer = inner * r.growth, middle = 0.5 * (inner + outer);
    const double turn = random.uniform(0.0, 2 * math::pi);
    for (int k = 0; k < r.sectors; ++k) {
      const double angle = turn + 2 * math::pi * (k + 0.5 * r.jitter * random.uniform(-1.0, 1.0)) / double(r.sectors);
      const double radius = middle + 0.5 * r.jitter * (outer - inner) * random.uniform(-1.0, 1.0);
      sites.push_back(r.impact + (radius * math::cos(angle)) * u + (radius * math::sin(angle)) * v);
    }
    inner = outer;
  }
  return sites;
}

core::Result<Pattern> voronoi_pattern(const ConvexCell& container, std::span<const Vec3d> sites,
                                      core::TaskScheduler* scheduler) {
  if (auto s = check(container); !s) return s.error();
  if (sites.empty()) return core::Error{"voronoi_pattern: no sites, expected at least one"};
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (!within_reach(sites[i]))
      return core::Error{core::text("voronoi_pattern: site ", i, " is not finite, or more than 1e30 m away")};
  const detail::SiteGrid grid(sites, bounds_of(container));
  Pattern pattern;
  pattern.cells.resize(sites.size());
  struct Work {
    Cutting cell;
    std::vector<detail::SiteGrid::Near> near;
  };
  core::SerialScheduler alone;
  core::TaskScheduler& threads = scheduler != nullptr ? *scheduler : alone;
  std::vector<Work> works(std::size_t(threads.thread_count()), Work{Cutting(container), {}});
  constexpr std::uint32_t nobody = 0xffffffff;
  std::vector<std::uint32_t> twins(sites.size(), nobody);  // another site in the same place
  threads.parallel_for(int(sites.size()), 8, [&](int begin, int end, int worker) {
    Work& work = works[std::size_t(worker)];
    for (std::uint32_t i = std::uint32_t(begin); i < std::uint32_t(end); ++i) {
      for (const bool may_be_fast : {true, false}) {
        const Reach whole = work.cell.start(sites[i], may_be_fast);
        const auto found = cut_cell(grid, sites, i, whole, work.near, twins[i], work.cell);
        if (work.cell.failed()) continue;
        if (found == ConvexCell::Cut::all || work.cell.store(pattern.cells[i])) break;
      }
    }
  });
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (twins[i] != nobody)
      return core::Error{core::text("voronoi_pattern: sites ", i, " and ", twins[i], " are in one place")};
  pattern.meetings.reserve(8 * sites.size());
  for (std::uint32_t i = 0; i < sites.size(); ++i)
    for (const ConvexCell::Face& face : pattern.cells[i].faces())
      if (face.tag >= 0 && std::uint32_t(face.tag) > i)
        pattern.meetings.push_back({i, std::uint32_t(face.tag), face.tag, int(i)});
  return pattern;
}

core::Result<Pattern> slab_pattern(const ConvexCell& container, Vec3d normal, int count, double jitter,
                                   std::uint64_t seed) {
  if (auto s = check(container); !s) return s.error();
  if (auto s = detail::check_slabs(normal, count, 65536, jitter); !s) return s.error();
  normal = normalize(normal);
  double low = dot(normal, container.vertices()[0]), high = low;
  for (const Vec3d& v : container.vertices())
    low = math::min(low, dot(normal, v)), high = math::max(high, dot(normal, v));
  const std::vector<double> borders = detail::slab_borders(low, high, count, jitter, seed);
  Pattern pattern;
  for (int k = 0; k < count; ++k) {
    ConvexCell cell = container;
    if (k > 0) cell.clip({-normal, -borders[std::size_t(k - 1)], k - 1});
    if (k + 1 < count && !cell.empty()) cell.clip({normal, borders[std::size_t(k)], k + 1});
    pattern.cells.push_back(std::move(cell));
    if (k > 0) pattern.meetings.push_back({std::uint32_t(k - 1), std::uint32_t(k), k, k - 1});
  }
  return pattern;
}

core::Result<Pattern> brick_pattern(const ConvexCell& container, Vec3d size, Vec3d corner) {
  if (auto s = check(container); !s) return s.error();
  if (!(size.x > 0 && size.y > 0 && size.z > 0) || !is_finite(size))
    return core::Error{core::text("size is (", size.x, ", ", size.y, ", ", size.z, "), expected metres > 0")};
  if (!is_finite(corner)) return core::Error{"corner is not finite"};
  const geometry::Bounds3d box = bounds_of(container);
  // Per axis the first and the last brick, for courses that are shifted and for those that are not.
  std::int64_t first[2][3], last[2][3], low[3], count[3];
  for (int k = 0; k < 3; ++k) {
    for (int odd = 0; odd < 2; ++odd) {
      const detail::BrickRow row(box.low[k], box.high[k], corner[k], size[k], k == 0 ? 0.5 * odd : 0);
      if (!row.countable) return core::Error{"brick_pattern: more than 65536 bricks"};
      first[odd][k] = row.first, last[odd][k] = row.last;
    }
    low[k] = math::min(first[0][k], first[1][k]);
    count[k] = math::max(last[0][k], last[1][k]) - low[k] + 1;
  }
  if (count[0] * count[1] * count[2] > 65536)
    return core::Error{
        core::text("brick_pattern: ", count[0] * count[1] * count[2], " bricks, expected at most 65536")};
  Pattern pattern;
  const auto index = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const bool exists = x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2];
    return exists ? std::int64_t((z * count[1] + y) * count[0] + x) : -1;
  };
  ConvexCell::Scratch scratch;
  for (std::int64_t z = 0; z < count[2]; ++z)
    for (std::int64_t y = 0; y < count[1]; ++y)
      for (std::int64_t x = 0; x < count[0]; ++x) {
        const std::int64_t here = index(x, y, z);
        const bool odd = ((y + low[1]) & 1) != 0;
        const auto border = [&](int axis, std::int64_t i) {
          return corner[axis] +
                 (double(i + low[axis]) + (axis == 0 && odd ? 0.5 : 0.0) + detail::off_lattice) * size[axis];
        };
        const std::int64_t place[3] = {x, y, z};
        ConvexCell cell = container;
        for (int axis = 0; axis < 3 && !cell.empty(); ++axis) {
          const std::int64_t i = place[axis] + low[axis];
          if (i < first[odd][axis] || i > last[odd][axis]) {
            cell = {};
            break;
          }
          // The container closes the outermost.
          Vec3d n{};
          n[axis] = -1;
          if (i > first[odd][axis]) cell.clip({n, -border(axis, place[axis]), 2 * axis}, scratch);
          n[axis] = 1;
          if (i < last[odd][axis] && !cell.empty())
            cell.clip({n, border(axis, place[axis] + 1), 2 * axis + 1}, scratch);
        }
        pattern.cells.push_back(std::move(cell));
        const auto meet = [&](std::int64_t other, int tag, int other_tag) {
          if (other >= 0) pattern.meetings.push_back({std::uint32_t(here), std::uint32_t(other), tag, other_tag, true});
        };
        meet(index(x + 1, y, z), 1, 0);
        meet(index(x, y, z + 1), 5, 4);
        // The course above is shifted: two bricks of it lie on each.
        meet(index(odd ? x : x - 1, y + 1, z), 3, 2);
        meet(index(odd ? x + 1 : x, y + 1, z), 3, 2);
      }
  return pattern;
}

}  // namespace carom::blast
