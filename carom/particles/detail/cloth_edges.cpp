// Folds of a cloth that meet edge to edge: where threads cross, and where no vertex stands above a triangle.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

namespace {

constexpr float flat_enough = 0.05f;  // sine: edges that lie so nearly along each other are left to the vertices

bool apart_from(const FoldTriangles& a, const FoldTriangles& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return true;
  return false;
}

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
    for (int lane = 0; lane < fold_lanes; ++lane) {
      if (tile.triangle[lane] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const auto p = std::uint32_t(tile.corner[k][lane]), q = std::uint32_t(tile.corner[(k + 1) % 3][lane]);
        std::vector<std::uint32_t>& known = ends[std::min(p, q)];
        if (std::find(known.begin(), known.end(), std::max(p, q)) == known.end()) {
          known.push_back(std::max(p, q));
          own.end[own.count][0] = std::min(p, q);
          own.end[own.count++][1] = std::max(p, q);
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

void ClothState::find_edge_pairs(float h, float apart) {
  edge_pairs.clear();
  const int count = int(fold_triangles.size());
  for (int t = 0; t < count; ++t) {
    const FoldTriangles& tile = fold_triangles[std::size_t(t)];
    FoldCone& cone = fold_cones[std::size_t(t)];
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
  // Sixteen tiles that follow each other lie near each other: their bounds are looked at first.
  constexpr int run = 16;
  const int runs = (count + run - 1) / run;
  fold_runs.assign(std::size_t(runs), FoldRun{});
  for (int t = 0; t < count; ++t)
    for (int axis = 0; axis < 3; ++axis) {
      FoldRun& r = fold_runs[std::size_t(t / run)];
      r.low[axis] = math::min(r.low[axis], fold_triangles[std::size_t(t)].low[axis]);
      r.high[axis] = math::max(r.high[axis], fold_triangles[std::size_t(t)].high[axis]);
    }
  for (int a = 0; a < runs; ++a)
    for (int b = a; b < runs; ++b) {
      const FoldRun &ra = fold_runs[std::size_t(a)], &rb = fold_runs[std::size_t(b)];
      bool far = false;
      for (int axis = 0; axis < 3; ++axis) far |= ra.high[axis] < rb.low[axis] || rb.high[axis] < ra.low[axis];
      if (far) continue;
      for (int s = a * run; s < math::min((a + 1) * run, count); ++s)
        for (int t = a == b ? s : b * run; t < math::min((b + 1) * run, count); ++t) {
          const auto first = std::size_t(s), second = std::size_t(t);
          if (s != t && apart_from(fold_triangles[first], fold_triangles[second])) continue;
          const std::vector<int>& beside = fold_beside[first];
          if (bends_little(fold_cones[first], fold_cones[second]) &&
              (s == t || std::binary_search(beside.begin(), beside.end(), t)))
            continue;
          meet_edges(fold_edges[first], fold_triangles[second], fold_edges[second], s == t, h, apart);
        }
    }
}

void ClothState::meet_edges(const FoldEdges& ours, const FoldTriangles& bounds, const FoldEdges& theirs, bool same,
                            float h, float apart) {
  const auto speed = [&](std::uint32_t i) { return fold_records[2 * std::size_t(i) + 1].vector(); };
  const float look = math::min(2 * apart, 0.6f * mean_edge), widest = apart + look;  // m, ahead at most; and in all
  for (int i = 0; i < ours.count; ++i) {
    const std::uint32_t p = ours.end[i][0], q = ours.end[i][1];
    const Vec3f a = fold_place(p), b = fold_place(q), low = min(a, b), high = max(a, b);
    bool far = false;
    for (int axis = 0; axis < 3; ++axis) far |= high[axis] < bounds.low[axis] || bounds.high[axis] < low[axis];
    if (far) continue;
    const Vec3f u = b - a;
    const float uu = dot(u, u);
    for (int k = same ? i + 1 : 0; k < theirs.count; ++k) {
      const std::uint32_t r = theirs.end[k][0], s = theirs.end[k][1];
      const Vec3f c = fold_place(r), d = fold_place(s);
      far = false;
      for (int axis = 0; axis < 3; ++axis)
        far |= math::max(c[axis], d[axis]) < low[axis] - widest || high[axis] + widest < math::min(c[axis], d[axis]);
      if (far || p == r || p == s || q == r || q == s) continue;
      // Where the two lines are nearest, if that lies on both edges.
      const Vec3f v = d - c, w = a - c;
      const float vv = dot(v, v), uv = dot(u, v), across = uu * vv - uv * uv;
      if (!(across > flat_enough * flat_enough * uu * vv)) continue;
      const float uw = dot(u, w), vw = dot(v, w), share = (uv * vw - vv * uw) / across,
                  other = (uu * vw - uv * uw) / across;
      if (share < 0 || share > 1 || other < 0 || other > 1) continue;
      const Vec3f way = w + share * u - other * v;
      const float gap = length(way);
      if (!(gap > 1e-3f * apart)) continue;
      const Vec3f normal = (1 / gap) * way;
      const Vec3f velocity = (1 - share) * speed(p) + share * speed(q) - (1 - other) * speed(r) - other * speed(s);
      if (gap > apart + math::min(2 * h * length(velocity) + apart, look)) continue;
      if ((tangled[p] | tangled[q] | tangled[r] | tangled[s]) != 0) continue;
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
