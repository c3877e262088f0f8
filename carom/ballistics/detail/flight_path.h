// A path of the aim solver: the nodes of a flight, and what every element between two of them does to the arrival.
#pragma once

#include "carom/math/vec.h"

namespace carom::ballistics::detail {

struct FlightPath {
  static constexpr int most = 160;          // elements
  static constexpr int padded = most + 16;  // lanes read beyond the last node
  struct Arrival {
    math::Vec3d position{}, velocity{};
  };
  /// What the arrival owes to a change of the velocity and, beside the same change of its own, of the height: columns
  /// of ∂x(T)/∂(v, y), the fourth lane idle. Seven digits are plenty.
  struct Debt {
    alignas(16) float v[3][4], y[4];
  };
  /// From one node to the next. A small change through it: δv' = a δv + b e (e·δv) + q (δy + ½ h δy'),
  /// δx' = δx + c δv + d e (e·δv) + ½ h q (δy + ⅓ h δy').
  struct Elements {
    float a[padded], b[padded], c[padded], d[padded], e[3][padded], q[3][padded], h[padded];
    float x[3][padded], v[3][padded];  ///< what a flight from the first node does beside what the second says
    float defect[padded];              ///< m/s, by how much the interpolant leaves the equation of motion, in all
    float rest[padded];                ///< m/s, how much of it the points of the quadrature may mistake
  };

  FlightPath() {}  // NOLINT(modernize-use-equals-default): what is not recorded stays as it is, tens of kilobytes
  int count = 0;   ///< elements
  double t[padded], x[3][padded], v[3][padded], k[3][padded];         // of the nodes: s, m, m/s, m/s²
  double drag[padded], along[padded], w[3][padded], rise[3][padded];  ///< how k hangs on the velocity and the height
  Elements elements;
  Debt debt[most + 1];
  bool lands = false;  ///< it passes where profiles of wind begin
  bool bends = false;  ///< wind or drag bends sharply within an element
  double leaps = 0;    ///< m, of what the leaps between all elements do
  double steep = 0;    ///< m, the same weighted by how wind that changes with height feeds on errors of the height
  math::Vec3d by_velocity[3];  ///< rows of ∂x(T)/∂v(0), s
  Arrival arrival{};

  double time() const { return t[count]; }
  /// s, how far at most a change of the velocity at the end of an element moves the arrival.
  double reach(int n) const {
    const Debt& d = debt[n];
    return (math::abs(d.v[0][0]) + math::abs(d.v[1][1]) + math::abs(d.v[2][2])) / 3;
  }
  /// m, by which the defect of an element may move the arrival.
  double carried(int n) const { return elements.defect[n] * reach(n); }
  static math::Vec3d at(const double (&a)[3][padded], int i) { return {a[0][i], a[1][i], a[2][i]}; }
  static void put(double (&a)[3][padded], int i, math::Vec3d value) {
    for (int j = 0; j < 3; ++j) a[j][i] = value[j];
  }
  void put(int i, double time, math::Vec3d place, math::Vec3d velocity, math::Vec3d pull) {
    t[i] = time;
    put(x, i, place);
    put(v, i, velocity);
    put(k, i, pull);
  }
};

}  // namespace carom::ballistics::detail
