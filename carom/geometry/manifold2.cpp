// Contact manifolds in the plane: separating axes and clipping of rounded polygons; chain segments with one side.
#include "carom/geometry/manifold.h"

#include "carom/geometry/detail/rounded2.h"

namespace carom::geometry {
namespace pairs2 {

using detail::Rounded2;

/// One corner of b against the polygon or line a.
void against_point(const Rounded2& a, Vec2f p, float radius, float margin, Manifold2& out) {
  if (a.count == 2)
    return detail::between_points(detail::closest_on_line(a.v[0], a.v[1], p), a.radius, p, radius, margin, 0, out);
  int edge = 0;
  float best = -3.4e38f;
  for (int i = 0; i < a.count; ++i) {
    const float s = dot(a.n[i], p - a.v[i]);
    if (s > best) best = s, edge = i;
  }
  if (best > a.radius + radius + margin) return;
  if (best > 0) {
    const Vec2f q = detail::closest_on_line(a.v[edge], a.v[a.next(edge)], p);
    const Vec2f d = p - q;
    if (dot(d, d) > 1e-12f * best && distance_squared(q, p) > best * best * 1.000001f) {  // round a corner
      detail::between_points(q, a.radius, p, radius, margin, 0, out);
      if (a.radius == 0) detail::over_border(out, a.n[edge], best, a.radius + radius);
      return;
    }
  }
  detail::single_contact(p - a.n[edge] * best, a.radius, p, radius, a.n[edge], best, 0, out);
}

/// The edge `e` of r against the edge of s that faces it. Points along r's normal; `of_b` says that r is B.
void clip_edges(const Rounded2& r, int e, const Rounded2& s, bool of_b, float margin, Manifold2& out) {
  const Vec2f n = r.n[e], t{-n.y, n.x};  // t runs from v[e] to v[e + 1]
  int f = 0;
  float most = 3.4e38f;
  for (int i = 0; i < s.count; ++i)
    if (const float d = dot(n, s.n[i]); d < most) most = d, f = i;
  detail::clip_edge({n, r.v[e], dot(t, r.v[r.next(e)] - r.v[e]), e, r.radius}, {s.v[s.next(f)], s.v[f], f, s.radius},
                    of_b, margin, out);
}

/// Polygons side by side, level with each other (a row of tiles), that meet only in a strip narrower than a small
/// tolerance: a contact across the row would catch on the joint. A matter of this pair alone.
bool grazes(const Rounded2& a, const Rounded2& b, Vec2f n, float best, float tolerance) {
  if (best <= -tolerance) return false;
  for (int side = 0; side < 2; ++side) {
    const Rounded2 &r = side == 0 ? a : b, &s = side == 0 ? b : a;
    for (int i = 0; i < r.count; ++i) {
      if (abs(dot(r.n[i], n)) > 0.02f || detail::separation_along(r, i, s) <= -tolerance) continue;
      for (int j = 0; j < s.count; ++j)
        if (dot(r.n[i], s.n[j]) < -0.9998f) return true;
    }
  }
  return false;
}

void polygons(const Rounded2& a, const Rounded2& b, float margin, PairCache& cache, Manifold2& out) {
  const float radius = a.radius + b.radius;
  // The edge that parted them last is asked first.
  const auto apart = [&](float separation, Vec2f normal) {
    out.points[0].separation = separation - radius;
    if (!(out.points[0].separation > margin)) return false;
    out.normal = normal;
    return true;
  };
  if (cache.kind == 1 && cache.a < a.count) {
    if (apart(detail::separation_along(a, cache.a, b), a.n[cache.a])) return;
  } else if (cache.kind == 2 && cache.a < b.count) {
    if (apart(detail::separation_along(b, cache.a, a), -b.n[cache.a])) return;
  }
  const detail::EdgeAxis ea = detail::best_edge(a, b);
  if (apart(ea.separation, a.n[ea.edge])) {
    cache.kind = 1, cache.a = std::uint8_t(ea.edge);
    return;
  }
  const detail::EdgeAxis eb = detail::best_edge(b, a);
  if (apart(eb.separation, -b.n[eb.edge])) {
    cache.kind = 2, cache.a = std::uint8_t(eb.edge);
    return;
  }
  const float small =
      max(min(a.count > 2 ? detail::size_of(a) : 3.4e38f, b.count > 2 ? detail::size_of(b) : 3.4e38f), 0.0f);
  const float slack = small < 3e38f ? 1e-3f * small : 0;
  const bool of_b = eb.separation > ea.separation + (cache.kind == 2 ? -slack : slack);
  const detail::EdgeAxis& axis = of_b ? eb : ea;
  cache.kind = of_b ? 2 : 1;
  cache.a = std::uint8_t(axis.edge);
  const Rounded2 &r = of_b ? b : a, &s = of_b ? a : b;

  if (radius == 0 && a.count > 2 && b.count > 2 && axis.separation > -0.005f) {
    if (grazes(a, b, r.n[axis.edge], axis.separation, min(0.02f * small, 0.005f))) return;
  }
  // Apart, the nearest features may be two corners: then the line between them is the normal.
  const bool lines = a.count == 2 && b.count == 2;
  if (axis.separation > 1e-4f * slack || (lines && axis.separation > -1e-5f)) {
    const detail::CoreDistance2 d = detail::core_distance(a, b, ea, eb);
    if (apart(d.distance, d.normal)) return;
    if (dot(d.normal, of_b ? -r.n[axis.edge] : r.n[axis.edge]) < 0.9999f && d.distance > 1e-6f) {
      detail::single_contact(d.point_a, a.radius, d.point_b, b.radius, d.normal, d.distance, 1u << 25, out);
      const Vec2f n = of_b ? -r.n[axis.edge] : r.n[axis.edge];
      if (radius > 0 && r.radius == 0) detail::over_border(out, n, axis.separation, radius);
      return;
    }
  }
  clip_edges(r, axis.edge, s, of_b, margin, out);
  // The deepest corner may stand beyond the end of the edge.
  const float deepest = axis.separation - radius;
  float least = out.count > 0 ? out.points[0].separation : 3.4e38f;
  if (out.count > 1) least = min(least, out.points[1].separation);
  if (deepest > margin || least <= deepest + 0.02f * abs(deepest) + slack) return;
  const Vec2f n = r.n[axis.edge];
  int corner = 0;
  for (int i = 1; i < s.count; ++i)
    if (dot(n, s.v[i]) < dot(n, s.v[corner])) corner = i;
  out.normal = of_b ? -n : n;
  int place = out.count < 2 ? out.count++ : (out.points[0].separation > out.points[1].separation ? 0 : 1);
  out.points[place] = {s.v[corner] + n * (0.5f * (r.radius - s.radius - axis.separation)), deepest,
                       1u << 26 | (of_b ? 1u << 24 : 0u) | std::uint32_t(corner)};
}

/// Which normals a chain segment may push along: its own, and over an end that stands out into free space those up to
/// half way to the neighbour's (the Gauss map of the chain; the neighbour has the other half).
struct ChainSector {
  Vec2f normal, from, to;  ///< unit
  bool corner_a, corner_b;

