// Time of impact in space by conservative advancement.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/passage.h"
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/swept3.h"

namespace carom::geometry {
namespace toi3 {

using detail::Convex;
using detail::Motion3;
using detail::Swept;

constexpr auto never_safe = [](double, Vec3d) { return false; };

TimeOfImpact cores(const Convex& ca, const Motion3& a, const Convex& cb, const Motion3& b, double target,
                   double limit) {
  const Swept<Vec3d> sa = detail::swept(ca, a), sb = detail::swept(cb, b);
  detail::CoreGap gap{ca, cb, a, b, 4 * target, detail::bend_of(a, sa) + detail::bend_of(b, sb)};
  return detail::advance<Vec3d>(
      target, limit, gap, [&](double t, Vec3d n) { return a.speed(n, sa, t) + b.speed(-n, sb, t); }, never_safe);
}

/// Planes stand still: their own turning would move them by unbounded amounts.
TimeOfImpact plane(const Plane& p, const Motion3& a, const Convex& c, const Motion3& b, double target, double limit) {
  const Swept<Vec3d> sb = detail::swept(c, b);
  const auto gap = [&](double t, Vec3d& n) {
    const Transform3d xa = a.at(t), xb = b.at(t);
    n = rotate(xa.q, Vec3d(p.normal));
    const Vec3d s = transform_point(xb, detail::support(c, inverse_rotate(xb.q, -n)));
    return dot(n, s - xa.p) - double(c.radius);
  };
  return detail::advance<Vec3d>(
      target, limit, gap, [&](double t, Vec3d n) { return dot(a.way, n) + b.speed(-n, sb, t); }, never_safe);
}

void keep_first(TimeOfImpact& first, const TimeOfImpact& t) {
  if (t.state == ImpactState::separated) return;
  if (first.state == ImpactState::separated || t.time < first.time) first = t;
}

/// `surface` moves by a, the convex core by b.
TimeOfImpact on_surface(const Shape3& surface, const Motion3& a, const Convex& c, const Motion3& b, double target) {
  const bool solid = surface.type == ShapeType3::height_field;
  const Vec3d inner(detail::inner_point(c));
  const Transform3d begin = inverse(a.at(0)) * b.at(0), end = inverse(a.at(1)) * b.at(1);
  const Vec3d p0 = transform_point(begin, inner), p1 = transform_point(end, inner);
  // The core stays within this of the straight way of its inner point, in the surface's frame.
  const double size = double(detail::outer_size(c)) + math::length(inner) + double(c.radius);
  const double swing =
      b.most_rate * math::length(inner - b.local_center) + a.most_rate * (math::length(p0) + math::length(p1));
  const double around = (size + target) * 1.001 + swing;
  const Vec3f low = Vec3f(min(p0, p1)), high = Vec3f(max(p0, p1));
  const Bounds3f box = grow(Bounds3f{low, high}, float(around));
  if (detail::inside_ground(surface, Vec3f(p0))) return {ImpactState::overlapped, 0};

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

}  // namespace toi3

TimeOfImpact time_of_impact(const Shape3& a, const Sweep3& sweep_a, const Shape3& b, const Sweep3& sweep_b,
                            float target) {
  using namespace toi3;
  if (a.type == ShapeType3::compound || b.type == ShapeType3::compound) {
    TimeOfImpact first;
    const bool split_a = a.type == ShapeType3::compound;
    for (const CompoundChild& c : (split_a ? a : b).compound->children)
      keep_first(first, split_a ? time_of_impact(c.shape, detail::sweep_of_part(sweep_a, c.local), b, sweep_b, target)
                                : time_of_impact(a, sweep_a, c.shape, detail::sweep_of_part(sweep_b, c.local), target));
    return first;
  }
  const Motion3 ma(sweep_a), mb(sweep_b);
  const double near = max(double(target), 1e-6);
  if (is_convex(a) && is_convex(b)) return cores(detail::convex_of(a), ma, detail::convex_of(b), mb, near, 1);
  if (is_convex(a) && b.type == ShapeType3::plane) return plane(b.plane, mb, detail::convex_of(a), ma, near, 1);
  if (is_convex(b) && a.type == ShapeType3::plane) return plane(a.plane, ma, detail::convex_of(b), mb, near, 1);
  if (is_convex(a) && b.type != ShapeType3::plane) return on_surface(b, mb, detail::convex_of(a), ma, near);
  if (is_convex(b) && a.type != ShapeType3::plane) return on_surface(a, ma, detail::convex_of(b), mb, near);
  return {ImpactState::failed, 1};
}

}  // namespace carom::geometry
