// What debug drawings are made of: lines, crosses and arrows, as many as a frame has room for.
#pragma once

#include <algorithm>
#include <vector>

#include "apps/host/stage.h"

namespace carom::host {

class DebugPen {
 public:
  /// `mark`: m, half the size of a cross. `flat`: of the plane.
  DebugPen(double mark, bool flat, std::vector<Line>& out) : mark_(mark), flat_(flat), out_(out) {}

  bool full() const { return out_.size() >= max_lines; }
  double mark() const { return mark_; }
  void line(math::Vec3d a, math::Vec3d b, std::uint32_t pen) {
    if (!full() && math::is_finite(a) && math::is_finite(b)) out_.push_back({a, b, pen});
  }
  void dot(math::Vec3d at, std::uint32_t pen) { cross(at, pen, 0.5); }
  void cross(math::Vec3d at, std::uint32_t pen, double share = 1) {
    const double r = share * mark_;
    line(at - math::Vec3d{r, 0, 0}, at + math::Vec3d{r, 0, 0}, pen);
    line(at - math::Vec3d{0, r, 0}, at + math::Vec3d{0, r, 0}, pen);
    if (!flat_) line(at - math::Vec3d{0, 0, r}, at + math::Vec3d{0, 0, r}, pen);
  }
  void arrow(math::Vec3d from, math::Vec3d way, std::uint32_t pen) {
    const double length = math::length(way);
    if (!(length > 0.25 * mark_)) return;
    const math::Vec3d to = from + way, along = way * (1 / length);
    math::Vec3d side = math::cross(along, flat_ ? math::Vec3d{0, 0, 1} : math::Vec3d{0.3, 0.1, 0.95});
    side = side * (1 / std::max(1e-9, math::length(side)));
    const double head = std::min(0.35 * length, mark_);
    line(from, to, pen);
    line(to, to - head * along + 0.5 * head * side, pen);
    line(to, to - head * along - 0.5 * head * side, pen);
  }
  /// Part of a circle of `radius` round `center`: from `low` to `high`, rad from x toward y.
  void arc(math::Vec3d center, math::Vec3d x, math::Vec3d y, double radius, double low, double high,
           std::uint32_t pen) {
    constexpr int pieces = 16;
    const auto at = [&](int i) {
      const double angle = low + (high - low) * i / pieces;
      return center + radius * (math::cos(angle) * x + math::sin(angle) * y);
    };
    for (int i = 0; i < pieces; ++i) line(at(i), at(i + 1), pen);
  }

 private:
  double mark_;
  bool flat_;
  std::vector<Line>& out_;
};

}  // namespace carom::host
