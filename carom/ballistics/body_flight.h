// A body of a world that flies like a projectile: the model of flight.h as an effector.
#pragma once

#include "carom/ballistics/flight.h"
#include "carom/rigid/effector.h"

namespace carom::ballistics {

struct BodyFlight {
  Projectile projectile{};
  /// Its uniform gravity must be the world's, which the world adds itself; what differs from that (a round Earth, the
  /// turning of the frame) the effector adds.
  Conditions conditions{};
  double dt = 1.0 / 60;  ///< s, the world's step: the force is the mean over it, by one classic Runge–Kutta step
  /// Whether it keeps to the air, and to the wind, of `conditions`. Else those of the world's Surroundings count where
  /// it has any, and its Wind blows beside them.
  bool own_air = false, own_wind = false;
};

/// Drag, wind and the Earth on a body: give it to World::add_effector. In the plane z is left out.
/// Errors: a null body, a step or projectile that cannot be.
template <class D>
CAROM_API core::Result<rigid::CustomEffector<D>> flight_effector(rigid::BodyId body, const BodyFlight& flight);

extern template CAROM_API core::Result<rigid::CustomEffector<rigid::Dim2>> flight_effector(rigid::BodyId,
                                                                                           const BodyFlight&);
extern template CAROM_API core::Result<rigid::CustomEffector<rigid::Dim3>> flight_effector(rigid::BodyId,
                                                                                           const BodyFlight&);

}  // namespace carom::ballistics
