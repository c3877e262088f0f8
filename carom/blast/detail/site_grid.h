// Where the sites of a pattern lie: which of them are near another.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/math/elementary.h"

namespace carom::blast::detail {

/// Sites sorted into a grid of cubes, about two in each.
class SiteGrid {
 public:
  SiteGrid(std::span<const math::Vec3d> sites, const geometry::Bounds3d& box) : sites_(sites), low_(box.low) {
    math::Vec3d size = box.high - box.low;
    for (const math::Vec3d& s : sites) low_ = min(low_, s), size = max(size, s - box.low);
    const double largest = math::max(size.x, math::max(size.y, size.z));
    size = max(size, 0.01 * math::Vec3d{largest, largest, largest});
    edge_ = math::cbrt(2 * size.x * size.y * size.z / double(sites.size()));
    if (!(edge_ > 0)) edge_ = largest > 0 ? largest : 1;
    for (int k = 0; k < 3; ++k) count_[k] = 1 + int(math::clamp(size[k] / edge_, 0.0, 255.0));
    std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
    order.reserve(sites.size());
    for (std::uint32_t i = 0; i < sites.size(); ++i) order.push_back({index(sites[i]), i});
    std::sort(order.begin(), order.end());
    first_.assign(std::size_t(count_[0]) * std::size_t(count_[1]) * std::size_t(count_[2]) + 1, 0);
    members_.reserve(sites.size());
    for (const auto& [cube, site] : order) ++first_[cube + 1], members_.push_back({sites[site], site});
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  }
  double edge() const { return edge_; }
  int rings() const { return math::max(count_[0], math::max(count_[1], count_[2])); }

  struct Near {
    double distance_squared;
    std::uint32_t member;
  };
  std::uint32_t site(const Near& n) const { return members_[n.member].site; }
  const math::Vec3d& place(const Near& n) const { return members_[n.member].place; }
  void sort(Near* begin, Near* end) const {
    std::sort(begin, end, [this](const Near& a, const Near& b) {
      return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared : site(a) < site(b);
    });
  }
  /// The sites of the cubes that are `ring` (≥ 1) away from the site's own, for 1 those of its own too, and within the
  /// limit, in no order that counts.
  std::span<Near> ring(std::uint32_t site, int ring, double limit_squared, std::vector<Near>& found) const {
    std::size_t count = 0;
    int c[3], low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      c[k] = place(sites_[site], k);
      low[k] = math::max(c[k] - ring, 0), high[k] = math::min(c[k] + ring, count_[k] - 1);
    }
    // No site of a row of cubes is nearer than the row; a hair is left for how places are rounded.
    const auto gap_squared = [&](int cube, int k) {
      if (cube == c[k]) return 0.0;
      const double face = low_[k] + (cube + (cube < c[k])) * edge_;
      return math::square(math::max(math::abs(face - sites_[site][k]) - 1e-9 * edge_, 0.0));
    };
    const math::Vec3d here = sites_[site];
    const auto look = [&](std::size_t row, int from, int to) {  // cubes side by side
      const std::uint32_t begin = first_[row + std::size_t(from)], end = first_[row + std::size_t(to) + 1];
      if (found.size() < count + (end - begin)) found.resize(2 * count + (end - begin));
      for (std::uint32_t m = begin; m < end; ++m) {
        const double d = distance_squared(members_[m].place, here);
        found[count] = {d, m};
        count += (d <= limit_squared) & (members_[m].site != site);
      }
    };
    for (int z = low[2]; z <= high[2]; ++z) {
      const double from_z = gap_squared(z, 2);
      if (from_z > limit_squared) continue;
      for (int y = low[1]; y <= high[1]; ++y) {
        const double from_row = from_z + gap_squared(y, 1);
        if (from_row > limit_squared) continue;
        const std::size_t row = (std::size_t(z) * std::size_t(count_[1]) + std::size_t(y)) * std::size_t(count_[0]);
        if (ring == 1 || z - c[2] == ring || c[2] - z == ring || y - c[1] == ring || c[1] - y == ring) {
          int from = low[0], to = high[0];
          while (from < c[0] && from_row + gap_squared(from, 0) > limit_squared) ++from;
          while (to > c[0] && from_row + gap_squared(to, 0) > limit_squared) --to;
          look(row, from, to);
          continue;
        }
        if (c[0] - ring >= 0) look(row, c[0] - ring, c[0] - ring);
        if (c[0] + ring < count_[0]) look(row, c[0] + ring, c[0] + ring);
      }
    }
    return {found.data(), count};
  }

 private:
  int place(math::Vec3d p, int axis) const {
    return int(math::clamp((p[axis] - low_[axis]) / edge_, 0.0, double(count_[axis] - 1)));
  }
  std::uint32_t index(math::Vec3d p) const {
    return std::uint32_t((place(p, 2) * count_[1] + place(p, 1)) * count_[0] + place(p, 0));
  }
  std::span<const math::Vec3d> sites_;
  math::Vec3d low_;
  double edge_ = 1;
  int count_[3] = {1, 1, 1};
  struct Member {
    math::Vec3d place;
    std::uint32_t site;
  };
  std::vector<std::uint32_t> first_;
  std::vector<Member> members_;  // by cube
};

}  // namespace carom::blast::detail
