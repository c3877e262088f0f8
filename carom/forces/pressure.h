// Pressure on flat panels (chapter 3.5).
#pragma once

#include <cstdint>
#include <span>

#include "carom/forces/wrench.h"

namespace carom::forces {

/// Vector area of a triangle: along its outward (counterclockwise) normal, as long as its area (m²).
constexpr math::Vec3d area_vector(math::Vec3d a, math::Vec3d b, math::Vec3d c) {
  return 0.5 * math::cross(b - a, c - a);
}
/// Force (N) of a pressure (Pa) on a panel: −p A n.
constexpr math::Vec3d pressure_force(double pressure, math::Vec3d area) { return -pressure * area; }

/// Force and moment about `about` on a triangle whose corners feel the pressures p (Pa), linear in between.
constexpr Wrench3 pressure_on_triangle(math::Vec3d a, math::Vec3d b, math::Vec3d c, double pa, double pb, double pc,
                                       math::Vec3d about) {
  const math::Vec3d area = area_vector(a, b, c);
  const double sum = pa + pb + pc;
  // ∫ p r dA / A = (Σr Σp + Σ r p)/12
  const math::Vec3d first =
      ((a + b + c - 3.0 * about) * sum + (a - about) * pa + (b - about) * pb + (c - about) * pc) / 12;
  return {area * (-sum / 3), math::cross(area, first)};
}

/// The sum over a mesh; `pressure(point)` in Pa is taken at the vertices.
template <class Pressure>
Wrench3 pressure_on_mesh(std::span<const math::Vec3d> vertices, std::span<const std::uint32_t> indices,
                         const Pressure& pressure, math::Vec3d about) {
  Wrench3 total;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const math::Vec3d a = vertices[indices[i]], b = vertices[indices[i + 1]], c = vertices[indices[i + 2]];
    const double pa = pressure(a), pb = pressure(b), pc = pressure(c);
    total = total + pressure_on_triangle(a, b, c, pa, pb, pc, about);
  }
  return total;
}

}  // namespace carom::forces
