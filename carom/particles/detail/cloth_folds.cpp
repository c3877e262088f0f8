// Folds of a cloth that meet: impulses between vertices and triangles.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

/// Bits of a number of ten, each followed by two zeros.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// Numbers of points, in the order of a Morton curve: what follows each other
/// lies near each other.
std::vector<int> order_by_place(const std::vector<Vec3d>& points) {
  Vec3d low = points[0], high = points[0];
  for (const Vec3d& p : points) low = min(low, p), high = max(high, p);
  const double extent = math::max(high.x - low.x, math::max(high.y - low.y, high.z - low.z));
  const double scale = extent > 0 ? 1023 / extent : 0;
  std::vector<std::uint32_t> key(points.size());
  std::vector<int> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p = scale * (points[i] - low);
    key[i] =
        spread_bits(std::uint32_t(p.x)) | spread_bits(std::uint32_t(p.y)) << 1 | spread_bits(std::uint32_t(p.z)) << 2;
    order[i] = int(i);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const std::uint32_t x = key[std::size_t(a)], y = key[std::size_t(b)];
    return x != y ? x < y : a < b;
  });
  return order;
}

}  // namespace

void ClothState::tile_folds() {
  const std::vector<int> vertices = order_by_place(position);
  constexpr std::size_t group = fold_lanes * fold_lanes;
  fold_vertices.assign((vertices.size() + group - 1) / group, FoldVertices{});
  for (FoldVertices& g : fold_vertices)
    for (auto& tile : g.vertex)
      for (int& vertex : tile) vertex = -1;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    fold_vertices[k / group].vertex[k % group / fold_lanes][k % fold_lanes] = vertices[k];

  std::vector<Vec3d> middle;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
    middle.push_back((position[corners[k]] + position[corners[k + 1]] + position[corners[k + 2]]) / 3.0);
  // Each tile grows from the first triangle that none has yet, by what hangs on it: tiles are in one piece.
  const std::vector<int> order = order_by_place(middle);
  std::vector<int> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[std::size_t(order[k])] = int(k);
  std::vector<std::uint8_t> laid(order.size(), 0);
  std::vector<int> hanging;  // on the tile: places in the order
  fold_triangles.clear();
  for (std::size_t first = 0; first < order.size(); ++first) {
    if (laid[first] != 0) continue;
    FoldTriangles tile{};
    hanging.assign(1, int(first));
    for (int lane = 0; lane < fold_lanes; ++lane) {
      const auto next = std::min_element(hanging.begin(), hanging.end());
      const int triangle = next == hanging.end() ? -1 : order[std::size_t(*next)];
      tile.triangle[lane] = triangle;
      for (std::size_t c = 0; c < 3 && triangle >= 0; ++c) {
        const std::uint32_t vertex = corners[3 * std::size_t(triangle) + c];
        tile.corner[c][lane] = int(vertex);
        laid[std::size_t(rank[std::size_t(triangle)])] = 1;
        for (int k = triangle_first[vertex]; k < triangle_first[vertex + 1]; ++k)
          hanging.push_back(rank[std::size_t(triangle_list[std::size_t(k)] / 3)]);
      }
      std::erase_if(hanging, [&](int k) { return laid[std::size_t(k)] != 0; });
    }
    fold_triangles.push_back(tile);
  }
  if (self_collide_edges) tile_fold_edges();
}

