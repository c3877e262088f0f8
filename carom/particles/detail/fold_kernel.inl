// Vertices of a cloth above and below its triangles, a tile at a time; and the table of all kernels, for this is the
// last of the three files that make them.

namespace carom::particles::detail::CAROM_SOFT_NAMESPACE {
namespace {

static_assert(fold_lanes == soft_lanes);

CAROM_SIMD_INLINE void store(const V& v, float (&to)[3][fold_lanes], int lane) {
  v.x.store_aligned(to[0] + lane);
  v.y.store_aligned(to[1] + lane);
  v.z.store_aligned(to[2] + lane);
}
CAROM_SIMD_INLINE F least(F a, F b, F c) { return math::min(a, math::min(b, c)); }
CAROM_SIMD_INLINE F greatest(F a, F b, F c) { return math::max(a, math::max(b, c)); }

/// Planes, margins and bounds of tiles of triangles. `records`: by vertex, place and velocity, four floats each.
void lay_folds(FoldTriangles* tiles, int count, const float* records, const FoldMeasures& measures) {
  for (FoldTriangles* tile = tiles; tile != tiles + count; ++tile) {
    alignas(64) float bounds[2][3][fold_lanes];
    for (int lane = 0; lane < fold_lanes; lane += width) {
      F a[8], b[8], d[8];
      math::gather_rows<8, width>(records, tile->corner[0] + lane, a);
      math::gather_rows<8, width>(records, tile->corner[1] + lane, b);
      math::gather_rows<8, width>(records, tile->corner[2] + lane, d);
      const V origin{a[0], a[1], a[2]}, u = V{b[0], b[1], b[2]} - origin, v = V{d[0], d[1], d[2]} - origin;
      const V own{a[4], a[5], a[6]}, du = V{b[4], b[5], b[6]} - own, dv = V{d[4], d[5], d[6]} - own;
      const F speed = math::sqrt(math::max(dot(du, du), dot(dv, dv)));
      const F margin = F::splat(measures.apart) + math::min(F::splat(measures.ahead) * speed + F::splat(measures.apart),
                                                            F::splat(measures.margin));
      const V n = cross(u, v);
      const F square = dot(n, n), zero = F::zero();
      const auto flat = square > F::splat(1e-24f);
      const F inverse = F::splat(1) / math::select(flat, square, F::splat(1));
      store(origin, tile->origin, lane);
      store(math::sqrt(inverse) * n, tile->normal, lane);
      store(inverse * cross(v, n), tile->second, lane);
      store(inverse * cross(n, u), tile->third, lane);
      const V low{least(zero, u.x, v.x), least(zero, u.y, v.y), least(zero, u.z, v.z)};
      const V high{greatest(zero, u.x, v.x), greatest(zero, u.y, v.y), greatest(zero, u.z, v.z)};
      const V extent = high - low;
      const auto is = (math::WideInt<width>::load(tile->triangle + lane) > math::WideInt<width>::splat(-1)) & flat &
                      (greatest(extent.x, extent.y, extent.z) < F::splat(measures.longest));
      math::select(is, margin, F::splat(-1)).store_aligned(tile->margin + lane);
      const V most{margin, margin, margin}, none{F::splat(1e30f), F::splat(1e30f), F::splat(1e30f)};
      const V from = origin + low - most, to = origin + high + most;
      store({math::select(is, from.x, none.x), math::select(is, from.y, none.y), math::select(is, from.z, none.z)},
            bounds[0], lane);
      store({math::select(is, to.x, -none.x), math::select(is, to.y, -none.y), math::select(is, to.z, -none.z)},
            bounds[1], lane);
    }
    for (int k = 0; k < 3; ++k) {
      tile->low[k] = bounds[0][k][0];
      tile->high[k] = bounds[1][k][0];
      for (int lane = 1; lane < fold_lanes; ++lane) {
        tile->low[k] = bounds[0][k][lane] < tile->low[k] ? bounds[0][k][lane] : tile->low[k];
        tile->high[k] = bounds[1][k][lane] > tile->high[k] ? bounds[1][k][lane] : tile->high[k];
      }
    }
  }
}

/// Which of sixteen triangles a point stands above or below, within their margins.
CAROM_SIMD_INLINE std::uint32_t above(const FoldTriangles& tile, int vertex, float px, float py, float pz) {
  using I = math::WideInt<width>;
  std::uint32_t hits = 0;
  const I own = I::splat(vertex);
  for (int lane = 0; lane < fold_lanes; lane += width) {
    const V way = V{F::splat(px), F::splat(py), F::splat(pz)} - load(tile.origin[0], lane);
    const F height = dot(load(tile.normal[0], lane), way), beta = dot(load(tile.second[0], lane), way),
            gamma = dot(load(tile.third[0], lane), way), low = F::splat(-0.02f);
    const auto is = (math::abs(height) < F::load_aligned(tile.margin + lane)) & (low <= beta) & (low <= gamma) &
                    (beta + gamma <= F::splat(1.02f)) & (I::load(tile.corner[0] + lane) != own) &
                    (I::load(tile.corner[1] + lane) != own) & (I::load(tile.corner[2] + lane) != own);
    hits |= math::bitmask(is) << lane;
  }
  return hits;
}

/// Bounds, the same in every lane.
struct Bounds {
  V low, high;
  CAROM_SIMD_INLINE Bounds(const float* from, const float* to)
      : low{F::splat(from[0]), F::splat(from[1]), F::splat(from[2])},
        high{F::splat(to[0]), F::splat(to[1]), F::splat(to[2])} {}
  CAROM_SIMD_INLINE auto meets(const V& from, const V& to) const {
    return (low.x <= to.x) & (from.x <= high.x) & (low.y <= to.y) & (from.y <= high.y) & (low.z <= to.z) &
           (from.z <= high.z);
  }
  /// Sixteen bounds.
  CAROM_SIMD_INLINE std::uint32_t meets(const float* from, const float* to) const {
    std::uint32_t mask = 0;
    for (int lane = 0; lane < fold_lanes; lane += width)
      mask |= math::bitmask(meets(load(from, lane), load(to, lane))) << lane;
    return mask;
  }
};

/// Vertices of a group above or below triangles of a tile: at most 16³. Returns how many.
int meet_folds(const FoldTriangles& tile, const FoldVertices& group, FoldHit* hits) {
  const Bounds bounds(tile.low, tile.high);
  int count = 0;
  for (std::uint32_t near = bounds.meets(group.low[0], group.high[0]); near != 0; near &= near - 1) {
    const int k = __builtin_ctz(near);
    const auto& at = group.at[k];
    for (std::uint32_t inside = bounds.meets(at[0], at[0]); inside != 0; inside &= inside - 1) {
      const int i = __builtin_ctz(inside), vertex = group.vertex[k][i];
      for (std::uint32_t over = above(tile, vertex, at[0][i], at[1][i], at[2][i]); over != 0; over &= over - 1)
        hits[count++] = {vertex, tile.triangle[__builtin_ctz(over)]};
    }
  }
  return count;
}

std::uint32_t meet_run(const FoldRun& run, const FoldTriangles& tile) {
  return Bounds(tile.low, tile.high).meets(run.low[0], run.high[0]);
}

CAROM_SIMD_INLINE V load_edges(const float (&of)[3][FoldEdges::most], int k) {
  return {F::load_aligned(of[0] + k), F::load_aligned(of[1] + k), F::load_aligned(of[2] + k)};
}
CAROM_SIMD_INLINE V least(const V& a, const V& b) {
  return {math::min(a.x, b.x), math::min(a.y, b.y), math::min(a.z, b.z)};
}
CAROM_SIMD_INLINE V greatest(const V& a, const V& b) {
  return {math::max(a.x, b.x), math::max(a.y, b.y), math::max(a.z, b.z)};
}

void lay_edges(FoldEdges* tiles, int count, const float* records) {
  for (FoldEdges* tile = tiles; tile != tiles + count; ++tile)
    for (int k = 0; k < tile->count; k += width) {
      F a[8], b[8];
      math::gather_rows<8, width>(records, tile->end[0] + k, a);
      math::gather_rows<8, width>(records, tile->end[1] + k, b);
      for (int axis = 0; axis < 3; ++axis) {
        a[axis].store_aligned(tile->from[axis] + k);
        b[axis].store_aligned(tile->to[axis] + k);
      }
    }
}

int meet_edges(const FoldEdges& ours, const FoldTriangles& triangles, const FoldEdges& theirs, bool same, float widest,
               EdgeHit* hits) {
  using I = math::WideInt<width>;
  const Bounds bounds(triangles.low, triangles.high);
  int count = 0;
  for (int first = 0; first < ours.count; first += width) {
    const V from = load_edges(ours.from, first), to = load_edges(ours.to, first);
    for (std::uint32_t near = math::bitmask(bounds.meets(least(from, to), greatest(from, to))); near != 0;
         near &= near - 1) {
      const int i = first + __builtin_ctz(near);
      const float begin[3] = {ours.from[0][i], ours.from[1][i], ours.from[2][i]},
                  end[3] = {ours.to[0][i], ours.to[1][i], ours.to[2][i]};
      float low[3], high[3];
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = (begin[axis] < end[axis] ? begin[axis] : end[axis]) - widest;
        high[axis] = (begin[axis] < end[axis] ? end[axis] : begin[axis]) + widest;
      }
      const Bounds around(low, high);
      const V a{F::splat(begin[0]), F::splat(begin[1]), F::splat(begin[2])},
          u = V{F::splat(end[0]), F::splat(end[1]), F::splat(end[2])} - a;
      const F uu = dot(u, u), zero = F::zero(), one = F::splat(1);
      const I p = I::splat(ours.end[0][i]), q = I::splat(ours.end[1][i]);
      for (int k = same ? (i + 1) / width * width : 0; k < theirs.count; k += width) {
        const V c = load_edges(theirs.from, k), d = load_edges(theirs.to, k);
        auto meet = around.meets(least(c, d), greatest(c, d));
        if (math::bitmask(meet) == 0) continue;
        // Where the two lines are nearest, if that lies on both edges.
        const V v = d - c, w = a - c;
        const F vv = dot(v, v), uv = dot(u, v), across = uu * vv - uv * uv, uw = dot(u, w), vw = dot(v, w);
        const auto cross = across > F::splat(FoldEdges::least_sine * FoldEdges::least_sine) * uu * vv;
        const F safe = math::select(cross, across, one), share = (uv * vw - vv * uw) / safe,
                other = (uu * vw - uv * uw) / safe;
        const V way = w + share * u - other * v;
        const I r = I::load(theirs.end[0] + k), s = I::load(theirs.end[1] + k);
        meet = meet & cross & (zero <= share) & (share <= one) & (zero <= other) & (other <= one) &
               (dot(way, way) <= F::splat(1.001f * widest * widest)) & (p != r) & (p != s) & (q != r) & (q != s);
        std::uint32_t mask = math::bitmask(meet);
        if (same && k <= i) mask &= ~((2u << (i - k)) - 1);
        for (; mask != 0; mask &= mask - 1) hits[count++] = {i, k + __builtin_ctz(mask)};
      }
    }
  }
  return count;
}

}  // namespace

const SoftKernels kernels = {fill,         start,     up,         down,      go,         strain,  join_edges,
                             join_corners, lay_folds, meet_folds, lay_edges, meet_edges, meet_run};

}  // namespace carom::particles::detail::CAROM_SOFT_NAMESPACE
