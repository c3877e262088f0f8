// Folds of a cloth that meet: impulses between vertices and triangles.
#include <bit>

#include "carom/math/elementary.h"
#include "carom/math/simd.h"
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

/// The shares of a triangle's corners at the foot of the perpendicular from a point, linear in where the point is.
struct FoldPlane {
  Vec3f origin{}, normal{}, second{}, third{};  // shares of the second and the third corner, 1/m

  static FoldPlane of(Vec3f origin, Vec3f a, Vec3f b) {
    const Vec3f n = cross(a, b);
    const float square = dot(n, n);
    if (!(square > 1e-24f)) return {origin, {}, {}, {}};
    return {origin, n * (1 / math::sqrt(square)), cross(b, n) * (1 / square), cross(n, a) * (1 / square)};
  }
};

/// Which of four points stand above or below a triangle, within `margin` of it.
std::uint32_t above(const FoldPlane& plane, float margin, const float* const (&at)[3]) {
  using F = math::WideFloat<4>;
  const F x = F::load(at[0]) - F::splat(plane.origin.x), y = F::load(at[1]) - F::splat(plane.origin.y),
          z = F::load(at[2]) - F::splat(plane.origin.z);
  const auto along = [&](Vec3f n) { return F::splat(n.x) * x + F::splat(n.y) * y + F::splat(n.z) * z; };
  const F height = along(plane.normal), beta = along(plane.second), gamma = along(plane.third);
  const F low = F::splat(-0.02f);
  return math::bitmask((math::abs(height) < F::splat(margin)) & (low <= beta) & (low <= gamma) &
                       (beta + gamma <= F::splat(1.02f)));
}

}  // namespace

void ClothState::find_fold_pairs(float h, float apart) {
  const std::size_t n = position.size(), most = 8 * n + 1024;
  const double size = 1.2 * double(mean_edge);
  const FoldGrid grid = make_fold_grid(position, size, double(most));
  cell_first.reserve(most + 1);
  cell_first.assign(grid.count() + 1, 0);
  cell_list.resize(n);
  cell_of.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    cell_of[i] = int(grid.place(position[i]));
    ++cell_first[std::size_t(cell_of[i]) + 1];
  }
  for (std::size_t k = 0; k < grid.count(); ++k) cell_first[k + 1] += cell_first[k];
  for (auto& list : cell_place) list.resize(n + 3);  // read by fours
  local.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = std::size_t(cell_first[std::size_t(cell_of[i])]++);
    cell_list[k] = int(i);
    local[i] = Vec3f(position[i] - grid.low);
    for (int axis = 0; axis < 3; ++axis) cell_place[axis][k] = local[i][axis];
  }
  for (std::size_t k = grid.count(); k > 0; --k) cell_first[k] = cell_first[k - 1];
  cell_first[0] = 0;
  pairs.clear();
  const auto lightness = [&](std::uint32_t i) { return pin_of[i] >= 0 ? 0.0f : 1 / mass[i]; };
  const float inverse = float(grid.inverse), step = 1 / h;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t* c = &corners[3 * t];
    const float speed = math::sqrt(
        math::max(length_squared(velocity[c[1]] - velocity[c[0]]), length_squared(velocity[c[2]] - velocity[c[0]])));
    const float margin = apart + math::min(2 * h * speed + apart, 0.5f * float(size));
    const Vec3f a = local[c[0]], b = local[c[1]], d = local[c[2]];
    int from[3], to[3];
    bool huge = false;
    for (int axis = 0; axis < 3; ++axis) {
      const float low = math::min(a[axis], math::min(b[axis], d[axis])) - margin;
      const float high = math::max(a[axis], math::max(b[axis], d[axis])) + margin;
      const float last = float(grid.cells[axis] - 1);
      from[axis] = int(math::clamp(low * inverse, 0.0f, last));
      to[axis] = int(math::clamp(high * inverse, 0.0f, last));
      huge |= to[axis] - from[axis] > 8;
    }
    if (huge) continue;  // stretched out of all measure
    const FoldPlane plane = FoldPlane::of(a, b - a, d - a);
    if (plane.normal == Vec3f{}) continue;
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y) {
        const std::size_t row = std::size_t(grid.cells[0]) * std::size_t(y + grid.cells[1] * z);
        const int end = cell_first[row + std::size_t(to[0]) + 1];
        for (int k = cell_first[row + std::size_t(from[0])]; k < end; k += 4) {
          const float* const at[3] = {&cell_place[0][std::size_t(k)], &cell_place[1][std::size_t(k)],
                                      &cell_place[2][std::size_t(k)]};
          std::uint32_t hits = above(plane, margin, at);
          if (end - k < 4) hits &= (1u << (end - k)) - 1;
          for (; hits != 0; hits &= hits - 1) {
            const std::uint32_t v = std::uint32_t(cell_list[std::size_t(k) + std::size_t(std::countr_zero(hits))]);
            if (v == c[0] || v == c[1] || v == c[2]) continue;
            const Vec3f way = local[v] - a;
            const float beta = dot(way, plane.second), gamma = dot(way, plane.third), height = dot(way, plane.normal);
            const float side = height >= 0 ? 1.0f : -1.0f, gap = side * height - apart;
            ClothPair pair{v, std::uint32_t(t), {1 - beta - gamma, beta, gamma}, side * plane.normal};
            pair.wanted = gap >= 0 ? -gap * step : math::min(-0.2f * gap * step, 0.5f);
            const float weight = lightness(v) + math::square(pair.share.x) * lightness(c[0]) +
                                 math::square(pair.share.y) * lightness(c[1]) +
                                 math::square(pair.share.z) * lightness(c[2]);
            if (!(weight > 0)) continue;
            pair.mass = 1 / weight;
            pairs.push_back(pair);
          }
        }
      }
  }
}

void ClothState::keep_apart(float h) {
  find_fold_pairs(h, math::min(float(fabric.thickness), 0.6f * smallest_edge));
  const auto lightness = [&](std::uint32_t i) { return pin_of[i] >= 0 ? 0.0f : 1 / mass[i]; };
  const float friction = float(fabric.friction);
  for (int sweep = 0; sweep < 3; ++sweep)
    for (const ClothPair& pair : pairs) {
      const std::uint32_t v = pair.vertex, *c = &corners[3 * std::size_t(pair.triangle)];
      const Vec3f relative =
          velocity[v] - pair.share.x * velocity[c[0]] - pair.share.y * velocity[c[1]] - pair.share.z * velocity[c[2]];
      const float opening = dot(pair.normal, relative);
      if (opening >= pair.wanted) continue;
      const float push = (pair.wanted - opening) * pair.mass;
      Vec3f impulse = push * pair.normal;
      const Vec3f slide = relative - opening * pair.normal;
      const float speed = length(slide);
      if (speed > 1e-9f) impulse -= (math::min(friction * push, speed * pair.mass) / speed) * slide;
      velocity[v] += lightness(v) * impulse;
      for (int k = 0; k < 3; ++k) velocity[c[k]] -= (pair.share[k] * lightness(c[k])) * impulse;
    }
}

}  // namespace carom::particles::detail
