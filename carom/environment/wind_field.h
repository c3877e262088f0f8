// The wind of a place as one field over space and time: a profile or layers, and on top of it gusts, turbulence,
// thermals, lees of obstacles and wakes of wings. The y axis is up.
#pragma once

#include <functional>
#include <vector>

#include "carom/environment/column.h"
#include "carom/environment/gust.h"
#include "carom/environment/thermal.h"
#include "carom/environment/turbulence.h"
#include "carom/environment/wake.h"
#include "carom/environment/wind.h"

namespace carom::environment {

struct WindField {
  Wind mean{};                              ///< the profile over the height above the ground
  std::vector<WindColumn::Level> layers{};  ///< where there are any they stand for the profile; by rising height
  Turbulence turbulence{};                  ///< over the whole field, as strong at the ground as above
  std::vector<Gust> gusts{};
  std::vector<Thermal> thermals{};
  std::vector<Obstacle> obstacles{};  ///< shelter from the profile, the layers and the gusts
  std::vector<WakeVortexPair> wakes{};

  /// Whether it is calm everywhere and always.
  CAROM_API bool calm() const;
  /// Whether nothing blows but `mean_at`.
  CAROM_API bool steady() const;
  /// The steady part (m/s) by the height (m) above the ground.
  CAROM_API math::Vec3d mean_at(double height) const;
  /// The velocity of the air (m/s). `ground` is the height of the ground under the point; at and below it nothing but
  /// the uniform wind blows.
  CAROM_API math::Vec3d at(math::Vec3d point, double time, double ground = 0) const;
  /// What `at` is more than `mean_at`, at the nodes of a grid; at and below the ground as right above it.
  CAROM_API void beyond_mean(const WindGrid& grid, double time, double ground, std::span<math::Vec3f> out) const;

 private:
  math::Vec3d without_turbulence(math::Vec3d point, double time, math::Vec3d mean) const;
};

/// The velocity of the air (m/s) at a place (m) and a time (s), for models that know no more of the wind: a pure
/// function, as WindField::at and Environment::wind are.
using WindFunction = std::function<math::Vec3d(math::Vec3d point, double time)>;

/// What blows round a place at one moment beyond the steady part, for many points at once: between the nodes of a grid.
/// Eddies smaller than two of its spacings are not where they should be, but as strong.
class CAROM_API WindPatch {
 public:
  /// For points between two corners of a box; beyond it all is as at its rim. `nodes`: of the grid, at most; at least
  /// 8. The grid lies at multiples of its spacing, so that it does not creep along with the box. No allocation once
  /// warm.
  void set(const WindField& field, math::Vec3d low, math::Vec3d high, double time, double ground = 0, int nodes = 4096);
  /// Likewise for the whole wind, steady part and all: for small things, which ask where they are.
  void set_whole(const WindField& field, math::Vec3d low, math::Vec3d high, double time, double ground = 0,
                 int nodes = 512);
  void clear() { nodes_.clear(); }
  /// m/s; none where the wind is steady.
  math::Vec3d at(math::Vec3d point) const;

  const WindGrid& grid() const { return grid_; }
  std::span<const math::Vec3f> nodes() const { return nodes_; }  ///< m/s; none where the wind is steady

 private:
  void place(math::Vec3d low, math::Vec3d high, int nodes);
  WindGrid grid_{};
  std::vector<math::Vec3f> nodes_;
};

/// The steady part over the height y, above ground that lies at `ground` m: for what asks by height alone. Profiles go
/// on to 20 km.
CAROM_API WindColumn column_of(const WindField& field, double ground = 0);

/// Names what is not finite or out of range.
CAROM_API core::Status validate(const WindField& field);

}  // namespace carom::environment
