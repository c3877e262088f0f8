// Time of impact in space by conservative advancement (Mirtich 1996; the directional bound of Zhang et al. 2006): the
// distance along the present normal cannot shrink faster than the motion along that normal, turning included.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/detail/surface.h"

namespace carom::geometry {
namespace toi3 {

using detail::Convex;

/// A sweep in double with what bounds its turning.
struct Motion {
  Vec3d local_center, c0, way;
  Quatd q0, q1;
  Vec3d axis{};      ///< of the turn, unit
  double rate = 0;   ///< rad a unit of time, the most
  double reach = 0;  ///< the farthest point of the core from the centre

  explicit Motion(const Sweep3& s)
      : local_center(s.local_center),
        c0(s.c0),
        way(Vec3d(s.c1) - Vec3d(s.c0)),
        q0(normalize(Quatd(s.q0))),
        q1(normalize(Quatd(s.q1))) {
    if (dot(q0, q1) < 0) q1 = -q1;
    // A normalised linear interpolation turns fastest half way: 4 tan(θ/4) a unit of time for a turn by θ.
    const Quatd chord = q1 - q0, middle = (q0 + q1) * 0.5;
    const double l = length(middle);
    rate = l > 0 ? 2 * length(chord) / l : 0;
    axis = normalize((q1 * conjugate(q0)).vector());
  }
  Transform3d at(double t) const {
    const Quatd q = normalize(q0 + (q1 - q0) * t);
    return {c0 + way * t - rotate(q, local_center), q};
  }
  /// The most that a point of the shape can move along n in a unit of time, beyond the centre's own motion.
  double turning(Vec3d n) const {
    if (rate == 0) return 0;
    const double across = math::sqrt(max(0.0, 1 - square(dot(n, axis))));
    return rate * reach * min(1.0, across + 1e-6);
  }
};

double reach_about(const Convex& c, Vec3f center) {
  double most = 0;
  const auto see = [&](Vec3f p) { most = max(most, length_squared(Vec3d(p) - Vec3d(center))); };
  switch (c.kind) {
    case detail::CoreKind::point:
      see({});
      break;
    case detail::CoreKind::hull:
      for (const Vec3f& v : c.hull->vertices) see(v);
      break;
    case detail::CoreKind::triangle:
      for (const Vec3f& v : c.corner) see(v);
      break;
    case detail::CoreKind::segment:
      see({0, c.half.y, 0});
      see({0, -c.half.y, 0});
      break;
    case detail::CoreKind::cylinder:
    case detail::CoreKind::cone: {
      const double r = double(c.half.x) + math::sqrt(square(double(center.x)) + square(double(center.z)));
      const double h = double(c.half.y) + math::abs(double(center.y));
      return math::sqrt(r * r + h * h);
    }
    case detail::CoreKind::box:
      for (int i = 0; i < 8; ++i)
        see({i & 1 ? c.half.x : -c.half.x, i & 2 ? c.half.y : -c.half.y, i & 4 ? c.half.z : -c.half.z});
  }
  return math::sqrt(most);
}

/// gap(t, n): the distance of the surfaces at t, and the normal from A to B that shows it; negative or zero: overlap.
template <class Gap>
TimeOfImpact advance(const Motion& a, const Motion& b, double target, double limit, Gap&& gap) {
  const double tolerance = 0.25 * target;
  const Vec3d closing_way = a.way - b.way;
  double t = 0;
  for (int i = 0; i < 200; ++i) {
    Vec3d n{};
    const double d = gap(t, n);
    if (i == 0 && d <= 0) return {ImpactState::overlapped, 0};
    if (d <= target + tolerance) return {ImpactState::hit, float(t)};
    const double closing = dot(closing_way, n) + a.turning(n) + b.turning(n);
    if (!(closing * (limit - t) > d - target)) return {};
    t += (d - target) / closing;
    if (t >= limit) return {};
  }
  // Still near after so many small steps: stop here rather than risk to pass.
  return {ImpactState::hit, float(t)};
}

TimeOfImpact cores(const Convex& ca, Motion a, const Convex& cb, Motion b, double target, double limit) {
  a.reach = reach_about(ca, Vec3f(a.local_center));
  b.reach = reach_about(cb, Vec3f(b.local_center));
  const double radius = double(ca.radius) + double(cb.radius);
  Vec3d guess{};
  return advance(a, b, target, limit, [&](double t, Vec3d& n) {
    detail::CoreDistance d;
    detail::core_distance(detail::Placed(ca, a.at(t)), detail::Placed(cb, b.at(t)), 1e30, guess, d);
    n = guess = d.normal;
    return d.overlap ? -1.0 : d.distance - radius;
  });
}

TimeOfImpact plane(const Plane& p, Motion a, const Convex& c, Motion b, double target, double limit) {
  a.reach = 0;  // the plane's own turning moves it by an unbounded amount; planes stand still
  b.reach = reach_about(c, Vec3f(b.local_center));
  return advance(a, b, target, limit, [&](double t, Vec3d& n) {
    const Transform3d xa = a.at(t), xb = b.at(t);
    n = rotate(xa.q, Vec3d(p.normal));
    const Vec3d s = transform_point(xb, detail::support(c, inverse_rotate(xb.q, -n)));
    return dot(n, s - xa.p) - double(c.radius);
  });
}

void keep_first(TimeOfImpact& first, const TimeOfImpact& t) {
  if (t.state == ImpactState::separated) return;
  if (first.state == ImpactState::separated || t.time < first.time) first = t;
}

/// `surface` moves by a, the convex core by b.
TimeOfImpact on_surface(const Shape3& surface, const Motion& a, const Convex& c, const Motion& b, double target) {
  const bool solid = surface.type == ShapeType3::height_field;
  const Vec3d inner(detail::inner_point(c));
  const Transform3d begin = inverse(a.at(0)) * b.at(0), end = inverse(a.at(1)) * b.at(1);
  const Vec3d p0 = transform_point(begin, inner), p1 = transform_point(end, inner);
  // The core stays within this of the straight way of its inner point, in the surface's frame.
  const double size = double(detail::outer_size(c)) + math::length(inner) + double(c.radius);
  const double swing = b.rate * math::length(inner - b.local_center) + a.rate * (math::length(p0) + math::length(p1));
  const double around = (size + target) * 1.001 + swing;
  const Vec3f low = Vec3f(min(p0, p1)), high = Vec3f(max(p0, p1));
  const Bounds3f box = grow(Bounds3f{low, high}, float(around));
  float height;
  if (solid && detail::height_at(*surface.height_field, float(p0.x), float(p0.z), height) && p0.y <= double(height))
    return {ImpactState::overlapped, 0};

  TimeOfImpact first;
  double limit = 1;
  const detail::SlabRay<Vec3f> ray(Vec3f(p0), Vec3f(p1 - p0), Vec3f{1, 1, 1} * float(around));
  detail::visit_triangles(surface, box, false, [&](const detail::SurfaceTriangle& t) {
    const Bounds3f b3{min(t.corner[0], min(t.corner[1], t.corner[2])), max(t.corner[0], max(t.corner[1], t.corner[2]))};
    if (ray.enter(b3, 1) > 1) return true;
    const Convex triangle = detail::convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]);
    if (!solid && dot(Vec3d(triangle.normal), p0 - Vec3d(t.corner[0])) < 0) return true;  // from behind
    const TimeOfImpact hit = cores(triangle, a, c, b, target, limit);
    keep_first(first, hit);
    if (first.state != ImpactState::separated) limit = double(first.time);
    return limit > 0;
  });
  return first;
}

