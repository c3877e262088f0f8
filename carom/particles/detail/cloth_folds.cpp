// Folds of a cloth that meet: impulses between vertices and triangles.
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

/// Vertices by the cells of a box round them, along x first: what is near a triangle are a few runs of the list.
struct FoldGrid {
  Vec3d low{};
  double inverse = 1;  // 1/m
  int cells[3] = {1, 1, 1};

  int along(double x, int axis) const {
    const double c = (x - low[axis]) * inverse;
    return c > 0 ? (c < cells[axis] ? int(c) : cells[axis] - 1) : 0;
  }
  std::size_t place(Vec3d p) const {
    const auto x = std::size_t(along(p.x, 0)), y = std::size_t(along(p.y, 1)), z = std::size_t(along(p.z, 2));
    return x + std::size_t(cells[0]) * (y + std::size_t(cells[1]) * z);
  }
  std::size_t count() const { return std::size_t(cells[0]) * std::size_t(cells[1]) * std::size_t(cells[2]); }
};
/// Cells of this size, or of a coarser one where there would be more than `most` of them.
FoldGrid make_fold_grid(const std::vector<Vec3d>& position, double size, double most) {
  FoldGrid grid;
  Vec3d high = grid.low = position[0];
  for (const Vec3d& p : position) {
    grid.low = min(grid.low, p);
    high = max(high, p);
  }
  const Vec3d extent = high - grid.low;
  const auto cells = [&] { return (extent.x / size + 1) * (extent.y / size + 1) * (extent.z / size + 1); };
  while (cells() > most && size < 1e9) size *= 1.3;
  if (!(cells() <= most)) return grid;  // flown apart without measure: one cell
  grid.inverse = 1 / size;
  for (int k = 0; k < 3; ++k) grid.cells[k] = int(extent[k] / size) + 1;
  return grid;
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
  const std::size_t n = position.size(), most = 8 * n + 1024;
  const double size = 1.2 * double(mean_edge);
  const FoldGrid grid = make_fold_grid(position, size, double(most));
  cell_first.reserve(most + 1);
  cell_first.assign(grid.count() + 1, 0);
  cell_list.resize(n);
  for (const Vec3d& p : position) ++cell_first[grid.place(p) + 1];
  for (std::size_t k = 0; k < grid.count(); ++k) cell_first[k + 1] += cell_first[k];
  for (std::size_t i = 0; i < n; ++i) cell_list[std::size_t(cell_first[grid.place(position[i])]++)] = int(i);
  for (std::size_t k = grid.count(); k > 0; --k) cell_first[k] = cell_first[k - 1];
  cell_first[0] = 0;
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
    const int x0 = grid.along(low.x, 0), x1 = grid.along(high.x, 0);
    const int y0 = grid.along(low.y, 1), y1 = grid.along(high.y, 1);
    const int z0 = grid.along(low.z, 2), z1 = grid.along(high.z, 2);
    if (x1 - x0 > 8 || y1 - y0 > 8 || z1 - z0 > 8) continue;  // stretched out of all measure
    const Vec3d origin = position[c[0]];
    const Vec3f a(position[c[1]] - origin), b(position[c[2]] - origin);
    for (int z = z0; z <= z1; ++z)
      for (int y = y0; y <= y1; ++y) {
        const std::size_t row = std::size_t(grid.cells[0]) * std::size_t(y + grid.cells[1] * z);
        for (int k = cell_first[row + std::size_t(x0)]; k < cell_first[row + std::size_t(x1) + 1]; ++k) {
          const std::uint32_t v = std::uint32_t(cell_list[std::size_t(k)]);
          if (v == c[0] || v == c[1] || v == c[2]) continue;
          const Vec3d p = position[v];
          if (p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z) continue;
          Vec3f share, normal;
          float height = 0;
          if (foot(Vec3f(p - origin), a, b, share, normal, height) && math::abs(height) < float(margin))
            pairs.push_back({v, std::uint32_t(t)});
        }
      }
  }
  const auto lightness = [&](std::uint32_t i) { return pin_of[i] >= 0 ? 0.0f : 1 / mass[i]; };
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
