// The acceleration of a point mass, roughly: what the aim solver's paths feel before their error is measured.
#pragma once

#include <bit>
#include <cstdint>

#include "carom/ballistics/detail/point_mass.h"

namespace carom::ballistics::detail {

/// C_D by the square of the Mach number, cubics between nodes at a thirty-second of a binary octave of M² + ½: within
/// about a thousandth of the curve. To find a cell takes a few bits of the sum, where the curve itself takes a square
/// root and a search: half the time of a step, which is one long chain of such questions.
class RoughPull {
 public:
  /// `fastest`: m/s, faster than anything will fly; the coefficient is constant beyond.
  RoughPull(const Projectile& projectile, const Conditions& conditions, double sound, double fastest)
      : conditions_(conditions), half_area_(0.5 * projectile.area_per_mass) {
    const int last =
        int(math::min(cell_of(math::square(fastest / sound) + lowest) - first_cell, std::uint64_t(most) - 2));
    Node here = node(projectile.drag, 0);
    for (int i = 0; i <= last; ++i) {
      const Node next = node(projectile.drag, i + 1);
      const double h = next.place - here.place, line = (next.coefficient - here.coefficient) / h;
      cell_[i] = {here.coefficient, here.slope, (3 * line - 2 * here.slope - next.slope) / h,
                  (here.slope + next.slope - 2 * line) / (h * h)};
      here = next;
    }
    farthest_ = here.place;
    cell_[last + 1] = {here.coefficient, 0, 0, 0};
  }

  /// How drag changes: ∂a/∂v = −drag I − bend w wᵀ, w the velocity through the air; rise = ∂a/∂y.
  struct Slope {
    float drag, bend, w[3], rise[3];
  };
  template <bool Plain>
  [[gnu::always_inline]] math::Vec3d at(math::Vec3d position, math::Vec3d velocity) const {
    const environment::AirColumn::Air air = conditions_.air.at(position.y);
    const math::Vec3d w = velocity - conditions_.wind.at(position.y);
    // What hangs on the height alone is known before the velocity is, and the root while the cell is found.
    const double slow = 1 / math::square(air.speed_of_sound), weight = -half_area_ * air.density;
    const double square = math::length_squared(w);
    return beside<Plain>(weight * math::sqrt(square) * drag(square * slow).coefficient * w, position, velocity);
  }
  template <bool Plain>
  [[gnu::always_inline]] math::Vec3d at(math::Vec3d position, math::Vec3d velocity, Slope& slope) const {
    environment::AirColumn::Air by_metre;
    math::Vec3d shear;
    const environment::AirColumn::Air air = conditions_.air.at(position.y, by_metre);
    const math::Vec3d w = velocity - conditions_.wind.at(position.y, shear);
    const double slowness = 1 / air.speed_of_sound, weight = half_area_ * air.density;
    const double square = math::length_squared(w), speed = math::sqrt(square), mach2 = square * (slowness * slowness);
    const DragCurve::Value drag = this->drag(mach2);
    const double pull = weight * speed * drag.coefficient, steep = 2 * weight * mach2 * drag.slope;
    const double bend = (weight * drag.coefficient + steep) / math::max(speed, 1e-9);
    slope.drag = float(pull);
    slope.bend = float(bend);
    const double along = bend * math::dot(w, shear) + steep * speed * slowness * by_metre.speed_of_sound -
                         half_area_ * by_metre.density * drag.coefficient * speed;
    for (int i = 0; i < 3; ++i) {
      slope.w[i] = float(w[i]);
      slope.rise[i] = float(pull * shear[i] + along * w[i]);
    }
    return beside<Plain>(-pull * w, position, velocity);
  }

 private:
  static constexpr double lowest = 0.5;
  static constexpr int most = 256;  // to Mach 11
  static constexpr std::uint64_t cell_of(double place) { return std::bit_cast<std::uint64_t>(place) >> 47; }
  static constexpr std::uint64_t first_cell = std::bit_cast<std::uint64_t>(lowest) >> 47;
  struct Node {
    double place, coefficient, slope;  // M² + ½, and by M²
  };
  static Node node(const DragCurve& curve, int i) {
    // Curves are lines over M near 0, no cubics over M²: the first cell, to M = 1/8, has the cubic that is nearest to a
    // line there, whose beginning has the value of M = .15/8 and the slope of M = .3125/8.
    const double place = std::bit_cast<double>((first_cell + std::uint64_t(i)) << 47);
    const double mach = math::max(math::sqrt(place - lowest), 0.3125 / 8);
    const DragCurve::Value value = curve.with_slope(mach);
    return {place, i > 0 ? value.coefficient : curve(0.15 / 8), 0.5 * value.slope / mach};
  }
  [[gnu::always_inline]] DragCurve::Value drag(double mach2) const {
    const double place = math::min(farthest_, mach2 + lowest);  // in this order for what is no number
    const std::uint64_t cell = cell_of(place);
    const double x = place - std::bit_cast<double>(cell << 47);
    const Cell& c = cell_[cell - first_cell];
    return {(c.constant + x * c.slope) + (x * x) * (c.square + x * c.cube),
            c.slope + x * (2 * c.square + x * (3 * c.cube))};
  }
  template <bool Plain>
  [[gnu::always_inline]] math::Vec3d beside(math::Vec3d a, math::Vec3d position, math::Vec3d velocity) const {
    if constexpr (!Plain) return a + beside_drag(conditions_, position, velocity);
    a.y -= conditions_.gravity;
    return a;
  }
  struct Cell {
    double constant, slope, square, cube;
  };
  const Conditions& conditions_;
  double half_area_ = 0;  // m²/kg
  double farthest_ = 0;
  Cell cell_[most];
};

}  // namespace carom::ballistics::detail
