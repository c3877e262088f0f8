// Air and wind over height as tables: what models that ask a thousand times a flight use instead of the formulas.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "carom/environment/atmosphere.h"
#include "carom/environment/wind.h"

namespace carom::environment {

/// Density and speed of sound over the height above the ground, linear between nodes 50 m apart: within 1e-5 of the
/// standard's formulas from −5 to 40 km, and constant beyond.
class CAROM_API AirColumn {
 public:
  struct Air {
    double density = 1.225;           ///< kg/m³
    double speed_of_sound = 340.294;  ///< m/s
  };

  /// The standard day over ground at sea level.
  AirColumn() : AirColumn(AtmosphereOffset{}) {}
  /// The atmosphere over ground that lies at `ground_altitude` m (geometric).
  explicit AirColumn(const AtmosphereOffset& offset, double ground_altitude = 0);
  /// The same air at every height. density 0: a vacuum.
  static AirColumn uniform(double density, double speed_of_sound = 340.294);

  Air at(double height) const {
    Air by_metre;
    return at(height, by_metre);
  }
  /// With what a metre of height changes.
  Air at(double height, Air& by_metre) const {
    const double place = math::min(math::max(0.0, (height - lowest_) * per_metre_), last_);
    const int i = math::min(int(place), int(last_) - 1);
    const double t = place - double(i);
    const Air &a = nodes_[std::size_t(i)], &b = nodes_[std::size_t(i) + 1];
    const double density = b.density - a.density, sound = b.speed_of_sound - a.speed_of_sound;
    by_metre = {density * per_metre_, sound * per_metre_};
    return {a.density + t * density, a.speed_of_sound + t * sound};
  }

  /// For kernels in lanes: node i lies at lowest + i/per_metre, the last one at `last`.
  struct Table {
    const Air* nodes;
    double lowest, per_metre, last;
  };
  Table table() const { return {nodes_.data(), lowest_, per_metre_, last_}; }

 private:
  struct Empty {};
  explicit AirColumn(Empty) {}
  double lowest_ = 0, per_metre_ = 0, last_ = 1;
  std::vector<Air> nodes_;
};

/// Wind by height: velocities at rising heights, linear between them and constant beyond.
class CAROM_API WindColumn {
 public:
  struct Level {
    double height = 0;       ///< m
    math::Vec3d velocity{};  ///< m/s, where the air goes to
  };

  WindColumn() = default;  ///< calm
  /// The same wind at every height.
  explicit WindColumn(math::Vec3d velocity) : levels_{{0, velocity}}, lowest_(velocity) {}
  /// A profile, sampled up to `top` m.
  explicit WindColumn(const Wind& wind, double top = 1000);
  /// Levels of rising height; of equal heights the later one counts above. Any order is accepted and sorted.
  explicit WindColumn(std::span<const Level> levels);

  math::Vec3d at(double height) const {
    math::Vec3d shear;
    return at(height, shear);
  }
  /// With what a metre of height changes (1/s).
  math::Vec3d at(double height, math::Vec3d& shear) const {
    shear = {};
    if (legs_.empty()) return lowest_;
    const double above = height - legs_.front().height;
    if (!(above > 0)) return lowest_;
    const Leg& leg = leg_of(above, height);
    shear = leg.shear;
    return leg.velocity + (height - leg.height) * leg.shear;
  }
  std::span<const Level> levels() const { return levels_; }
  /// The same with every level `by` m higher.
  WindColumn raised(double by) const;
  /// Calls `f` with the heights of the levels between `low` and `high` m, in rising order, at which the wind leaves the
  /// line of the leg below by more than `least` m/s within the two legs beside it.
  template <class F>
  void for_each_bend(double low, double high, double least, F&& f) const {
    if (legs_.empty() || !(high > legs_.front().height)) return;
    const double above = low - legs_.front().height;
    const Leg* leg = above > 0 ? &leg_of(above, low) + 1 : legs_.data();
    for (const Leg* end = legs_.data() + legs_.size() - 1; leg != end && leg->height < high; ++leg)
      if (leg->height > low && leg->bend > least) f(leg->height);
  }

  /// m/s, of all its levels, as `for_each_bend` has it.
  double sharpest_bend() const { return sharpest_bend_; }

  /// From a level to the next: velocity at its height and by the metre above it.
  struct Leg {
    double height = 0;
    math::Vec3d velocity{}, shear{};
    double bend = 0;  // m/s, what a change of the shear there makes over both legs
  };
  /// For kernels in lanes: the legs, the last one without end, and for sixteen cells an octave of the height above the
  /// first one, by the first bits of the number, the leg that is at or below the beginning of each. Without shear there
  /// are none, and the wind is the lowest.
  struct Table {
    const Leg* legs;
    std::size_t count;
    const std::uint32_t* first;
    std::uint64_t first_cell, last_cell;
    math::Vec3d lowest;
  };
  Table table() const {
    return {legs_.data(), legs_.empty() ? 0 : legs_.size() - 1, first_.data(), first_cell_, last_cell_, lowest_};
  }

 private:
  const Leg& leg_of(double above, double height) const {
    const std::uint64_t cell = math::clamp(std::bit_cast<std::uint64_t>(above) >> 48, first_cell_, last_cell_);
    const Leg* leg = legs_.data() + first_[std::size_t(cell - first_cell_)];
    while (leg[1].height <= height) ++leg;
    return *leg;
  }
  void prepare();
  std::vector<Level> levels_;
  math::Vec3d lowest_{};
  double sharpest_bend_ = 0;
  std::vector<Leg> legs_;  // from each level to the next, above the last, and one beyond all; none without shear
  // Sixteen cells an octave of the height above the lowest level, by the first bits of the number: the leg that is at
  // or below the beginning of each.
  std::vector<std::uint32_t> first_;
  std::uint64_t first_cell_ = 0, last_cell_ = 0;
};

}  // namespace carom::environment
