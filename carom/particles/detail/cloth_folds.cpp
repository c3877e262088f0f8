// Folds of a cloth that meet: impulses between vertices and triangles.
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

struct FoldCell {
  std::int64_t x, y, z;
};
FoldCell cell_of(Vec3d p, double size) {
  return {std::int64_t(math::floor(p.x / size)), std::int64_t(math::floor(p.y / size)),
          std::int64_t(math::floor(p.z / size))};
}
std::size_t place_of(FoldCell c, std::size_t mask) {
  const std::uint64_t h = std::uint64_t(c.x) * 0x9E3779B97F4A7C15u ^ std::uint64_t(c.y) * 0xC2B2AE3D27D4EB4Fu ^
                          std::uint64_t(c.z) * 0x165667B19E3779F9u;
  return std::size_t(h ^ h >> 29) & mask;
}

/// Shares of the corners at the foot of the perpendicular; false where it lies outside.
bool foot(Vec3f p, Vec3f a, Vec3f b, Vec3f& share, Vec3f& normal, float& height) {
  const Vec3f n = cross(a, b);
  const float square = dot(n, n);
  if (!(square > 1e-24f)) return false;
  const float beta = dot(cross(p, b), n) / square, gamma = dot(cross(a, p), n) / square;
  share = {1 - beta - gamma, beta, gamma};
  if (share.x < -0.02f || share.y < -0.02f || share.z < -0.02f) return false;
  normal = n * (1 / math::sqrt(square));
  height = dot(p, normal);
  return true;
}

}  // namespace

void ClothState::keep_apart(float h) {
  const double size = 1.2 * double(mean_edge);
  const std::size_t n = position.size();
  std::size_t table = 64;
  while (table < 2 * n) table *= 2;
  cell_first.assign(table + 1, 0);
  cell_list.resize(n);
  for (std::size_t i = 0; i < n; ++i) ++cell_first[place_of(cell_of(position[i], size), table - 1) + 1];
  for (std::size_t k = 0; k < table; ++k) cell_first[k + 1] += cell_first[k];
  for (std::size_t i = n; i-- > 0;)  // from the back, so that a cell's list rises
    cell_list[std::size_t(--cell_first[place_of(cell_of(position[i], size), table - 1) + 1])] = int(i);
  // Each entry + 1 now holds the begin of its cell, as the one after holds its end.
  const float apart = math::min(float(fabric.thickness), 0.6f * smallest_edge);
  pairs.clear();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t* c = &corners[3 * t];
    float speed = 0;
    for (int k = 0; k < 3; ++k) speed = math::max(speed, length(velocity[c[k]] - velocity[c[0]]));
    const double margin = double(apart) + math::min(2.0 * double(h * speed) + double(apart), 0.5 * size);
    Vec3d low = min(position[c[0]], min(position[c[1]], position[c[2]]));
    Vec3d high = max(position[c[0]], max(position[c[1]], position[c[2]]));
    low -= Vec3d{margin, margin, margin};
    high += Vec3d{margin, margin, margin};
    const FoldCell from = cell_of(low, size), to = cell_of(high, size);
    if (to.x - from.x > 8 || to.y - from.y > 8 || to.z - from.z > 8) continue;  // stretched out of all measure
    const Vec3d origin = position[c[0]];
    const Vec3f a(position[c[1]] - origin), b(position[c[2]] - origin);
    for (std::int64_t x = from.x; x <= to.x; ++x)
      for (std::int64_t y = from.y; y <= to.y; ++y)
        for (std::int64_t z = from.z; z <= to.z; ++z) {
          const std::size_t place = place_of({x, y, z}, table - 1);
          const int begin = cell_first[place + 1], end = place + 2 <= table ? cell_first[place + 2] : int(n);
          for (int k = begin; k < end; ++k) {
            const std::uint32_t v = std::uint32_t(cell_list[std::size_t(k)]);
            if (v == c[0] || v == c[1] || v == c[2]) continue;
            const Vec3d p = position[v];
            const FoldCell own = cell_of(p, size);  // not another cell of the same place in the table
            if (own.x != x || own.y != y || own.z != z) continue;
            if (p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z) continue;
            Vec3f share, normal;
            float height = 0;
            if (foot(Vec3f(p - origin), a, b, share, normal, height) && math::abs(height) < float(margin))
              pairs.push_back({v, std::uint32_t(t)});
          }
        }
  }
  const auto lightness = [&](std::uint32_t i) {
    return pin_of[i] >= 0 && pins[std::size_t(pin_of[i])].mass == 0 ? 0.0f : 1 / mass[i];
  };
  const float friction = float(fabric.friction);
  for (int sweep = 0; sweep < 3; ++sweep)
    for (const ClothPair& pair : pairs) {
      const std::uint32_t v = pair.vertex, *c = &corners[3 * std::size_t(pair.triangle)];
      const Vec3d origin = position[c[0]];
      Vec3f share, normal;
      float height = 0;
      if (!foot(Vec3f(position[v] - origin), Vec3f(position[c[1]] - origin), Vec3f(position[c[2]] - origin), share,
                normal, height))
        continue;
      const float side = height >= 0 ? 1.0f : -1.0f, gap = side * height - apart;
      const Vec3f relative =
          velocity[v] - share.x * velocity[c[0]] - share.y * velocity[c[1]] - share.z * velocity[c[2]];
      const float opening = side * dot(normal, relative);
      const float wanted = gap >= 0 ? -gap / h : math::min(-0.2f * gap / h, 0.5f);
      if (opening >= wanted) continue;
      const float weight = lightness(v) + share.x * share.x * lightness(c[0]) + share.y * share.y * lightness(c[1]) +
                           share.z * share.z * lightness(c[2]);
      if (!(weight > 0)) continue;
      const float push = (wanted - opening) / weight;
      Vec3f impulse = (side * push) * normal;
      const Vec3f slide = relative - dot(normal, relative) * normal;
      const float speed = length(slide);
      if (speed > 1e-9f) impulse -= (math::min(friction * push, speed / weight) / speed) * slide;
      velocity[v] += lightness(v) * impulse;
      for (int k = 0; k < 3; ++k) velocity[c[k]] -= (share[k] * lightness(c[k])) * impulse;
    }
}

}  // namespace carom::particles::detail