void ClothState::find_fold_pairs(float h, float apart) {
  constexpr float none = 1e30f;
  fold_records.resize(2 * position.size() + 2);
  for (std::size_t i = 0; i < position.size(); ++i) {
    fold_records[2 * i] = Vec3f(position[i] - position[0]);
    fold_records[2 * i + 1] = velocity[i];
  }
  fold_records[2 * position.size()] = Vec3f{none, none, none};  // where edges that are none end
  for (FoldVertices& group : fold_vertices) {
    Vec3f all_low{none, none, none}, all_high = -all_low;
    for (std::size_t k = 0; k < fold_lanes; ++k) {
      Vec3f low{none, none, none}, high = -low;
      for (std::size_t i = 0; i < fold_lanes; ++i) {
        const int vertex = group.vertex[k][i];
        const Vec3f p = vertex < 0 ? Vec3f{2 * none, 0, 0} : fold_records[2 * std::size_t(vertex)].vector();
        if (vertex >= 0) low = min(low, p), high = max(high, p);
        for (int axis = 0; axis < 3; ++axis) group.at[k][axis][i] = p[axis];
      }
      for (int axis = 0; axis < 3; ++axis) group.low[axis][k] = low[axis], group.high[axis][k] = high[axis];
      all_low = min(all_low, low);
      all_high = max(all_high, high);
    }
    for (int axis = 0; axis < 3; ++axis) group.all_low[axis] = all_low[axis], group.all_high[axis] = all_high[axis];
  }
  const float size = 1.2f * mean_edge;
  const SoftKernels& kernels = solver.kernels();
  kernels.lay_folds(fold_triangles.data(), int(fold_triangles.size()),
                    reinterpret_cast<const float*>(fold_records.data()), {apart, 2 * h, 0.5f * size, 8 * size});
  pairs.clear();
  crossings.clear();
  tangled.assign(position.size(), 0);
  fold_hits.resize(fold_lanes * fold_lanes * fold_lanes);
  const float step = 1 / h;
  for (const FoldTriangles& tile : fold_triangles)
    for (const FoldVertices& group : fold_vertices) {
      bool apart_from = false;
      for (int axis = 0; axis < 3; ++axis)
        apart_from |= group.all_high[axis] < tile.low[axis] || tile.high[axis] < group.all_low[axis];
      if (apart_from) continue;
      const int count = kernels.meet_folds(tile, group, fold_hits.data());
      for (int k = 0; k < count; ++k) {
        const FoldHit hit = fold_hits[std::size_t(k)];
        if (tangle(std::uint32_t(hit.vertex), std::uint32_t(hit.triangle))) continue;
        const std::uint32_t* c = &corners[3 * std::size_t(hit.triangle)];
        const Vec3f a = fold_place(c[0]), u = fold_place(c[1]) - a, v = fold_place(c[2]) - a, n = cross(u, v);
        const Vec3f way = fold_place(std::uint32_t(hit.vertex)) - a;
        const float inverse = 1 / dot(n, n), beta = inverse * dot(way, cross(v, n)),
                    gamma = inverse * dot(way, cross(n, u));
        const Vec3f normal = math::sqrt(inverse) * n;
        const float height = dot(way, normal), side = height >= 0 ? 1.0f : -1.0f, gap = side * height - apart;
        ClothPair pair{
            std::uint32_t(hit.vertex), std::uint32_t(hit.triangle), {1 - beta - gamma, beta, gamma}, side * normal};
        pair.wanted = gap >= 0 ? -gap * step : math::min(-0.2f * gap * step, 0.5f);
        const float weight = lightness(pair.vertex) + math::square(pair.share.x) * lightness(c[0]) +
                             math::square(pair.share.y) * lightness(c[1]) +
                             math::square(pair.share.z) * lightness(c[2]);
        if (!(weight > 0)) continue;
        pair.mass = 1 / weight;
        pairs.push_back(pair);
      }
    }
  // Of folds that cross nothing tells which side each belongs on: those that push each other apart where they are now
  // draw the cloth through itself and stretch it without end. What leads them out is how they cross (push_out).
  std::erase_if(pairs, [&](const ClothPair& pair) {
    const std::uint32_t* c = &corners[3 * std::size_t(pair.triangle)];
    return (tangled[pair.vertex] & tangled[c[0]] & tangled[c[1]] & tangled[c[2]]) != 0;
  });
}

Vec3f ClothState::fold_impulse(const Vec3f& relative, const Vec3f& normal, float wanted, float heavy) const {
  const float opening = dot(normal, relative);
  if (opening >= wanted) return {};
  const float push = (wanted - opening) * heavy;
  const Vec3f slide = relative - opening * normal;
  const float speed = length(slide), most = float(fabric.friction) * push;
  const Vec3f impulse = push * normal;
  return speed > 1e-9f ? impulse - (math::min(most, speed * heavy) / speed) * slide : impulse;
}

void ClothState::keep_apart(float h) {
  const float apart = math::min(float(fabric.thickness), 0.6f * smallest_edge);
  find_fold_pairs(h, apart);
  if (self_collide_edges) find_edge_pairs(h, apart);
  find_ways_out();
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (const ClothPair& pair : pairs) {
      const std::uint32_t v = pair.vertex, *c = &corners[3 * std::size_t(pair.triangle)];
      const Vec3f relative =
          velocity[v] - pair.share.x * velocity[c[0]] - pair.share.y * velocity[c[1]] - pair.share.z * velocity[c[2]];
      const Vec3f impulse = fold_impulse(relative, pair.normal, pair.wanted, pair.mass);
      if (impulse == Vec3f{}) continue;
      velocity[v] += lightness(v) * impulse;
      for (int k = 0; k < 3; ++k) velocity[c[k]] -= (pair.share[k] * lightness(c[k])) * impulse;
    }
    if (self_collide_edges) push_edges();
    push_out(h, apart);
  }
}

}  // namespace carom::particles::detail
