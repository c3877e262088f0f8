// Random shapes and poses for tests of contacts and queries, the same on every machine.
#pragma once

#include <cstdint>

#include "carom/geometry/hull.h"
#include "carom/geometry/manifold.h"
#include "carom/geometry/query.h"

namespace carom::geometry::testing {

struct Draw {
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  double unit() {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return double(state >> 11) * 0x1p-53;
  }
  float in(double a, double b) { return float(a + (b - a) * unit()); }
  int below(int n) { return int(unit() * n); }
  Vec3f direction() {
    while (true) {
      const Vec3f v{in(-1, 1), in(-1, 1), in(-1, 1)};
      const float l = length(v);
      if (l > 0.1f && l < 1) return v * (1 / l);
    }
  }
  /// In any direction, its length between a and b. Two draws in one expression would come in an order that the language
  /// leaves open: so they stand in statements of their own, everywhere.
  Vec3f vector(double a, double b) {
    const Vec3f d = direction();
    return d * in(a, b);
  }
  Quatf rotation() {
    while (true) {
      const Quatf q{in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)};
      const float l = length(q);
      if (l > 0.1f && l < 1) return normalize(q);
    }
  }
  Rot2f rotation2() {
    const Quatf q = rotation();
    return normalize(Rot2f{q.w + 0.01f, q.x});
  }
};

inline std::shared_ptr<const Hull> random_hull(Draw& draw, int points, float size, float radius = 0) {
  std::vector<Vec3f> cloud;
  for (int i = 0; i < points; ++i) cloud.push_back(draw.vector(0.8, 1) * size);
  HullOptions options;
  options.radius = radius;
  return make_hull(cloud, options).value();
}

/// Sphere, capsule, box, cylinder, cone, hull, rounded box and cylinder; sizes about `size`.
inline Shape3 random_convex(Draw& draw, int kind, float size = 1) {
  const auto r = [&] { return size * draw.in(0.3, 1); };
  switch (kind) {
    case 0:
      return Sphere{r()};
    case 1:
      return Capsule3{r(), r()};
    case 2:
      return Box{{r(), r(), r()}, 0};
    case 3:
      return Cylinder{r(), r()};
    case 4:
      return Cone{r(), r()};
    case 5:
      return random_hull(draw, 6 + draw.below(14), size);
    case 6:
      return Box{{r(), r(), r()}, 0.2f * size};
    default:
      return Cylinder{r(), r(), 0.2f * size};
  }
}
inline constexpr int convex_kinds = 8;
inline const char* kind_name(int kind) {
  constexpr const char* names[] = {"sphere", "capsule", "box",         "cylinder",
                                   "cone",   "hull",    "rounded box", "rounded cylinder"};
  return names[kind];
}

}  // namespace carom::geometry::testing