Sweep3 part(const Sweep3& s, const Transform3f& local) {
  return {inverse_transform_point(local, s.local_center), s.c0, s.c1, s.q0 * local.q, s.q1 * local.q};
}

}  // namespace toi3

TimeOfImpact time_of_impact(const Shape3& a, const Sweep3& sweep_a, const Shape3& b, const Sweep3& sweep_b,
                            float target) {
  using namespace toi3;
  if (a.type == ShapeType3::compound || b.type == ShapeType3::compound) {
    TimeOfImpact first;
    const bool split_a = a.type == ShapeType3::compound;
    for (const CompoundChild& c : (split_a ? a : b).compound->children)
      keep_first(first, split_a ? time_of_impact(c.shape, part(sweep_a, c.local), b, sweep_b, target)
                                : time_of_impact(a, sweep_a, c.shape, part(sweep_b, c.local), target));
    return first;
  }
  const Motion ma(sweep_a), mb(sweep_b);
  const double near = max(double(target), 1e-6);
  if (is_convex(a) && is_convex(b)) return cores(detail::convex_of(a), ma, detail::convex_of(b), mb, near, 1);
  if (is_convex(a) && b.type == ShapeType3::plane) return plane(b.plane, mb, detail::convex_of(a), ma, near, 1);
  if (is_convex(b) && a.type == ShapeType3::plane) return plane(a.plane, ma, detail::convex_of(b), mb, near, 1);
  if (is_convex(a) && b.type != ShapeType3::plane) return on_surface(b, mb, detail::convex_of(a), ma, near);
  if (is_convex(b) && a.type != ShapeType3::plane) return on_surface(a, ma, detail::convex_of(b), mb, near);
  return {ImpactState::failed, 1};
}

}  // namespace carom::geometry
