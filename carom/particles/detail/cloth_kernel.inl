// Strains of a cloth's triangles, and the system's blocks and forces, sixteen at a time.

namespace carom::particles::detail::CAROM_SOFT_NAMESPACE {
namespace {

static_assert(cloth_lanes == soft_lanes);

/// A corner's place from the first corner's, each in two parts.
CAROM_SIMD_INLINE V way(const F (&to)[cloth_record], const F (&from)[cloth_record]) {
  return V{to[0] - from[0], to[1] - from[1], to[2] - from[2]} + V{to[4] - from[4], to[5] - from[5], to[6] - from[6]};
}
CAROM_SIMD_INLINE void write_strain(ClothStrain* out, int part, const V& v, F last) {
  float* rows[width];
  math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = reinterpret_cast<float*>(out + i) + 4 * part;
  });
  const F r[4] = {v.x, v.y, v.z, last};
  math::scatter_records<width>(rows, r);
}

void strain(const ClothTile* tiles, int from, int to, const float* records, const ClothLaw& law, ClothStrain* out) {
  const F zero = F::zero(), half = F::splat(0.5f), one = F::splat(1);
  for (int k = from; k < to; ++k)
    for (int lane = 0; lane < cloth_lanes; lane += width) {
      const ClothTile& tile = tiles[k];
      F a[cloth_record], b[cloth_record], c[cloth_record];
      math::gather_rows<cloth_record, width>(records, tile.corner[0] + lane, a);
      math::gather_rows<cloth_record, width>(records, tile.corner[1] + lane, b);
      math::gather_rows<cloth_record, width>(records, tile.corner[2] + lane, c);
      const V d1 = way(b, a), d2 = way(c, a);
      const V along = F::load_aligned(tile.u[1] + lane) * d1 + F::load_aligned(tile.u[2] + lane) * d2;
      const V across = F::load_aligned(tile.v[1] + lane) * d1 + F::load_aligned(tile.v[2] + lane) * d2;
      const F e1 = half * (dot(along, along) - one), e2 = half * (dot(across, across) - one);
      const F s1 = F::splat(law.warp) * e1 + F::splat(law.both) * e2;
      const F s2 = F::splat(law.both) * e1 + F::splat(law.weft) * e2;
      const F s3 = F::splat(law.shear) * dot(along, across);
      // The part of the stress that pulls: only that stiffens, and the system stays positive definite.
      const F mean = half * (s1 + s2), spread = math::sqrt(half * half * (s1 - s2) * (s1 - s2) + s3 * s3);
      const F high = mean + spread, low = mean - spread;
      const auto pulls = low >= zero, mixed = (low < zero) & (high > zero);
      const F part = high / math::select(mixed, high - low, one);
      const auto pull = [&](F all, F some) __attribute__((always_inline)) {
        return math::select(pulls, all, math::select(mixed, part * some, zero));
      };
      ClothStrain* const at = out + std::ptrdiff_t(k) * cloth_lanes + lane;
      write_strain(at, 0, along, s1);
      write_strain(at, 1, across, s2);
      write_strain(at, 2, {pull(s1, s1 - low), pull(s2, s2 - low), pull(s3, s3)}, s3);

      const V area = cross(d1, d2);
      const F twice = math::sqrt(dot(area, area));
      const auto is = twice > F::splat(1e-12f);
      const V n = (one / math::select(is, twice, one)) * area;
      const V air = load(tile.air[0], lane) -
                    F::splat(1.0f / 3) * (V{a[8], a[9], a[10]} + V{b[8], b[9], b[10]} + V{c[8], c[9], c[10]});
      const F through = dot(air, n), third = math::select(is, twice, zero) * F::splat(1.0f / 6);
      const V slide = air - through * n;
      const F press = F::splat(law.press) * math::abs(through) * third;
      const F rub = F::splat(law.rub) * math::sqrt(dot(slide, slide)) * third;
      write_strain(at, 3, (press * through) * n + rub * slide, press + press - rub);
      write_strain(at, 4, n, rub);
    }
}

/// ½ area (c11 e1² + 2 c12 e1 e2 + c22 e2² + shear e3²), derived by two corners: columns.
struct Stiffness {
  V along, across;
  F uu, uv, vu, vv, pull;

