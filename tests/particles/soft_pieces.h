// Soft bodies for tests, and how deep one is within another.
#pragma once

#include "carom/math/elementary.h"
#include "carom/particles/soft_body.h"

namespace carom::particles {

inline SoftBody solid(const SoftMesh& mesh, SoftMaterial material, math::Vec3d velocity = {}, int lanes = 0,
                      core::TaskScheduler* scheduler = nullptr) {
  return SoftBody::make({.material = material,
                         .points = mesh.points,
                         .tetrahedra = mesh.tetrahedra,
                         .velocity = velocity,
                         .scheduler = scheduler,
                         .lanes = lanes})
      .value();
}

/// m, of the deepest vertex of b inside the tetrahedra of a: to the nearest plane of a face.
inline double depth(const SoftBody& a, const SoftMesh& mesh_a, const SoftBody& b) {
  double deepest = 0;
  const auto x = a.positions();
  for (std::size_t e = 0; e + 3 < mesh_a.tetrahedra.size(); e += 4) {
    const math::Vec3d o = x[mesh_a.tetrahedra[e]];
    const math::Vec3d u = x[mesh_a.tetrahedra[e + 1]] - o, v = x[mesh_a.tetrahedra[e + 2]] - o,
                      w = x[mesh_a.tetrahedra[e + 3]] - o;
    const double six = math::triple(u, v, w);
    for (const math::Vec3d& p : b.positions()) {
      const math::Vec3d d = p - o;
      const double s = math::triple(d, v, w) / six, t = math::triple(u, d, w) / six, r = math::triple(u, v, d) / six;
      if (!(s > 0 && t > 0 && r > 0 && s + t + r < 1)) continue;
      double out = 1e9;  // to the surface
      const auto faces = a.surface();
      for (std::size_t f = 0; f < faces.size(); f += 3) {
        const math::Vec3d n =
            math::normalize(math::cross(x[faces[f + 1]] - x[faces[f]], x[faces[f + 2]] - x[faces[f]]));
        out = math::min(out, math::abs(math::dot(n, p - x[faces[f]])));
      }
      deepest = math::max(deepest, out);
    }
  }
  return deepest;
}

}  // namespace carom::particles
