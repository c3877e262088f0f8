// A recorded path of the aim solver: what happened at its nodes and in the stages of its steps.
#pragma once

#include "carom/ballistics/detail/flight_step.h"
#include "carom/ballistics/detail/rough_pull.h"
#include "carom/math/simd.h"

namespace carom::ballistics::detail {

struct FlightPath {
  static constexpr int most = 160;  // steps
  struct Node {
    double t, x[3], v[3], k[3];
    [[gnu::always_inline]] void put(double time, math::Vec3d place, math::Vec3d velocity, math::Vec3d pull) {
      t = time;
      for (int i = 0; i < 3; ++i) {
        x[i] = place[i];
        v[i] = velocity[i];
        k[i] = pull[i];
      }
    }
  };
  using Stage = RoughPull::Slope;
  /// What the arrival owes to a change of the velocity and of the height: columns of ∂x(T)/∂(v, y), the fourth lane
  /// idle. Seven digits are plenty.
  struct Debt {
    math::WideFloat<4> v[3], y;
  };
  /// What a step of rough flight misses, measured: added at its end.
  struct Correction {
    math::Vec3d x{}, v{};
  };
  struct Arrival {
    math::Vec3d position{}, velocity{};
  };
  FlightPath() {}  // NOLINT(modernize-use-equals-default): what is not recorded stays as it is, tens of kilobytes
  int count = 0;
  Node node[most + 1];
  Stage stage[most + 1][3];  ///< at the beginning, .3 and .8 of each step; last the beginning of none
  Debt debt[most + 1];
  Correction correction[most];
  bool bends = false;   ///< wind or drag bends sharply within a step
  bool layers = false;  ///< wind does
  double total = 0;     ///< m, of what every step's correction moves the arrival by
  double steep = 0;     ///< m, the same weighted by how wind that changes with height feeds on errors of the height
  Arrival arrival{};
  math::Vec3d by_velocity[3];  ///< rows of ∂x(T)/∂v(0), s
};

}  // namespace carom::ballistics::detail