  explicit ChainSector(const ChainSegment& c) {
    const Vec2f t = normalize(c.b - c.a), t0 = normalize(c.a - c.ghost_before), t1 = normalize(c.ghost_after - c.b);
    normal = {t.y, -t.x};
    corner_a = cross(t0, t) > 0.0175f;
    corner_b = cross(t, t1) > 0.0175f;
    from = corner_a ? normalize_or(normal + Vec2f{t0.y, -t0.x}, normal, 1e-3f) : normal;
    to = corner_b ? normalize_or(normal + Vec2f{t1.y, -t1.x}, normal, 1e-3f) : normal;
  }
  bool allows(Vec2f n) const {
    if (dot(n, normal) < -1e-3f) return false;
    return cross(from, n) >= -1e-3f && cross(n, to) >= -1e-3f;
  }
};

void chain_front(const ChainSegment& c, const Rounded2& b, float margin, bool met, Manifold2& out) {
  const ChainSector sector(c);
  Rounded2 line = detail::rounded_of(Shape2(c));
  if (line.count < 2) return;
  const Vec2f middle = detail::center_of(b) - c.a;
  if (dot(sector.normal, middle) < 0) {  // from the solid side nothing collides but what was pressed through
    const Vec2f way = c.b - c.a;
    if (!met || dot(way, middle) < 0 || dot(way, middle) > dot(way, way)) return;
  }
  const float along = detail::separation_along(line, 0, b);
  if (along > b.radius + margin) return;

  const auto on_edge = [&] {
    if (b.count == 1) {
      const Vec2f t{-sector.normal.y, sector.normal.x};
      // Between two segments that meet in a flat corner a circle's centre may be over neither.
      const float u = dot(b.v[0] - c.a, t), slip = 0.018f * b.radius;
      if (u < -slip || u > length(c.b - c.a) + slip) return;
      detail::single_contact(b.v[0] - sector.normal * along, 0, b.v[0], b.radius, sector.normal, along, 1, out);
    } else {
      clip_edges(line, 0, b, false, margin, out);
    }
  };
  const detail::CoreDistance2 d = detail::core_distance(line, b);
  if (d.distance > 0) {
    if (d.distance - b.radius > margin) return;
    if (dot(d.normal, sector.normal) > 0.9999f || !sector.allows(d.normal)) return on_edge();
    if (b.count > 1) {  // flat on an edge of b?
      for (int i = 0; i < b.count; ++i)
        if (dot(b.n[i], d.normal) < -0.9999f) {
          clip_edges(b, i, line, true, margin, out);
          if (out.count > 0) return;
        }
    }
    return detail::single_contact(d.point_a, 0, d.point_b, b.radius, d.normal, d.distance, 1u << 25, out);
  }
  // Overlap: the segment's own normal, or a normal of b that the chain allows and that is clearly shallower.
  int edge = -1;
  float best = along + 0.02f * abs(along) + 1e-4f * detail::size_of(b);
  for (int i = 0; b.count > 2 && i < b.count; ++i) {
    if (!sector.allows(-b.n[i])) continue;
    const float s = detail::separation_along(b, i, line);
    if (s > best) best = s, edge = i;
  }
  if (edge >= 0) return clip_edges(b, edge, line, true, margin, out);
  on_edge();
}

void chain_any(const ChainSegment& c, const Rounded2& b, float margin, PairCache& cache, Manifold2& out) {
  chain_front(c, b, margin, cache.kind == met_front, out);
  cache.kind = out.count > 0 ? met_front : 0;
}

void flip(Manifold2& m) { m.normal = -m.normal; }

bool convex_shape(const Shape2& s) { return s.type <= ShapeType2::segment; }

}  // namespace pairs2

void detail::clip_edge(const ReferenceEdge& r, const IncidentEdge& s, bool of_b, float margin, Manifold2& out) {
  const Vec2f n = r.normal, t{-n.y, n.x}, start = r.start;
  Vec2f p = s.first, q = s.last;
  float tp = dot(t, p - start), tq = dot(t, q - start);
  if (tp > tq) {  // nearly at right angles: the order along t decides
    const Vec2f v = p;
    p = q, q = v;
    const float u = tp;
    tp = tq, tq = u;
  }
  out.count = 0;
  if (tq < 0 || tp > r.length) return;
  const float span = tq - tp;
  const Vec2f low = tp < 0 && span > 0 ? p + (q - p) * (-tp / span) : p;
  const Vec2f high = tq > r.length && span > 0 ? q + (p - q) * ((tq - r.length) / span) : q;
  out.normal = of_b ? -n : n;
  const Vec2f ends[2] = {low, high};
  for (int k = 0; k < 2; ++k) {
    const float d = dot(n, ends[k] - start), sep = d - r.radius - s.radius;
    if (sep > margin) continue;
    if (k == 1 && out.count == 1 && distance_squared(ends[0], ends[1]) < 1e-12f * r.length * r.length) continue;
    const std::uint32_t name = (of_b ? 1u << 24 : 0u) | std::uint32_t(r.number) << 16 | std::uint32_t(s.number) << 8 |
                               std::uint32_t((of_b ? 1 - k : k) + 1);
    out.points[out.count++] = {ends[k] + n * (0.5f * (r.radius - s.radius - d)), sep, name};
  }
}

void collide(const Shape2& a, const Shape2& b, const Transform2f& x, float margin, PairCache& cache, Manifold2& out) {
  using namespace pairs2;
  out.count = 0;
  out.normal = {};
  out.points[0].separation = margin;
  if (a.type == ShapeType2::chain || b.type == ShapeType2::chain) return;  // segment by segment: Chain::segment
  if (a.type == ShapeType2::chain_segment) {
    if (!convex_shape(b)) return;
    return chain_any(a.chain_segment, detail::placed(b, x), margin, cache, out);
  }
  if (b.type == ShapeType2::chain_segment) {
    chain_any(b.chain_segment, detail::placed(a, inverse(x)), margin, cache, out);
    out.normal = -rotate(x.q, out.normal);
    for (int i = 0; i < out.count; ++i) out.points[i].point = transform_point(x, out.points[i].point);
    return;
  }
  if (detail::collide_round(a, b, x, margin, cache, out)) return;
  if (a.type == ShapeType2::polygon && b.type == ShapeType2::polygon &&
      detail::collide_polygons(a.polygon, b.polygon, x, margin, cache, out))
    return;
  const Rounded2 ra = detail::rounded_of(a), rb = detail::placed(b, x);
  if (rb.count == 1) {
    if (ra.count == 1) return detail::between_points(ra.v[0], ra.radius, rb.v[0], rb.radius, margin, 0, out);
    return against_point(ra, rb.v[0], rb.radius, margin, out);
  }
  if (ra.count == 1) {
    against_point(rb, ra.v[0], ra.radius, margin, out);
    return flip(out);
  }
  polygons(ra, rb, margin, cache, out);
}

}  // namespace carom::geometry
