// Distance, overlap, casts and time of impact in the plane.
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/query.h"

#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/detail/swept2.h"

namespace carom::geometry {
namespace query2 {

using detail::CoreDistance2;
using detail::Motion2;
using detail::Rounded2;
using detail::Swept;

bool is_chain(const Shape2& s) { return s.type == ShapeType2::chain; }

/// Calls use(segment, index) for every segment of a chain that may meet `box`; use returns false to stop.
template <class Use>
void segments_near(const Chain& chain, const Bounds2f& box, Use&& use) {
  detail::visit_segments(chain, box, [&](int i) {
    const std::size_t next = std::size_t(i) + 1;
    return use(Segment{chain.points[std::size_t(i)], chain.points[next < chain.points.size() ? next : 0]}, i);
  });
}
constexpr Bounds2f everywhere{{-3e38f, -3e38f}, {3e38f, 3e38f}};

Distance2 between(const Rounded2& a, const Rounded2& b) {
  const CoreDistance2 d = detail::core_distance(a, b);
  Distance2 out;
  const float distance = d.distance - a.radius - b.radius;
  if (distance <= 0) {
    out.point_a = out.point_b = (d.point_a + d.point_b) * 0.5f;
    return out;
  }
  out.distance = distance;
  out.normal = d.normal;
  out.point_a = d.point_a + d.normal * a.radius;
  out.point_b = d.point_b - d.normal * b.radius;
  return out;
}

/// The corners of `moving` against `fixed`, and the reverse: a ray from p along d against one rounded edge.
struct RayResult {
  bool hit = false;
  float t = 1;
  Vec2f normal{};
};

void ray_circle(Vec2f center, float radius, Vec2f o, Vec2f d, RayResult& best) {
  const Vec2d m = Vec2d(o) - Vec2d(center), w(d);
  const double a = dot(w, w), b = dot(m, w), c = dot(m, m) - square(double(radius));
  const double discriminant = b * b - a * c;
  if (!(a > 0) || b >= 0 || c <= 0 || discriminant < 0) return;
  const double t = c / (-b + math::sqrt(discriminant));
  if (t > double(best.t)) return;
  best.hit = true, best.t = float(t), best.normal = Vec2f(normalize(m + w * t));
}

/// A ray against the line a…b moved out by `radius` along n; only from the side of n.
void ray_edge(Vec2f a, Vec2f b, Vec2f n, float radius, Vec2f o, Vec2f d, RayResult& best) {
  const Vec2d nd(n), w(d), to = Vec2d(o) - Vec2d(a);
  const double along = dot(nd, w), above = dot(nd, to) - double(radius);
  if (!(along < 0) || above < 0) return;
  const double t = -above / along;
  if (t > double(best.t)) return;
  const Vec2d e = Vec2d(b) - Vec2d(a), p = to + w * t;
  const double u = dot(p, e);
  if (u < 0 || u > dot(e, e)) return;
  best.hit = true, best.t = float(t), best.normal = n;
}

bool contains_point(const Rounded2& s, Vec2f p) {
  Rounded2 point;
  point.count = 1, point.v[0] = p;
  return detail::core_distance(s, point).distance - s.radius <= 0;
}

CastHit2 ray_rounded(const Rounded2& s, Vec2f o, Vec2f d) {
  CastHit2 hit;
  const bool solid = s.count > 2 || s.radius > 0;
  if (solid && contains_point(s, o)) {
    hit.hit = true;
    hit.fraction = 0;
    hit.point = o;
    return hit;
  }
  RayResult best;
  for (int i = 0; i < s.count; ++i) {
    if (s.count > 1) ray_edge(s.v[i], s.v[s.next(i)], s.n[i], s.radius, o, d, best);
    if (s.radius > 0) ray_circle(s.v[i], s.radius, o, d, best);
  }
  if (!best.hit) return hit;
  hit.hit = true, hit.fraction = best.t, hit.normal = best.normal, hit.point = o + d * best.t;
  return hit;
}

CastHit2 ray_chain_segment(Vec2f a, Vec2f b, Vec2f o, Vec2f d) {
  const Vec2f t = normalize(b - a);
  RayResult best;
  ray_edge(a, b, {t.y, -t.x}, 0, o, d, best);
  CastHit2 hit;
  if (best.hit) hit.hit = true, hit.fraction = best.t, hit.normal = best.normal, hit.point = o + d * best.t;
  return hit;
}

/// Conservative advancement without turning. `side`: a chain's segment, seen from its free side only.
CastHit2 cast_rounded(const Rounded2& a, const Rounded2& b, Vec2f way, float limit, bool side) {
  CastHit2 hit;
  if (side && (dot(a.n[0], detail::center_of(b) - a.v[0]) < 0 || dot(a.n[0], way) > 0)) return hit;
  const float radius = a.radius + b.radius;
  const float tolerance = max(1e-5f, 2e-6f * (length(detail::center_of(b)) + length(way)));
  Rounded2 moved = b;
  float t = 0;
  for (int i = 0; i < 48; ++i) {
    for (int k = 0; k < b.count; ++k) moved.v[k] = b.v[k] + way * t;
    const CoreDistance2 d = detail::core_distance(a, moved);
    const float gap = d.distance - radius;
    if (gap <= (i == 0 ? 0 : tolerance) || i == 47) {
      hit.hit = true;
      hit.fraction = t;
      if (i > 0) hit.normal = d.normal;
      hit.point = d.point_a + d.normal * a.radius;
      return hit;
    }
    const float closing = -dot(d.normal, way);
    if (!(closing > 0)) return hit;
    t += max(gap - 0.5f * tolerance, 0.5f * tolerance) / closing;
    if (t > limit) return hit;
  }
  return hit;
}

TimeOfImpact impact(const Rounded2& ca, const Motion2& a, const Rounded2& cb, const Motion2& b, double target,
                    bool side) {
  // One-sided: what begins behind passes.
  if (side) {
    const Rounded2 pa = detail::placed(ca, detail::in_float(a.at(0, a.c0)));
    const Rounded2 pb = detail::placed(cb, detail::in_float(b.at(0, a.c0)));
    if (dot(pa.n[0], detail::center_of(pb) - pa.v[0]) < 0) return {};
  }
  const Swept<Vec2d> sa = detail::swept(ca, a), sb = detail::swept(cb, b);
  detail::CoreGap2 gap{ca, cb, a, b};
  return detail::advance<Vec2d>(
      target, 1, gap, [&](double t, Vec2d n) { return a.speed(n, sa, t) + b.speed(-n, sb, t); },
      [](double, Vec2d) { return false; });
}

/// Bounds, in the frame of what `still` carries, of all places of a shape that moves. Everything, where `still` moves.
Bounds2f way_seen_from(const Sweep2& still, const Shape2& shape, const Sweep2& sweep) {
  if (still.c0 != still.c1 || still.q0.c != still.q1.c || still.q0.s != still.q1.s) return everywhere;
  const detail::Rounded2 r = detail::rounded_of(shape);
  float reach = 0;
  for (int i = 0; i < r.count; ++i) reach = max(reach, length(r.v[i] - sweep.local_center));
  const Transform2f frame{still.c0 - rotate(still.q0, still.local_center), still.q0};
  const Vec2f from = inverse_transform_point(frame, sweep.c0), to = inverse_transform_point(frame, sweep.c1);
  return grow(Bounds2f{min(from, to), max(from, to)}, 1.0001f * (reach + r.radius));
}

void keep_first(TimeOfImpact& first, const TimeOfImpact& t) {
  if (t.state == ImpactState::separated) return;
  if (first.state == ImpactState::separated || t.time < first.time) first = t;
}

}  // namespace query2

Distance2 distance(const Shape2& a, const Shape2& b, const Transform2f& x) {
  using namespace query2;
  if (!is_chain(a) && !is_chain(b)) return between(detail::rounded_of(a), detail::placed(b, x));
  if (!is_chain(a)) {
    Distance2 d = distance(b, a, inverse(x));
    const Vec2f p = d.point_a;
    d.point_a = transform_point(x, d.point_b);
    d.point_b = transform_point(x, p);
    d.normal = -rotate(x.q, d.normal);
    return d;
  }
  Distance2 best;
  best.distance = 3.4e38f;
  segments_near(*a.chain, everywhere, [&](const Segment& s, int) {
    const Distance2 d = distance(Shape2(s), b, x);
    if (d.distance < best.distance) best = d;
    return best.distance > 0;
  });
  return best;
}

bool overlap(const Shape2& a, const Shape2& b, const Transform2f& b_in_a) {
  using namespace query2;
  if (!is_chain(a) && !is_chain(b)) {
    const detail::Rounded2 ra = detail::rounded_of(a), rb = detail::placed(b, b_in_a);
    return detail::core_distance(ra, rb).distance <= ra.radius + rb.radius;
  }
  if (!is_chain(a)) return overlap(b, a, inverse(b_in_a));
  bool any = false;
  segments_near(*a.chain, bounds(b, b_in_a), [&](const Segment& s, int) {
    any = distance(Shape2(s), b, b_in_a).distance <= 0;
    return !any;
  });
  return any;
}

CastHit2 ray_cast(const Shape2& s, Vec2f origin, Vec2f translation) {
  using namespace query2;
  if (s.type == ShapeType2::chain_segment)
    return ray_chain_segment(s.chain_segment.a, s.chain_segment.b, origin, translation);
  if (!is_chain(s)) return ray_rounded(detail::rounded_of(s), origin, translation);
  CastHit2 best;
  const Vec2f end = origin + translation;
  segments_near(*s.chain, {min(origin, end), max(origin, end)}, [&](const Segment& e, int i) {
    CastHit2 h = ray_chain_segment(e.a, e.b, origin, translation);
    if (h.hit && (!best.hit || h.fraction < best.fraction)) h.child = std::uint32_t(i), best = h;
    return true;
  });
  return best;
}

CastHit2 shape_cast(const Shape2& a, const Shape2& b, const Transform2f& x, Vec2f translation) {
  using namespace query2;
  if (is_chain(b)) return {};
  const detail::Rounded2 moving = detail::placed(b, x);
  if (!is_chain(a)) {
    const detail::Rounded2 fixed = detail::rounded_of(a);
    return cast_rounded(fixed, moving, translation, 1, a.type == ShapeType2::chain_segment && fixed.count == 2);
  }
  const Bounds2f box = grow(bounds(b, x), 1e-4f);
  CastHit2 best;
  segments_near(*a.chain, merge(box, Bounds2f{box.low + translation, box.high + translation}),
                [&](const Segment& e, int i) {
                  const detail::Rounded2 line = detail::rounded_of(Shape2(e));
                  CastHit2 h = cast_rounded(line, moving, translation, best.fraction, line.count == 2);
                  if (h.hit && (!best.hit || h.fraction < best.fraction)) h.child = std::uint32_t(i), best = h;
                  return true;
                });
  return best;
}

TimeOfImpact time_of_impact(const Shape2& a, const Sweep2& sweep_a, const Shape2& b, const Sweep2& sweep_b,
                            float target) {
  using namespace query2;
  if (is_chain(a) || is_chain(b)) {
    TimeOfImpact first;
    const Chain& chain = is_chain(a) ? *a.chain : *b.chain;
    if (is_chain(a) && is_chain(b)) return {ImpactState::failed, 1};
    const Shape2& moving = is_chain(a) ? b : a;
    const Bounds2f box = way_seen_from(is_chain(a) ? sweep_a : sweep_b, moving, is_chain(a) ? sweep_b : sweep_a);
    detail::visit_segments(chain, grow(box, 2 * target), [&](int i) {
      const Shape2 s(chain.segment(i));
      keep_first(first, is_chain(a) ? time_of_impact(s, sweep_a, b, sweep_b, target)
                                    : time_of_impact(a, sweep_a, s, sweep_b, target));
      return true;
    });
    return first;
  }
  const double near = max(double(target), 1e-6);
  const detail::Rounded2 ra = detail::rounded_of(a), rb = detail::rounded_of(b);
  if (b.type == ShapeType2::chain_segment && rb.count == 2)
    return impact(rb, Motion2(sweep_b), ra, Motion2(sweep_a), near, true);
  return impact(ra, Motion2(sweep_a), rb, Motion2(sweep_b), near, a.type == ShapeType2::chain_segment && ra.count == 2);
}

namespace detail {
CastHit2 shape_cast_within(const Shape2& a, const Shape2& b, const Transform2f& x, Vec2f translation, float) {
  return shape_cast(a, b, x, translation);
}
}  // namespace detail

}  // namespace carom::geometry
