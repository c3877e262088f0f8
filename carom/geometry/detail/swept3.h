// A convex core on its way.
#pragma once

#include "carom/geometry/detail/convex.h"
#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/motion.h"

namespace carom::geometry::detail {

/// The farthest point of a core from `center`.
inline double reach_about(const Convex& c, Vec3d center) {
  double most = 0;
  const auto see = [&](Vec3f p) { most = max(most, length_squared(Vec3d(p) - center)); };
  switch (c.kind) {
    case CoreKind::point:
      return math::length(center);
    case CoreKind::hull:
      for (const Vec3f& v : c.hull->vertices) see(v);
      break;
    case CoreKind::triangle:
      for (const Vec3f& v : c.corner) see(v);
      break;
    case CoreKind::segment:
    case CoreKind::box: {
      const Vec3d far = abs(center) + Vec3d(c.half);
      return math::length(far);
    }
    case CoreKind::ellipsoid:
      return max(double(c.half.x), max(double(c.half.y), double(c.half.z))) + math::length(center);
    case CoreKind::cylinder:
    case CoreKind::cone: {
      const double r = double(c.half.x) + math::sqrt(center.x * center.x + center.z * center.z);
      const double h = double(c.half.y) + math::abs(center.y);
      return math::sqrt(r * r + h * h);
    }
  }
  return math::sqrt(most);
}

/// Of a core that stands at `local` in what moves.
inline Swept<Vec3d> swept(const Convex& c, const Motion3& motion, const Transform3d& local = {}) {
  if (!motion.turns()) return {};
  const Vec3d middle(inner_point(c));
  return {transform_point(local, middle) - motion.local_center, reach_about(c, middle)};
}

/// The distance of a point from a point, a segment or a box, in closed form. False for other pairs, and where they
/// touch.
inline bool point_distance(const Placed& a, const Placed& b, CoreDistance& out) {
  const bool first = a.core->kind == CoreKind::point;
  const Placed &point = first ? a : b, &other = first ? b : a;
  if (point.core->kind != CoreKind::point || other.core->kind > CoreKind::box) return false;
  const Vec3d p = point.center(), l = (p - other.position) * other.rotation;
  Vec3d half{};
  if (other.core->kind != CoreKind::point) half = Vec3d(other.core->half);
  if (other.core->kind == CoreKind::segment) half.x = half.z = 0;
  const Vec3d nearest = max(min(l, half), -half), way = l - nearest;
  const double distance = math::length(way);
  if (!(distance > 1e-9)) return false;
  const Vec3d q = other.rotation * nearest + other.position, n = other.rotation * (way * (1 / distance));
  out.overlap = false;
  out.distance = distance;
  out.point_a = first ? p : q;
  out.point_b = first ? q : p;
  out.normal = first ? -n : n;
  return true;
}

/// The distance of two cores, for `advance`: remembers the last normal, and what it kept them apart by.
struct CoreGap {
  const Convex &a, &b;
  const Motion3 &motion_a, &motion_b;
  double near;            ///< m: above it, what a direction keeps them apart may stand for the distance
  double bend = 0;        ///< m a unit of time squared: how much the ways of both are bent
  Transform3d local_a{};  ///< of the core in what moves
  CoreDistance last{};
  double known = 1e30;  ///< m, the distance that was found last
  double end = -1;      ///< the time at which the last two of these stand
  Placed at_a{a}, at_b{b}, end_a{a}, end_b{b};

  double radii() const { return double(a.radius) + double(b.radius); }

  double operator()(double t, Vec3d& n) {
    at_a = Placed(a, motion_a.at(t) * local_a), at_b = Placed(b, motion_b.at(t));
    if (known < 1e30) {
      const double apart = dot(last.normal, at_b.support(-last.normal) - at_a.support(last.normal)) - radii();
      if (apart > near && apart > 0.25 * known) {
        n = last.normal;
        return apart;
      }
    }
    const Vec3d guess = last.normal;
    if (!point_distance(at_a, at_b, last)) core_clearance(at_a, at_b, radii(), near, 0.7, guess, last);
    n = last.normal;
    const double distance = last.overlap ? -1.0 : last.distance - radii();
    if (distance > 0) known = distance;
    return distance;
  }
  double clear_until(double t, Vec3d n, double distance, double target, double limit) {
    if (!(bend > 0)) return t;
    if (end != limit) {
      end = limit;
      end_a = Placed(a, motion_a.at(limit) * local_a), end_b = Placed(b, motion_b.at(limit));
    }
    const double apart = dot(n, end_b.support(-n) - end_a.support(n)) - radii(), span = limit - t;
    return t + span * clear_part(distance - target, apart - target, bend * span * span);
  }
};

}  // namespace carom::geometry::detail
