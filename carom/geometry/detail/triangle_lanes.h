// Triangles of a mesh side by side: which of a leaf's may be met is told for all of them at once, in float and with
// room for its roundings; who asks then looks at those in double.
#pragma once

#include "carom/geometry/triangle_mesh.h"
#include "carom/math/simd.h"

namespace carom::geometry::detail {

/// Up to four triangles as seen from a place, in whose frame they are; lanes beyond `count` repeat the last.
struct TriangleLanes {
  using Four = math::WideFloat<4>;
  Four x[3], y[3], z[3];  ///< of their corners
  std::uint32_t all;      ///< bits of the lanes that hold one

  CAROM_SIMD_INLINE TriangleLanes(const TriangleMesh& mesh, const std::uint32_t* items, int count, Vec3f place)
      : all((1u << count) - 1) {
    const std::uint32_t* corners[4];
    for (int lane = 0; lane < 4; ++lane) corners[lane] = &mesh.indices[3 * items[lane < count ? lane : count - 1]];
#pragma GCC unroll 3
    for (int c = 0; c < 3; ++c) {
      const Vec3f &p = mesh.vertices[corners[0][c]], &q = mesh.vertices[corners[1][c]],
                  &r = mesh.vertices[corners[2][c]], &s = mesh.vertices[corners[3][c]];
      x[c] = Four{Four::Vector{p.x, q.x, r.x, s.x}} - Four::splat(place.x);
      y[c] = Four{Four::Vector{p.y, q.y, r.y, s.y}} - Four::splat(place.y);
      z[c] = Four{Four::Vector{p.z, q.z, r.z, s.z}} - Four::splat(place.z);
    }
  }

  /// Bits of those whose front the line from the place along `d` may go through.
  CAROM_SIMD_INLINE std::uint32_t met_by_line(Vec3f d) const {
    const Four dx = Four::splat(d.x), dy = Four::splat(d.y), dz = Four::splat(d.z);
    const auto around = [&](int c, Four& ax, Four& ay, Four& az) {  // d × corner
      ax = dy * z[c] - dz * y[c], ay = dz * x[c] - dx * z[c], az = dx * y[c] - dy * x[c];
    };
    const auto with = [&](int c, Four ax, Four ay, Four az) { return x[c] * ax + y[c] * ay + z[c] * az; };
    Four ax, ay, az, cx, cy, cz;
    around(0, ax, ay, az), around(2, cx, cy, cz);
    // The sides of the line on which the edges run: products of d and two corners, which lose a few ulps of the
    // product of the three lengths.
    const Four u = with(1, cx, cy, cz), v = with(2, ax, ay, az), w = with(1, ax, ay, az);
    const Four farthest = max(with(0, x[0], y[0], z[0]), max(with(1, x[1], y[1], z[1]), with(2, x[2], y[2], z[2])));
    const Four slack = Four::splat(2e-6f * math::length(d)) * farthest;
    return bitmask((u >= -slack) & (v >= -slack) & (w <= slack)) & all;
  }

  /// Bits of those whose own box meets one, which is given as seen from the place.
  CAROM_SIMD_INLINE std::uint32_t met_by_box(const Bounds3f& box) const {
    const auto meets = [](const Four(&p)[3], float low, float high) {
      return (min(p[0], min(p[1], p[2])) <= Four::splat(high)) & (max(p[0], max(p[1], p[2])) >= Four::splat(low));
    };
    return bitmask(meets(x, box.low.x, box.high.x) & meets(y, box.low.y, box.high.y) &
                   meets(z, box.low.z, box.high.z)) &
           all;
  }
};

}  // namespace carom::geometry::detail
