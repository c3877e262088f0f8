// ∫dV, ∫x dV and ∫x xᵀ dV of solids: the quantities that simply add up, from which mass properties follow.
#pragma once

#include "carom/geometry/mass_properties.h"

namespace carom::geometry::detail {

struct VolumeIntegrals {
  double volume = 0;
  Vec3d first{};
  Mat3d second = Mat3d::zero();

  void add(double v, Vec3d f, const Mat3d& s) { volume += v, first += f, second = second + s; }

  // The tetrahedron (0, a, b, c), positive where a, b, c run counterclockwise seen from outside.
  // ∫x xᵀ dV = V/20 (Σ pᵢpᵢᵀ + (Σpᵢ)(Σpᵢ)ᵀ) over the four corners.
  void add_tetrahedron(Vec3d a, Vec3d b, Vec3d c) {
    const double v = triple(a, b, c) / 6;
    const Vec3d sum = a + b + c;
    add(v, (v / 4) * sum, (v / 20) * (outer(a, a) + outer(b, b) + outer(c, c) + outer(sum, sum)));
  }
  // A straight prism of `height` along the unit normal n over the triangle (a, b, c).
  void add_prism(Vec3d a, Vec3d b, Vec3d c, Vec3d n, double height) {
    const double v = height * math::length(cross(b - a, c - a)) / 2;
    const Vec3d m = (a + b + c) / 3.0;
    const Mat3d flat = (outer(a, a) + outer(b, b) + outer(c, c) + 9.0 * outer(m, m)) * (1.0 / 12);
    const double h1 = height / 2, h2 = height * height / 3;
    add(v, v * (m + h1 * n), v * (flat + h1 * (outer(m, n) + outer(n, m)) + h2 * outer(n, n)));
  }
};

inline MassProperties3 mass_of(const VolumeIntegrals& s, double density) {
  MassProperties3 m;
  if (!(s.volume > 0)) return m;
  m.mass = density * s.volume;
  m.center = s.first / s.volume;
  const Mat3d central = density * s.second - m.mass * outer(m.center, m.center);
  m.inertia = trace(central) * Mat3d::identity() - central;
  return m;
}

inline MassProperties3 mass_of_diagonal(double mass, Vec3d center, Vec3d moments) {
  return {mass, center, Mat3d::diagonal(moments)};
}

}  // namespace carom::geometry::detail
