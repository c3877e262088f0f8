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
    float rest[padded];                ///< m/s, how much of what bends it the points of the quadrature may mistake
    /// m: beside Hermite's quintic the interpolant has (1−t²)³ (b₀ + b₁ t + b₂ t²), t from −1 to 1.
    double bulge[3][3][padded];
  };

  FlightPath() {}  // NOLINT(modernize-use-equals-default): what is not recorded stays as it is, tens of kilobytes
  int count = 0;   ///< elements
  double t[padded], x[3][padded], v[3][padded], k[3][padded];         // of the nodes: s, m, m/s, m/s²
  double drag[padded], along[padded], w[3][padded], rise[3][padded];  ///< how k hangs on the velocity and the height
  Elements elements;
  Debt debt[most + 1];
  /// How the place and the velocity at a node hang on the velocity at the first one, and in the fourth lane by how much
  /// they are off. `carried`, `leaps`: m, by which what is off within and between elements may move it.
  struct Spread {
    alignas(16) float x[3][4], v[3][4];
    float carried, leaps;
  };
  Spread spread[most + 1];
  bool lands = false;          ///< it passes where profiles of wind begin
  bool bends = false;          ///< wind or drag bends sharply within an element
  double leaps = 0;            ///< m, of what the leaps between all elements do
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
  /// m, by which the arrival may be mistaken for what bends an element.
  double mistaken(int n) const { return elements.rest[n] * reach(n); }
  static math::Vec3d at(const double (&a)[3][padded], int i) { return {a[0][i], a[1][i], a[2][i]}; }
  static void put(double (&a)[3][padded], int i, math::Vec3d value) {
    for (int j = 0; j < 3; ++j) a[j][i] = value[j];
  }
  void flatten(int n) {
    for (auto& power : elements.bulge)
      for (auto& one : power) one[n] = 0;
  }
  void put(int i, double time, math::Vec3d place, math::Vec3d velocity, math::Vec3d pull) {
    t[i] = time;
    put(x, i, place);
    put(v, i, velocity);
    put(k, i, pull);
  }
};

/// The interpolant over an element, from its start at s = 0 to its end at s = 1: what is even about the middle by
/// powers of t², t = 2 s − 1, and t times what is odd.
struct FlightElement {
  double half, even[3][5], odd[3][4];  // s; m
  FlightElement(const FlightPath& p, int n) : half(0.5 * (p.t[n + 1] - p.t[n])) {
    const auto& bulge = p.elements.bulge;
    for (int i = 0; i < 3; ++i) {
      const double x = 0.5 * p.x[i][n], to_x = 0.5 * p.x[i][n + 1], v = 0.5 * half * p.v[i][n],
                   to_v = 0.5 * half * p.v[i][n + 1], k = 0.5 * half * half * p.k[i][n],
                   to_k = 0.5 * half * half * p.k[i][n + 1];
      const double b0 = bulge[0][i][n], b1 = bulge[1][i][n], b2 = bulge[2][i][n];
      const double e2 = 0.125 * ((k + to_k) - (to_v - v)), e1 = 0.5 * (to_v - v) - 2 * e2;
      const double turn = (v + to_v) - (to_x - x), o2 = 0.125 * ((to_k - k) - 3 * turn), o1 = 0.5 * turn - 2 * o2;
      even[i][0] = (x + to_x) - e1 - e2 + b0;
      even[i][1] = e1 + b2 - 3 * b0;
      even[i][2] = e2 + 3 * (b0 - b2);
      even[i][3] = 3 * b2 - b0;
      even[i][4] = -b2;
      odd[i][0] = (to_x - x) - o1 - o2 + b1;
      odd[i][1] = o1 - 3 * b1;
      odd[i][2] = o2 + 3 * b1;
      odd[i][3] = -b1;
    }
  }
  double place(int i, double s) const {
    const double t = 2 * s - 1, t2 = t * t, *e = even[i], *o = odd[i];
    return e[0] + t2 * (e[1] + t2 * (e[2] + t2 * (e[3] + t2 * e[4]))) +
           t * (o[0] + t2 * (o[1] + t2 * (o[2] + t2 * o[3])));
  }
  double velocity(int i, double s) const {
    const double t = 2 * s - 1, t2 = t * t, *e = even[i], *o = odd[i];
    return (o[0] + t2 * (3 * o[1] + t2 * (5 * o[2] + t2 * (7 * o[3]))) +
            t * (2 * e[1] + t2 * (4 * e[2] + t2 * (6 * e[3] + t2 * (8 * e[4]))))) /
           half;
  }
};

}  // namespace carom::ballistics::detail
