// Two polygons with at most four or eight corners in each lane: part of lane_pairs.inl, the same as
// polygon_pair::collide of manifold2_polygon.cpp.

namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE {

/// Where along the edges' normals the corners of the other polygon begin, and the edge where that is farthest.
template <int N>
struct Axes {
  F s[N], separation;
  Int edge;

  CAROM_SIMD_INLINE Axes(const Polygons<N>& of, const Polygons<N>& other) {
    for (int k = 0; k < N; ++k) {
      F d[N];
      along(other.v, of.n[k], d);
      F least = d[0];
      for (int i = 1; i < N; ++i) least = min(least, d[i]);
      s[k] = least - dot(of.n[k], of.v[k]);
    }
    separation = greatest_of(s);
    edge = place_of(s, separation);
  }
  /// Has it an edge across n, along which the two hardly overlap?
  CAROM_SIMD_INLINE Mask any_across(const Polygons<N>& of, const Wide2& n, F tolerance) const {
    Mask any = Mask::none();
    for (int k = 0; k < N; ++k) {
      const F turned = n.x * of.n[k].x + n.y * of.n[k].y;
      any = any | ((abs(turned) <= F::splat(0.02f)) & (s[k] > -tolerance));
    }
    return any;
  }
};

/// The contacts of an edge of r, which has the number e, with the edge of s that faces it. Mask: it is more than that.
template <int N>
CAROM_SIMD_INLINE Mask contacts_along(const Polygons<N>& r, const Polygons<N>& s, Int e, F separation, F slack,
                                      Mask of_b, F margin, Answers& out) {
  const Wide2 n = pick(r.n, e), t = {-n.y, n.x}, start = pick(r.v, e);
  const F length = dot(t, pick(r.v, r.next(e)) - start);
  const Int corner = lowest_along(s.v, n), f = lowest_along(s.n, n);
  const Wide2 lowest = pick(s.v, corner);
  const F at = dot(t, lowest - start);
  clip_edges({n, start, length, e, r.radius}, {pick(s.v, s.next(f)), pick(s.v, f), f, s.radius},
             {lowest, corner, separation, separation - r.radius - s.radius}, slack, of_b, margin, out);
  out.kind = math::select(of_b, Int::splat(2), Int::splat(1));
  out.edge = e;
  const Mask at_corner = (separation > F::splat(1e-4f) * slack) & ((at < F::zero()) | (at > length));
  return at_corner | (out.count == Int::zero());
}

template <int N>
std::uint32_t collide_polygons(LanePairs& pairs, int first, int count) {
  const Lanes lanes(pairs, first, count);
  const Polygons<N> a(lanes.a);
  Polygons<N> b(lanes.b);
  const Wide2 p = lanes.p;
  const F c = lanes.c, s = lanes.s, margin = lanes.margin, radius = a.radius + b.radius;
  const Int kind = lanes.kind, edge = lanes.edge, one = Int::splat(1), two = Int::splat(2);

  Answers out;
  out.kind = kind, out.edge = edge;
  out.count = Int::zero();
  out.point[0].separation = F::zero();
  Mask apart = Mask::none();
  const auto part = [&](Mask asked, F separation, Int which, Int number) __attribute__((always_inline)) {
    const Mask now = asked & !apart & (separation - radius > margin);
    out.point[0].separation = select(now, separation - radius, out.point[0].separation);
    out.kind = math::select(now, which, out.kind);
    out.edge = math::select(now, number, out.edge);
    apart = apart | now;
  };
  // The edge that parted them last is asked first.
  const Mask of_a_last = (kind == one) & (edge < a.count), of_b_last = (kind == two) & (edge < b.count);
  if (any(of_a_last)) {
    const Wide2 n = pick(a.n, edge);
    part(of_a_last, least_along(b.v, rotate_back(c, s, n)) + dot(n, p - pick(a.v, edge)), one, edge);
  }
  if (any(of_b_last)) {
    const Wide2 n = pick(b.n, edge);
    part(of_b_last, least_along(a.v, rotate_back(c, -s, n)) + dot(n, -rotate_back(c, s, p) - pick(b.v, edge)), two,
         edge);
  }
  const F small = max(min(a.size(), b.size()), F::zero()), slack = F::splat(1e-3f) * small;
  for (int k = 0; k < N; ++k) b.n[k] = rotate(c, s, b.n[k]);
  const auto normal_apart = [&] {
    const Wide2 of_b = pick(b.n, out.edge);
    out.normal = select(out.kind == two, -of_b, pick(a.n, out.edge));
  };
  if (all(apart)) {
    normal_apart();
    store(out, Mask::none(), pairs, first, count);
    return 0;
  }
  for (int k = 0; k < N; ++k) b.v[k] = rotate(c, s, b.v[k]) + p;
  const Axes<N> of_a(a, b), of_b(b, a);
  part(Mask::all(), of_a.separation, one, of_a.edge);
  part(Mask::all(), of_b.separation, two, of_b.edge);
  normal_apart();
  if (all(apart)) {
    store(out, Mask::none(), pairs, first, count);
    return 0;
  }
  const Mask by_b = of_b.separation > of_a.separation + select(kind == two, -slack, slack);
  const F separation = select(by_b, of_b.separation, of_a.separation);
  const Int number = math::select(by_b, of_b.edge, of_a.edge);
  Polygons<N> r = a, other = b;
  for (int k = 0; k < N; ++k) {
    r.v[k] = select(by_b, b.v[k], a.v[k]), other.v[k] = select(by_b, a.v[k], b.v[k]);
    r.n[k] = select(by_b, b.n[k], a.n[k]), other.n[k] = select(by_b, a.n[k], b.n[k]);
  }
  r.radius = select(by_b, b.radius, a.radius), other.radius = select(by_b, a.radius, b.radius);
  r.count = math::select(by_b, b.count, a.count), other.count = math::select(by_b, a.count, b.count);
  Answers touching;
  Mask left_alone = contacts_along(r, other, number, separation, slack, by_b, margin, touching);
  // Level rows that graze each other (rare) are left to the other one.
  const F tolerance = min(F::splat(0.02f) * small, F::splat(0.005f));
  const Mask level = (radius == F::zero()) & (separation > -tolerance);
  if (any(level)) {
    const Wide2 n = pick(r.n, number);
    left_alone = left_alone | (level & (of_a.any_across(a, n, tolerance) | of_b.any_across(b, n, tolerance)));
  }
  left_alone = left_alone & !apart;
  out.normal = select(apart, out.normal, touching.normal);
  out.count = math::select(apart, out.count, touching.count);
  out.kind = math::select(apart, out.kind, touching.kind);
  out.edge = math::select(apart, out.edge, touching.edge);
  touching.point[0].separation = select(apart, out.point[0].separation, touching.point[0].separation);
  out.point[0] = touching.point[0], out.point[1] = touching.point[1];
  store(out, left_alone, pairs, first, count);
  return bitmask(left_alone);
}

}  // namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE
