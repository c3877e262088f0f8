// Steps of flights.
#pragma once

#include "carom/math/vec.h"

namespace carom::ballistics::detail {

struct FlightStep {
  math::Vec3d x{}, v{}, k{};
  double error = 0;  // m/s
};

/// Dormand and Prince's pair of orders 5 and 4. k1 is the acceleration at the start, k the one at the end; `at(stage,
/// x, v)` is the acceleration, stages 1 to 6.
template <class At>
[[gnu::always_inline]] inline FlightStep flight_step(At&& at, math::Vec3d x, math::Vec3d v, math::Vec3d k1, double h) {
  using math::Vec3d;
  // The newest slope comes last in every sum, so that all before it is done when it is known.
  const Vec3d v2 = v + (h / 5) * k1, k2 = at(1, x + (h / 5) * v, v2);
  const Vec3d v3 = v + (h * (3.0 / 40)) * k1 + (h * (9.0 / 40)) * k2;
  const Vec3d k3 = at(2, x + (h * (3.0 / 40)) * v + (h * (9.0 / 40)) * v2, v3);
  const Vec3d v4 = v + (h * (44.0 / 45)) * k1 - (h * (56.0 / 15)) * k2 + (h * (32.0 / 9)) * k3;
  const Vec3d k4 = at(3, x + (h * (44.0 / 45)) * v - (h * (56.0 / 15)) * v2 + (h * (32.0 / 9)) * v3, v4);
  const Vec3d v5 = v + (h * (19372.0 / 6561)) * k1 - (h * (25360.0 / 2187)) * k2 + (h * (64448.0 / 6561)) * k3 -
                   (h * (212.0 / 729)) * k4;
  const Vec3d k5 = at(4,
                      x + (h * (19372.0 / 6561)) * v - (h * (25360.0 / 2187)) * v2 + (h * (64448.0 / 6561)) * v3 -
                          (h * (212.0 / 729)) * v4,
                      v5);
  const Vec3d v6 = v + (h * (9017.0 / 3168)) * k1 - (h * (355.0 / 33)) * k2 + (h * (46732.0 / 5247)) * k3 +
                   (h * (49.0 / 176)) * k4 - (h * (5103.0 / 18656)) * k5;
  const Vec3d k6 = at(5,
                      x + (h * (9017.0 / 3168)) * v - (h * (355.0 / 33)) * v2 + (h * (46732.0 / 5247)) * v3 +
                          (h * (49.0 / 176)) * v4 - (h * (5103.0 / 18656)) * v5,
                      v6);
  FlightStep end;
  end.v = v + (h * (35.0 / 384)) * k1 + (h * (500.0 / 1113)) * k3 + (h * (125.0 / 192)) * k4 -
          (h * (2187.0 / 6784)) * k5 + (h * (11.0 / 84)) * k6;
  end.x = x + (h * (35.0 / 384)) * v + (h * (500.0 / 1113)) * v3 + (h * (125.0 / 192)) * v4 -
          (h * (2187.0 / 6784)) * v5 + (h * (11.0 / 84)) * v6;
  end.k = at(6, end.x, end.v);
  end.error = h * math::length(71.0 / 57600 * k1 - 71.0 / 16695 * k3 + 71.0 / 1920 * k4 - 17253.0 / 339200 * k5 +
                               22.0 / 525 * k6 - 1.0 / 40 * end.k);
  return end;
}

/// Bogacki and Shampine's pair of orders 3 and 2, likewise.
template <class At>
[[gnu::always_inline]] inline FlightStep rough_flight_step(At&& at, math::Vec3d x, math::Vec3d v, math::Vec3d k1,
                                                           double h) {
  using math::Vec3d;
  const Vec3d v2 = v + (h / 2) * k1, k2 = at(1, x + (h / 2) * v, v2);
  const Vec3d v3 = v + (h * (3.0 / 4)) * k2, k3 = at(2, x + (h * (3.0 / 4)) * v2, v3);
  FlightStep end;
  end.v = v + (h * (2.0 / 9)) * k1 + (h / 3) * k2 + (h * (4.0 / 9)) * k3;
  end.x = x + (h * (2.0 / 9)) * v + (h / 3) * v2 + (h * (4.0 / 9)) * v3;
  end.k = at(3, end.x, end.v);
  end.error = h * math::length(5.0 / 72 * k1 - 1.0 / 12 * k2 - 1.0 / 9 * k3 + 1.0 / 8 * end.k);
  return end;
}

}  // namespace carom::ballistics::detail
