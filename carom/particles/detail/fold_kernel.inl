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

/// Vertices of a group above or below triangles of a tile: at most 16³. Returns how many.
int meet_folds(const FoldTriangles& tile, const FoldVertices& group, FoldHit* hits) {
  const V low{F::splat(tile.low[0]), F::splat(tile.low[1]), F::splat(tile.low[2])};
  const V high{F::splat(tile.high[0]), F::splat(tile.high[1]), F::splat(tile.high[2])};
  const auto meets = [&](const float* from, const float* to) __attribute__((always_inline)) {
    std::uint32_t mask = 0;
    for (int lane = 0; lane < fold_lanes; lane += width) {
      const V a = load(from, lane), b = load(to, lane);
      mask |= math::bitmask((low.x <= b.x) & (a.x <= high.x) & (low.y <= b.y) & (a.y <= high.y) & (low.z <= b.z) &
                            (a.z <= high.z))
              << lane;
    }
    return mask;
  };
  int count = 0;
  for (std::uint32_t near = meets(group.low[0], group.high[0]); near != 0; near &= near - 1) {
    const int k = __builtin_ctz(near);
    const auto& at = group.at[k];
    for (std::uint32_t inside = meets(at[0], at[0]); inside != 0; inside &= inside - 1) {
      const int i = __builtin_ctz(inside), vertex = group.vertex[k][i];
      for (std::uint32_t over = above(tile, vertex, at[0][i], at[1][i], at[2][i]); over != 0; over &= over - 1)
        hits[count++] = {vertex, tile.triangle[__builtin_ctz(over)]};
    }
  }
  return count;
}

}  // namespace

const SoftKernels kernels = {fill, start, up, down, go, strain, join_edges, join_corners, lay_folds, meet_folds};

}  // namespace carom::particles::detail::CAROM_SOFT_NAMESPACE
