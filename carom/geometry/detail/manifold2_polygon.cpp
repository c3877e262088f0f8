// Two polygons: the same as polygons() of manifold2.cpp, with the edges of a polygon side by side in lanes.
#include "carom/geometry/detail/polygon_lanes.h"
#include "carom/geometry/detail/rounded2.h"
#include "carom/geometry/manifold.h"

namespace carom::geometry::detail {
namespace polygon_pair {

/// A polygon in the frame of A, its numbers one by one beside the lanes.
template <int N>
struct Sides {
  Vectors<N> v, n;
  float vx[4 * N], vy[4 * N], nx[4 * N], ny[4 * N];
  int count;

  CAROM_SIMD_INLINE explicit Sides(const Polygon& p) : count(p.count) {
    v.load(p.vertices, p.count);
    n.load(p.normals, p.count);
  }
  /// Before the polygon is placed.
  CAROM_SIMD_INLINE float size(const Polygon& p) const { return size_of(v, n, p); }
  CAROM_SIMD_INLINE void spread() {
    for (int k = 0; k < N; ++k) {
      v.x[k].store(vx + 4 * k), v.y[k].store(vy + 4 * k);
      n.x[k].store(nx + 4 * k), n.y[k].store(ny + 4 * k);
    }
  }
  CAROM_SIMD_INLINE Vec2f corner(int i) const { return {vx[i], vy[i]}; }
  CAROM_SIMD_INLINE Vec2f normal(int i) const { return {nx[i], ny[i]}; }
  CAROM_SIMD_INLINE int next(int i) const { return i + 1 < count ? i + 1 : 0; }
};

/// Where along each normal of `a` the corners of `b` begin.
template <int N, int M>
CAROM_SIMD_INLINE EdgeAxis separations(const Sides<N>& a, const Sides<M>& b, Lanes (&s)[N]) {
  Lanes greatest = Lanes::splat(-3.4e38f);
  for (int k = 0; k < N; ++k) {
    Lanes least = Lanes::splat(3.4e38f);
    for (int j = 0; j < 4 * M; ++j)
      least = min(least, a.n.x[k] * Lanes::splat(b.vx[j]) + a.n.y[k] * Lanes::splat(b.vy[j]));
    s[k] = least - (a.n.x[k] * a.v.x[k] + a.n.y[k] * a.v.y[k]);
    greatest = max(greatest, s[k]);
  }
  const float most = greatest_of(greatest);
  return {place_of<N>(s, most), most};
}

/// One side of grazes() of manifold2.cpp: has r an edge across n, along which they hardly overlap, level with one of s?
template <int N, int M>
bool level_rows(const Sides<N>& r, const Lanes (&s_of_r)[N], const Sides<M>& s, const Vec2f& n, float tolerance) {
  std::uint32_t edges = 0;
  for (int k = 0; k < N; ++k) {
    const auto across = abs(r.n.along(k, n)) <= Lanes::splat(0.02f), level = s_of_r[k] > Lanes::splat(-tolerance);
    edges |= bitmask(across & level) << (4 * k);
  }
  for (; edges != 0; edges &= edges - 1)
    if (s.n.least_along(r.normal(__builtin_ctz(edges))) < -0.9998f) return true;
  return false;
}

/// What is left once the axis is known: r has the edge e. False if the nearest features may be two corners.
template <int N, int M>
CAROM_SIMD_INLINE bool contacts_along(const Sides<N>& r, const Sides<M>& s, const EdgeAxis& axis, float radius_r,
                                      float radius_s, float slack, bool of_b, float margin, Manifold2& out) {
  const Vec2f n = r.normal(axis.edge), t{-n.y, n.x}, start = r.corner(axis.edge);
  const float length_r = dot(t, r.corner(r.next(axis.edge)) - start);
  const int corner = lowest_along(s.v, n);
  if (axis.separation > 1e-4f * slack) {
    const float at = dot(t, s.corner(corner) - start);
    if (at < 0 || at > length_r) return false;
  }
  const int f = lowest_along(s.n, n);
  clip_edge({n, start, length_r, axis.edge, radius_r}, {s.corner(s.next(f)), s.corner(f), f, radius_s}, of_b, margin,
            out);
  // The deepest corner may stand beyond the end of the edge.
  const float deepest = axis.separation - radius_r - radius_s;
  float least = out.count > 0 ? out.points[0].separation : 3.4e38f;
  if (out.count > 1) least = min(least, out.points[1].separation);
  if (deepest > margin || least <= deepest + 0.02f * abs(deepest) + slack) return true;
  out.normal = of_b ? -n : n;
  const int place = out.count < 2 ? out.count++ : (out.points[0].separation > out.points[1].separation ? 0 : 1);
  out.points[place] = {s.corner(corner) + n * (0.5f * (radius_r - radius_s - axis.separation)), deepest,
                       1u << 26 | (of_b ? 1u << 24 : 0u) | std::uint32_t(corner)};
  return true;
}

/// How far the corners of s, which `frame` places, are from edge e of r along its normal.
template <int M>
CAROM_SIMD_INLINE float separation_of(const Polygon& r, int e, const Polygon& s, const Transform2f& frame) {
  Vectors<M> v;
  v.load(s.vertices, s.count);
  const Vec2f n = r.normals[e];
  return v.least_along(inverse_rotate(frame.q, n)) + dot(n, frame.p - r.vertices[e]);
}

template <int N, int M>
bool collide(const Polygon& pa, const Polygon& pb, const Transform2f& x, float margin, PairCache& cache,
             Manifold2& out) {
  const float radius = pa.radius + pb.radius;
  const auto apart = [&](float separation, bool of_b, int edge) {
    out.points[0].separation = separation - radius;
    if (!(out.points[0].separation > margin)) return false;
    cache.kind = of_b ? 2 : 1, cache.a = std::uint8_t(edge);
    out.normal = of_b ? -rotate(x.q, pb.normals[edge]) : pa.normals[edge];
    return true;
  };
  // The edge that parted them last is asked first.
  if (cache.kind == 1 && cache.a < pa.count) {
    if (apart(separation_of<M>(pa, cache.a, pb, x), false, cache.a)) return true;
  } else if (cache.kind == 2 && cache.a < pb.count) {
    if (apart(separation_of<N>(pb, cache.a, pa, inverse(x)), true, cache.a)) return true;
  }
  Sides<N> a(pa);
  Sides<M> b(pb);
  const float small = max(min(a.size(pa), b.size(pb)), 0.0f), slack = 1e-3f * small;
  b.v.turn(x.q), b.v.move(x.p);
  b.n.turn(x.q);
  a.spread(), b.spread();
  Lanes sa[N], sb[M];
  const EdgeAxis ea = separations(a, b, sa);
  if (apart(ea.separation, false, ea.edge)) return true;
  const EdgeAxis eb = separations(b, a, sb);
  if (apart(eb.separation, true, eb.edge)) return true;
  const bool of_b = eb.separation > ea.separation + (cache.kind == 2 ? -slack : slack);
  const EdgeAxis& axis = of_b ? eb : ea;
  const Vec2f n = of_b ? b.normal(axis.edge) : a.normal(axis.edge);
  const float tolerance = min(0.02f * small, 0.005f);
  const bool grazing = radius == 0 && axis.separation > -tolerance &&
                       (level_rows(a, sa, b, n, tolerance) || level_rows(b, sb, a, n, tolerance));
  if (!grazing && !(of_b ? contacts_along(b, a, axis, pb.radius, pa.radius, slack, true, margin, out)
                         : contacts_along(a, b, axis, pa.radius, pb.radius, slack, false, margin, out)))
    return false;
  cache.kind = of_b ? 2 : 1;
  cache.a = std::uint8_t(axis.edge);
  return true;
}

}  // namespace polygon_pair

bool collide_polygons(const Polygon& a, const Polygon& b, const Transform2f& x, float margin, PairCache& cache,
                      Manifold2& out) {
  using polygon_pair::collide;
  if (a.count <= 4)
    return b.count <= 4 ? collide<1, 1>(a, b, x, margin, cache, out) : collide<1, 2>(a, b, x, margin, cache, out);
  return b.count <= 4 ? collide<2, 1>(a, b, x, margin, cache, out) : collide<2, 2>(a, b, x, margin, cache, out);
}

}  // namespace carom::geometry::detail
