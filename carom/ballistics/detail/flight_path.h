// A recorded path of the aim solver: what happened at its nodes and in the stages of its steps.
#pragma once

#include "carom/ballistics/detail/flight_step.h"
#include "carom/ballistics/detail/rough_pull.h"

namespace carom::ballistics::detail {

struct FlightPath {
  static constexpr int most = 160;  // steps
  struct Node {
    double t, x[3], v[3], k[3];
  };
  using Stage = RoughPull::Slope;
  struct Arrival {
    math::Vec3d position{}, velocity{};
  };
  FlightPath() {}  // NOLINT(modernize-use-equals-default): what is not recorded stays as it is, tens of kilobytes
  int count = 0;
  Node node[most + 1];
  Stage stage[most][6];
  Arrival arrival{};
  math::Vec3d by_velocity[3];  ///< rows of ∂x(T)/∂v(0), s
  math::Vec3d off{};           ///< m, to be added to the arrival
};

}  // namespace carom::ballistics::detail
