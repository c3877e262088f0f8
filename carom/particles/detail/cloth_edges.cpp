// Folds of a cloth that meet edge to edge: where threads cross, and where no vertex stands above a triangle.
#include <algorithm>
#include <bit>

#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

namespace {

/// Whether all that the triangles of two connected tiles look at is one side of the cloth: a piece of a surface whose
/// normals lie within a right angle of one direction does not meet itself (Volino and Magnenat-Thalmann 1994).
bool bends_little(const FoldCone& a, const FoldCone& b) {
  const float half = 0.5f * (1 + dot(a.axis, b.axis));  // the square of the cosine of half the angle between them
  return a.cosine > 0 && b.cosine > 0 && a.cosine * a.cosine + half > 1 && b.cosine * b.cosine + half > 1;
}

}  // namespace

void ClothState::tile_fold_edges() {
  const std::size_t count = fold_triangles.size();
  fold_edges.assign(count, FoldEdges{});
  fold_cones.assign(count, FoldCone{});
  // An edge goes with the first of its triangles. Which tiles touch, by vertex.
  std::vector<std::vector<std::uint32_t>> ends(position.size());
  std::vector<std::vector<int>> tiles_of(position.size());
  fold_beside.assign(count, {});
  for (std::size_t t = 0; t < count; ++t) {
    const FoldTriangles& tile = fold_triangles[t];
    FoldEdges& own = fold_edges[t];
    for (auto& ends_of_edges : own.end)
      for (int& end : ends_of_edges) end = int(position.size());
    for (int lane = 0; lane < fold_lanes; ++lane) {
      if (tile.triangle[lane] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const auto p = std::uint32_t(tile.corner[k][lane]), q = std::uint32_t(tile.corner[(k + 1) % 3][lane]);
        std::vector<std::uint32_t>& known = ends[std::min(p, q)];
        if (std::find(known.begin(), known.end(), std::max(p, q)) == known.end()) {
          known.push_back(std::max(p, q));
          own.end[0][own.count] = int(std::min(p, q));
          own.end[1][own.count++] = int(std::max(p, q));
        }
        if (tiles_of[p].empty() || tiles_of[p].back() != int(t)) tiles_of[p].push_back(int(t));
      }
    }
  }
  for (const std::vector<int>& list : tiles_of)
    for (const int a : list)
      for (const int b : list)
        if (a < b) fold_beside[std::size_t(a)].push_back(b);
  for (std::vector<int>& list : fold_beside) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

void ClothState::lay_cones() {
  for (std::size_t t = 0; t < fold_triangles.size(); ++t) {
    const FoldTriangles& tile = fold_triangles[t];
    FoldCone& cone = fold_cones[t];
    Vec3f sum{};
    for (int lane = 0; lane < fold_lanes; ++lane)
      if (tile.triangle[lane] >= 0) sum += Vec3f{tile.normal[0][lane], tile.normal[1][lane], tile.normal[2][lane]};
    const float size = length(sum);
    cone = {};
    if (!(size > 1e-3f)) continue;
    cone.axis = (1 / size) * sum;
    cone.cosine = 1;
    for (int lane = 0; lane < fold_lanes; ++lane)
      if (tile.triangle[lane] >= 0)
        cone.cosine = math::min(
            cone.cosine, dot(cone.axis, Vec3f{tile.normal[0][lane], tile.normal[1][lane], tile.normal[2][lane]}));
  }
}

void ClothState::lay_runs() {
  constexpr float none = 1e30f;
  const std::size_t count = fold_triangles.size();
  fold_runs.resize((count + fold_lanes - 1) / fold_lanes);
  for (std::size_t r = 0; r < fold_runs.size(); ++r) {
    FoldRun& run = fold_runs[r];
    for (int axis = 0; axis < 3; ++axis) {
      run.all_low[axis] = none, run.all_high[axis] = -none;
      for (std::size_t k = 0; k < fold_lanes; ++k) {
        const std::size_t t = r * fold_lanes + k;
        run.low[axis][k] = t < count ? fold_triangles[t].low[axis] : none;
        run.high[axis][k] = t < count ? fold_triangles[t].high[axis] : -none;
        run.all_low[axis] = math::min(run.all_low[axis], run.low[axis][k]);
        run.all_high[axis] = math::max(run.all_high[axis], run.high[axis][k]);
      }
    }
  }
}

void ClothState::find_edge_pairs(float h, float apart) {
  edge_pairs.clear();
  const SoftKernels& kernels = solver.kernels();
  kernels.lay_edges(fold_edges.data(), int(fold_edges.size()), reinterpret_cast<const float*>(fold_records.data()));
  lay_cones();
  lay_runs();
  const int count = int(fold_triangles.size()), runs = int(fold_runs.size());
  edge_hits.resize(std::size_t(FoldEdges::most) * FoldEdges::most);
  for (int a = 0; a < runs; ++a)
    for (int b = a; b < runs; ++b) {
      const FoldRun &ra = fold_runs[std::size_t(a)], &rb = fold_runs[std::size_t(b)];
      bool far = false;
      for (int axis = 0; axis < 3; ++axis)
        far |= ra.all_high[axis] < rb.all_low[axis] || rb.all_high[axis] < ra.all_low[axis];
      if (far) continue;
      for (int s = a * fold_lanes; s < math::min((a + 1) * fold_lanes, count); ++s) {
        const auto first = std::size_t(s);
        std::uint32_t near = kernels.meet_run(rb, fold_triangles[first]);
        if (a == b) near &= ~0u << (s % fold_lanes);  // itself, and those after it
        for (; near != 0; near &= near - 1) {
          const int t = b * fold_lanes + std::countr_zero(near);
          const std::vector<int>& beside = fold_beside[first];
          if (bends_little(fold_cones[first], fold_cones[std::size_t(t)]) &&
              (s == t || std::binary_search(beside.begin(), beside.end(), t)))
            continue;
          meet_edges(fold_edges[first], fold_triangles[std::size_t(t)], fold_edges[std::size_t(t)], s == t, h, apart);
        }
      }
    }
}

void ClothState::meet_edges(const FoldEdges& ours, const FoldTriangles& bounds, const FoldEdges& theirs, bool same,
                            float h, float apart) {
  const auto speed = [&](std::uint32_t i) { return fold_records[2 * std::size_t(i) + 1].vector(); };
  const float look = math::min(2 * apart, 0.6f * mean_edge), widest = apart + look;  // m, ahead at most; and in all
  const int count = solver.kernels().meet_edges(ours, bounds, theirs, same, widest, edge_hits.data());
  for (int hit = 0; hit < count; ++hit) {
    const auto [i, k] = edge_hits[std::size_t(hit)];
    const auto p = std::uint32_t(ours.end[0][i]), q = std::uint32_t(ours.end[1][i]),
               r = std::uint32_t(theirs.end[0][k]), s = std::uint32_t(theirs.end[1][k]);
    if ((tangled[p] | tangled[q] | tangled[r] | tangled[s]) != 0) continue;
    const Vec3f a = fold_place(p), c = fold_place(r), u = fold_place(q) - a, v = fold_place(s) - c, w = a - c;
    const float uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), across = uu * vv - uv * uv, uw = dot(u, w),
                vw = dot(v, w), share = (uv * vw - vv * uw) / across, other = (uu * vw - uv * uw) / across;
    const Vec3f way = w + share * u - other * v;
    const float gap = length(way);
    if (!(gap > 1e-3f * apart)) continue;
    const Vec3f normal = (1 / gap) * way;
    const Vec3f velocity = (1 - share) * speed(p) + share * speed(q) - (1 - other) * speed(r) - other * speed(s);
    if (gap > apart + math::min(2 * h * length(velocity) + apart, look)) continue;
    const float weight = math::square(1 - share) * lightness(p) + math::square(share) * lightness(q) +
                         math::square(1 - other) * lightness(r) + math::square(other) * lightness(s);
    if (!(weight > 0)) continue;
    const float free = gap - apart;
    edge_pairs.push_back({{p, q, r, s},
                          {1 - share, share, other - 1, -other},
                          normal,
                          free >= 0 ? -free / h : math::min(-0.2f * free / h, 0.5f),
                          1 / weight});
  }
}

void ClothState::push_edges() {
  for (const ClothEdgePair& pair : edge_pairs) {
    Vec3f relative{};
    for (int k = 0; k < 4; ++k) relative += pair.share[k] * velocity[pair.vertex[k]];
    const Vec3f impulse = fold_impulse(relative, pair.normal, pair.wanted, pair.mass);
    if (impulse == Vec3f{}) continue;
    for (int k = 0; k < 4; ++k) velocity[pair.vertex[k]] += (pair.share[k] * lightness(pair.vertex[k])) * impulse;
  }
}

}  // namespace carom::particles::detail
