// Pairs of convex shapes of the plane, a pair in each lane, compiled once for each instruction set:
// CAROM_PAIRS_NAMESPACE, CAROM_PAIRS_WIDTH. The same as manifold2_polygon.cpp and manifold2_round.cpp, operation by
// operation, so that it does not matter which of the two a pair is given to.

namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE {

constexpr int width = CAROM_PAIRS_WIDTH;
using F = math::WideFloat<width>;
using Int = math::WideInt<width>;
using Mask = math::WideMask<width>;

struct Wide2 {
  F x, y;
  CAROM_SIMD_INLINE friend Wide2 operator+(const Wide2& a, const Wide2& b) { return {a.x + b.x, a.y + b.y}; }
  CAROM_SIMD_INLINE friend Wide2 operator-(const Wide2& a, const Wide2& b) { return {a.x - b.x, a.y - b.y}; }
  CAROM_SIMD_INLINE friend Wide2 operator*(const Wide2& a, F s) { return {a.x * s, a.y * s}; }
};
CAROM_SIMD_INLINE Wide2 operator-(const Wide2& a) { return {-a.x, -a.y}; }
CAROM_SIMD_INLINE Int keep(Mask m, Int a) { return math::select(m, a, Int::zero()); }
CAROM_SIMD_INLINE F keep(Mask m, F a) { return math::keep(m, a); }
CAROM_SIMD_INLINE F dot(const Wide2& a, const Wide2& b) { return a.x * b.x + a.y * b.y; }
CAROM_SIMD_INLINE F select(Mask m, F a, F b) { return math::select(m, a, b); }
CAROM_SIMD_INLINE Wide2 select(Mask m, const Wide2& a, const Wide2& b) {
  return {math::select(m, a.x, b.x), math::select(m, a.y, b.y)};
}
/// The rotation by (c, s) and back.
CAROM_SIMD_INLINE Wide2 rotate(F c, F s, const Wide2& v) { return {c * v.x - s * v.y, s * v.x + c * v.y}; }
CAROM_SIMD_INLINE Wide2 rotate_back(F c, F s, const Wide2& v) { return {c * v.x + s * v.y, (-s) * v.x + c * v.y}; }

template <class T>
CAROM_SIMD_INLINE T pick_of_four(const T* of, Int index) {
  const T low = select(index == Int::zero(), of[0], of[1]), high = select(index == Int::splat(2), of[2], of[3]);
  return select(index < Int::splat(2), low, high);
}
/// N: 4 or 8.
template <class T, int N>
CAROM_SIMD_INLINE T pick(const T (&of)[N], Int index) {
  const T low = pick_of_four(of, index);
  if constexpr (N == 4)
    return low;
  else
    return select(index < Int::splat(4), low, pick_of_four(of + 4, index - Int::splat(4)));
}
/// As least_of and greatest_of of polygon_lanes.h, after those of eight that lie in one lane there: in their order.
template <int N>
CAROM_SIMD_INLINE F least_of(const F (&a)[N]) {
  F d[4];
  for (int k = 0; k < 4; ++k) d[k] = N == 4 ? a[k] : min(a[k], a[k + N - 4]);
  return min(min(d[0], d[1]), min(d[2], d[3]));
}
template <int N>
CAROM_SIMD_INLINE F greatest_of(const F (&a)[N]) {
  F d[4];
  for (int k = 0; k < 4; ++k) d[k] = N == 4 ? a[k] : max(a[k], a[k + N - 4]);
  return max(max(d[0], d[1]), max(d[2], d[3]));
}
/// The first that holds `value`.
template <int N>
CAROM_SIMD_INLINE Int place_of(const F (&a)[N], F value) {
  Int place = Int::splat(N - 1);
  for (int k = N - 1; k-- > 0;) place = math::select(a[k] == value, Int::splat(k), place);
  return place;
}
template <int N>
CAROM_SIMD_INLINE void along(const Wide2 (&v)[N], const Wide2& n, F (&d)[N]) {
  for (int k = 0; k < N; ++k) d[k] = n.x * v[k].x + n.y * v[k].y;
}
template <int N>
CAROM_SIMD_INLINE F least_along(const Wide2 (&v)[N], const Wide2& n) {
  F d[N];
  along(v, n, d);
  return least_of(d);
}
template <int N>
CAROM_SIMD_INLINE Int lowest_along(const Wide2 (&v)[N], const Wide2& n) {
  F d[N];
  along(v, n, d);
  return place_of(d, least_of(d));
}

/// Polygons with at most N corners, of which the last corner and normal stand in for those that are missing.
template <int N>
struct Polygons {
  Wide2 v[N], n[N], centroid;
  F radius;
  Int count;

  CAROM_SIMD_INLINE explicit Polygons(const Shape2* const (&shapes)[width]) {
    static_assert(max_polygon_vertices == 8 && offsetof(Polygon, normals) == 64 && offsetof(Polygon, centroid) == 128 &&
                  offsetof(Polygon, radius) == 136 && offsetof(Polygon, count) == 140);
    const auto gather = [&](int from, auto& columns) __attribute__((always_inline)) {
      const float* rows[width];
      for (int i = 0; i < width; ++i) rows[i] = &shapes[i]->polygon.vertices[0].x + from;
      math::gather_rows<int(sizeof columns / sizeof(F)), width>(rows, columns);
    };
    for (int first = 0; first < N; first += 4) {
      F corners[8], normals[8];
      gather(2 * first, corners);
      gather(16 + 2 * first, normals);
      for (int k = 0; k < 4; ++k) {
        v[first + k] = {corners[2 * k], corners[2 * k + 1]};
        n[first + k] = {normals[2 * k], normals[2 * k + 1]};
      }
    }
    F last[4];
    gather(32, last);
    centroid = {last[0], last[1]};
    radius = last[2];
    count = bits(last[3]);
    for (int k = 3; k < N; ++k) {
      const Mask has = count > Int::splat(k);
      v[k] = select(has, v[k], v[k - 1]);
      n[k] = select(has, n[k], n[k - 1]);
    }
  }
  /// Half the smallest thickness, roughly.
  CAROM_SIMD_INLINE F size() const {
    F d[N];
    for (int k = 0; k < N; ++k) d[k] = dot(n[k], v[k] - centroid);
    return least_of(d) + radius;
  }
  CAROM_SIMD_INLINE Int next(Int i) const {
    return math::select(i + Int::splat(1) < count, i + Int::splat(1), Int::zero());
  }
};
using Quads = Polygons<4>;

struct Point {
  Wide2 at;
  F separation;
  Int feature;
};
CAROM_SIMD_INLINE Point select(Mask m, const Point& a, const Point& b) {
  return {select(m, a.at, b.at), select(m, a.separation, b.separation), math::select(m, a.feature, b.feature)};
}

/// What is found, and what the cache is to remember.
struct Answers {
  Wide2 normal;
  Int count, kind, edge;
  Point point[2];
};

/// As those of rounded2.h.
struct ReferenceEdges {
  Wide2 normal, start;
  F length;
  Int number;
  F radius;
};
struct IncidentEdges {
  Wide2 first, last;
  Int number;
  F radius;
};
/// The corner that lies deepest behind the reference edge.
struct DeepestCorners {
  Wide2 at;
  Int number;
  F along, separation;  ///< m, from the edge to it, without and with the radii
};

/// As clip_edge, with the deepest corner where that stands beyond the end of the edge.
CAROM_SIMD_INLINE void clip_edges(const ReferenceEdges& r, const IncidentEdges& s, const DeepestCorners& deepest,
                                  F slack, Mask of_b, F margin, Answers& out) {
  const F zero = F::zero(), half = F::splat(0.5f);
  const Int one = Int::splat(1);
  const Wide2 n = r.normal, t = {-n.y, n.x};
  const F t_first = dot(t, s.first - r.start), t_last = dot(t, s.last - r.start);
  const Mask swapped = t_first > t_last;
  const Wide2 p = select(swapped, s.last, s.first), q = select(swapped, s.first, s.last);
  const F tp = select(swapped, t_last, t_first), tq = select(swapped, t_first, t_last), span = tq - tp;
  const Mask beside = !((tq < zero) | (tp > r.length)), has_span = span > zero;
  const Wide2 ends[2] = {select((tp < zero) & has_span, p + (q - p) * ((-tp) / span), p),
                         select((tq > r.length) & has_span, q + (p - q) * ((tq - r.length) / span), q)};
  const Int side = math::select(of_b, Int::splat(1 << 24), Int::zero()), name = side | r.number << 16 | s.number << 8;
  Point point[2];
  for (int k = 0; k < 2; ++k) {
    const F d = dot(n, ends[k] - r.start);
    point[k] = {ends[k] + n * (half * (r.radius - s.radius - d)), d - r.radius - s.radius,
                name | math::select(of_b, Int::splat(2 - k), Int::splat(1 + k))};
  }
  const Wide2 between = ends[1] - ends[0];
  const Mask has0 = beside & !(point[0].separation > margin);
  const Mask same = dot(between, between) < F::splat(1e-12f) * r.length * r.length;
  const Mask has1 = beside & !(point[1].separation > margin) & !(has0 & same), both = has0 & has1;
  const F far = F::splat(3.4e38f);
  const F least = min(select(has0, point[0].separation, far), select(has1, point[1].separation, far));
  const Mask adds = !((deepest.separation > margin) |
                      (least <= deepest.separation + F::splat(0.02f) * abs(deepest.separation) + slack));
  const Point deep = {deepest.at + n * (half * (r.radius - s.radius - deepest.along)), deepest.separation,
                      Int::splat(1 << 26) | side | deepest.number};
  const Mask first_goes = both & (point[0].separation > point[1].separation), none_yet = !(has0 | has1);
  out.normal = select(of_b, -n, n);
  out.point[0] = select(adds & (none_yet | first_goes), deep, select(has0, point[0], point[1]));
  out.point[1] = select(adds & !(none_yet | first_goes), deep, point[1]);
  out.count = keep(has0, one) + keep(has1, one) + keep(adds & !both, one);
}

CAROM_SIMD_INLINE void store(const Answers& answers, Mask left_alone, LanePairs& pairs, int first, int count) {
  Answers a = answers;
  const Mask has0 = a.count > Int::zero(), has1 = a.count > Int::splat(1);
  const F zero = F::zero();
  // Without contacts the first separation tells how far they are from each other.
  const F rows[16] = {a.normal.x,
                      a.normal.y,
                      math::float_of_bits(a.count),
                      zero,
                      zero,
                      keep(has0, a.point[0].at.x),
                      keep(has0, a.point[0].at.y),
                      a.point[0].separation,
                      keep(has0, math::float_of_bits(a.point[0].feature)),
                      keep(has1, a.point[1].at.x),
                      keep(has1, a.point[1].at.y),
                      keep(has1, a.point[1].separation),
                      keep(has1, math::float_of_bits(a.point[1].feature)),
                      zero,
                      zero,
                      zero};
  static_assert(offsetof(Manifold2, points) == 20 && sizeof(ManifoldPoint2) == 16);
  const std::uint32_t alone = bitmask(left_alone);
  std::int32_t place[width], kind[width], edge[width];
  for (int i = 0; i < width; ++i) place[i] = first + i < count && (alone >> i & 1u) == 0 ? first + i : -1;
  math::scatter_rows<16, 16, width>(reinterpret_cast<float*>(pairs.found), place, rows);
  a.kind.store(kind);
  a.edge.store(edge);
  for (int i = 0; i < width; ++i)
    if (place[i] >= 0) pairs.kind[place[i]] = kind[i], pairs.edge[place[i]] = edge[i];
}

/// What all kinds of pairs have, of those from `first` on; lanes without a pair are like the first.
struct Lanes {
  const Shape2 *a[width], *b[width];
  Wide2 p;  ///< B in A
  F c, s, margin;
  Int kind, edge;

  CAROM_SIMD_INLINE Lanes(const LanePairs& pairs, int first, int count) {
    const float* rows[width];
    float margins[width];
    std::int32_t kinds[width], edges[width];
    for (int i = 0; i < width; ++i) {
      const int k = first + i < count ? first + i : first;
      a[i] = pairs.a[k], b[i] = pairs.b[k], rows[i] = pairs.b_in_a[k];
      margins[i] = pairs.margin[k], kinds[i] = pairs.kind[k], edges[i] = pairs.edge[k];
    }
    F x[4];
    math::gather_rows<4, width>(rows, x);
    p = {x[0], x[1]}, c = x[2], s = x[3];
    margin = F::load(margins), kind = Int::load(kinds), edge = Int::load(edges);
  }
};

}  // namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE

#include "carom/geometry/detail/lane_polygons.inl"
#include "carom/geometry/detail/lane_round.inl"

namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE {

template <std::uint32_t (*Some)(LanePairs&, int, int)>
std::uint32_t collide(LanePairs& pairs, int count) {
  std::uint32_t alone = 0;
  for (int first = 0; first < count; first += width) alone |= Some(pairs, first, count) << first;
  return alone & ((1u << count) - 1);
}

LaneColliders colliders() {
  return {{collide<collide_polygons<4>>, collide<collide_quad_capsules>, collide<collide_quad_circles>,
           collide<collide_capsules>, collide<collide_polygons<8>>}};
}

}  // namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE
