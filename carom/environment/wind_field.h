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
  /// The steady part (m/s) by the height (m) above the ground.
  CAROM_API math::Vec3d mean_at(double height) const;
  /// The velocity of the air (m/s). `ground` is the height of the ground under the point; at and below it nothing but
  /// the uniform wind blows.
  CAROM_API math::Vec3d at(math::Vec3d point, double time, double ground = 0) const;
};

/// The velocity of the air (m/s) at a place (m) and a time (s), for models that know no more of the wind: a pure
/// function, as WindField::at and Environment::wind are.
using WindFunction = std::function<math::Vec3d(math::Vec3d point, double time)>;

/// The steady part over the height y, above ground that lies at `ground` m: for what asks by height alone. Profiles go
/// on to 20 km.
CAROM_API WindColumn column_of(const WindField& field, double ground = 0);

/// Names what is not finite or out of range.
CAROM_API core::Status validate(const WindField& field);

}  // namespace carom::environment
