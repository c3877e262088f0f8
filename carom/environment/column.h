// Air and wind over height as tables: what models that ask a thousand times a flight use instead of the formulas.
#pragma once

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
    const int last = int(nodes_.size()) - 1;
    const double place = math::clamp((height - lowest_) * per_metre_, 0.0, double(last));
    const int i = place > 0 ? math::min(int(place), last - 1) : 0;
    const double t = place - double(i);
    const Air &a = nodes_[std::size_t(i)], &b = nodes_[std::size_t(i) + 1];
    return {a.density + t * (b.density - a.density), a.speed_of_sound + t * (b.speed_of_sound - a.speed_of_sound)};
  }

 private:
  struct Empty {};
  explicit AirColumn(Empty) {}
  double lowest_ = 0, per_metre_ = 0;
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
  explicit WindColumn(math::Vec3d velocity) : levels_{{0, velocity}} {}
  /// A profile, sampled up to `top` m.
  explicit WindColumn(const Wind& wind, double top = 1000);
  /// Levels of rising height; of equal heights the later one counts above. Any order is accepted and sorted.
  explicit WindColumn(std::span<const Level> levels);

  math::Vec3d at(double height) const {
    if (levels_.size() > 1) return between(height);
    return levels_.empty() ? math::Vec3d{} : levels_.front().velocity;
  }
  std::span<const Level> levels() const { return levels_; }

 private:
  math::Vec3d between(double height) const;
  /// Sixteen cells an octave of the height above the lowest level, by the first bits of the number.
  std::size_t cell(double height) const;
  void prepare();
  std::vector<Level> levels_;
  std::vector<std::uint32_t> first_;  // the level at or below the beginning of a cell
  std::uint64_t first_cell_ = 0;
};

}  // namespace carom::environment