  CAROM_SIMD_INLINE Stiffness(const ClothLaw& law, const F* r, F area, F ua, F va, F ub, F vb)
      : along{r[0], r[1], r[2]}, across{r[4], r[5], r[6]} {
    const F s = F::splat(law.weight) * area, shear = s * F::splat(law.shear), both = s * F::splat(law.both);
    uu = s * F::splat(law.warp) * ua * ub + shear * va * vb;
    uv = both * ua * vb + shear * va * ub;
    vu = both * va * ub + shear * ua * vb;
    vv = s * F::splat(law.weft) * va * vb + shear * ua * ub;
    pull = s * ((r[8] * ua + r[10] * va) * ub + (r[9] * va + r[10] * ua) * vb);
  }
  CAROM_SIMD_INLINE Block block() const {
    const V p = uu * along + uv * across, q = vu * along + vv * across;
    Block m{p.x * along + q.x * across, p.y * along + q.y * across, p.z * along + q.z * across};
    m.x.x = m.x.x + pull;
    m.y.y = m.y.y + pull;
    m.z.z = m.z.z + pull;
    return m;
  }
};
CAROM_SIMD_INLINE Block operator+(const Block& a, const Block& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CAROM_SIMD_INLINE void write_blocks(const Block& m, float* blocks, const int* slot) {
  const V columns[3] = {m.x, m.y, m.z};
  for (int k = 0; k < 3; ++k) {
    float* rows[width];
    math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
      constexpr int i = decltype(lane)::value;
      rows[i] = blocks + 12 * std::ptrdiff_t(slot[i]) + 4 * k;
    });
    const F r[4] = {columns[k].x, columns[k].y, columns[k].z, F::zero()};
    math::scatter_records<width>(rows, r);
  }
}
CAROM_SIMD_INLINE Block diagonal_block(F d) {
  const F zero = F::zero();
  return {{d, zero, zero}, {zero, d, zero}, {zero, zero, d}};
}

void join_edges(const ClothEdges* edges, int from, int to, const ClothSide* sides, const ClothStrain* strains,
                const ClothLaw& law, float* blocks) {
  for (const ClothEdges* edge = edges + from; edge != edges + to; ++edge)
    for (int lane = 0; lane < cloth_lanes; lane += width) {
      Block sum = diagonal_block(F::splat(law.weight) * F::load_aligned(edge->near + lane));
      for (int k = edge->first; k < edge->last; ++k) {
        const ClothSide& side = sides[k];
        F r[12];
        const float* rows[width];
        math::simd_detail::unrolled<width>([&](auto l) __attribute__((always_inline)) {
          constexpr int i = decltype(l)::value;
          rows[i] = reinterpret_cast<const float*>(strains + side.triangle[lane + i]);
        });
        math::gather_rows<12, width>(rows, r);
        const Stiffness stiffness(law, r, F::load_aligned(side.area + lane), F::load_aligned(side.ua + lane),
                                  F::load_aligned(side.va + lane), F::load_aligned(side.ub + lane),
                                  F::load_aligned(side.vb + lane));
        sum = sum + stiffness.block();
      }
      write_blocks(sum, blocks, edge->slot[0] + lane);
      write_blocks({{sum.x.x, sum.y.x, sum.z.x}, {sum.x.y, sum.y.y, sum.z.y}, {sum.x.z, sum.y.z, sum.z.z}}, blocks,
                   edge->slot[1] + lane);
    }
}

void join_corners(const ClothCorners* corners, int from, int to, const ClothSide* sides, const ClothStrain* strains,
                  const ClothLaw& law, float* blocks, float* out) {
  for (int tile = from; tile < to; ++tile)
    for (int lane = 0; lane < cloth_lanes; lane += width) {
      const ClothCorners& corner = corners[tile];
      const F zero = F::zero();
      Block sum = diagonal_block(F::splat(law.weight) * F::load_aligned(corner.near + lane));
      V force{zero, zero, zero}, squares = force, products = force;
      F rub = zero;
      for (int k = corner.first; k < corner.last; ++k) {
        const ClothSide& side = sides[k];
        F r[cloth_strain];
        math::gather_rows<cloth_strain, width>(reinterpret_cast<const float*>(strains), side.triangle + lane, r);
        const F area = F::load_aligned(side.area + lane), u = F::load_aligned(side.ua + lane),
                v = F::load_aligned(side.va + lane);
        const Stiffness stiffness(law, r, area, u, v, u, v);
        sum = sum + stiffness.block();
        force = force + V{r[12], r[13], r[14]} - (area * (r[3] * u + r[11] * v)) * stiffness.along -
                (area * (r[7] * v + r[11] * u)) * stiffness.across;
        const V n{r[16], r[17], r[18]}, braked = r[15] * n;
        squares = squares + V{braked.x * n.x, braked.y * n.y, braked.z * n.z};
        products = products + V{braked.x * n.y, braked.y * n.z, braked.z * n.x};
        rub = rub + r[19];
      }
      write_blocks(sum, blocks, corner.slot + lane);
      const V parts[3] = {force, squares, products};
      for (int k = 0; k < 3; ++k) {
        float* rows[width];
        math::simd_detail::unrolled<width>([&](auto l) __attribute__((always_inline)) {
          constexpr int i = decltype(l)::value;
          rows[i] = out + cloth_row * (std::ptrdiff_t(tile) * cloth_lanes + lane + i) + 4 * k;
        });
        const F r[4] = {parts[k].x, parts[k].y, parts[k].z, k == 0 ? rub : zero};
        math::scatter_records<width>(rows, r);
      }
    }
}

}  // namespace
}  // namespace carom::particles::detail::CAROM_SOFT_NAMESPACE
