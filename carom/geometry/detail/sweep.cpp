// A core swept by a ball is met where a point meets the core's Minkowski sum with that ball: balls at corners,
// cylinders along edges, faces moved out (Ericson 2005, §5.5). Sharp polyhedra meet where the last of their separating
// axes closes (Gottschalk 1996; for motions Eberly 2001).
#include "carom/geometry/detail/sweep.h"

namespace carom::geometry::detail {
namespace sweep {

/// A point on its way, seen from where it comes near the target, so that squares of long ways do not cancel.
struct Oncoming {
  Vec3d from, way;
  double start = 0, limit = 1;  ///< of the whole way: where `from` is, and the end

  /// False where the way misses the ball of `reach` about `center`.
  bool toward(Vec3d center, double reach) {
    const double way2 = dot(way, way);
    if (!(way2 > 0)) return false;
    const Vec3d m = from - center;
    const double m2 = dot(m, m), along = dot(m, way);
    if (m2 <= reach * reach) return true;
    if (!(along < 0)) return false;
    const double nearest = -along / way2;
    if (length_squared(m + way * nearest) > reach * reach) return false;
    const double begin = nearest - reach / math::sqrt(way2);
    if (begin > limit) return false;
    if (begin > 0) start = begin, from += way * begin, limit -= begin;
    return true;
  }
};

struct First {
  double time;  ///< of the rest of the way; nothing was met before
  bool hit = false;
  Vec3d normal{}, core{};
  void offer(double t, Vec3d n, Vec3d p) {
    if (t < time || (!hit && t <= time)) time = t, hit = true, normal = n, core = p;
  }
};

void meet_ball(Vec3d o, Vec3d d, Vec3d center, double r, First& first) {
  const Vec3d m = o - center;
  const double b = dot(m, d), c = dot(m, m) - r * r;
  if (!(b < 0) || c < 0) return;
  const double discriminant = b * b - dot(d, d) * c;
  if (discriminant < 0) return;
  const double t = c / (math::sqrt(discriminant) - b);
  if (t <= first.time) first.offer(t, m + d * t, center);
}

/// The side of the cylinder about the segment from a by e.
void meet_side(Vec3d o, Vec3d d, Vec3d a, Vec3d e, double r, First& first) {
  const Vec3d m = o - a;
  const double ee = dot(e, e), de = dot(d, e), me = dot(m, e);
  const double A = ee * dot(d, d) - de * de, B = ee * dot(m, d) - de * me, C = ee * (dot(m, m) - r * r) - me * me;
  if (!(B < 0) || C < 0 || !(A > 0)) return;
  const double discriminant = B * B - A * C;
  if (discriminant < 0) return;
  const double t = C / (math::sqrt(discriminant) - B);
  const double s = me + de * t;
  if (t > first.time || s < 0 || s > ee) return;
  first.offer(t, m + d * t - e * (s / ee), a + e * (s / ee));
}

/// The parallelogram at a with sides u and v, seen from both sides, moved out by r.
void meet_parallelogram(Vec3d o, Vec3d d, Vec3d a, Vec3d u, Vec3d v, double r, First& first) {
  Vec3d n = cross(u, v);
  const double nn = dot(n, n);
  if (!(nn > 0)) return;
  const Vec3d m = o - a;
  double height = dot(n, m), speed = dot(n, d);
  if (height < 0) n = -n, height = -height, speed = -speed;
  const double size = math::sqrt(nn), above = height - r * size;
  if (!(speed < 0) || above < 0 || above > -speed * first.time) return;
  const double t = above / -speed;
  const Vec3d p = m + d * t;
  const Vec3d w = cross(u, v);
  const double s = triple(p, v, w), k = triple(u, p, w);
  if (s < 0 || k < 0 || s > nn || k > nn) return;
  first.offer(t, n, a + (u * s + v * k) * (1 / nn));
}

double clamped(double x) { return math::clamp(x, 0.0, 1.0); }

double segment_distance_squared(Vec3d p, Vec3d a, Vec3d e) {
  const double ee = dot(e, e);
  return length_squared(p - a - e * (ee > 0 ? clamped(dot(p - a, e) / ee) : 0));
}

/// Of the segments from a by u and from b by v (Ericson 2005, §5.1.9).
double segments_distance_squared(Vec3d a, Vec3d u, Vec3d b, Vec3d v) {
  const Vec3d w = a - b;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const double across = uu * vv - uv * uv;
  double s = across > 1e-14 * uu * vv ? clamped((uv * vw - uw * vv) / across) : 0;
  const double t = vv > 0 ? clamped((uv * s + vw) / vv) : 0;
  s = uu > 0 ? clamped((uv * t - uw) / uu) : 0;
  return length_squared(w + u * s - v * t);
}

/// A triangle with its unnormalised normal.
struct Corners {
  Vec3d p[3], normal;
  explicit Corners(const Convex& c) : p{Vec3d(c.corner[0]), Vec3d(c.corner[1]), Vec3d(c.corner[2])} {
    normal = cross(p[1] - p[0], p[2] - p[0]);
  }
  bool above(Vec3d q) const {
    return triple(normal, p[1] - p[0], q - p[0]) >= 0 && triple(normal, p[2] - p[1], q - p[1]) >= 0 &&
           triple(normal, p[0] - p[2], q - p[2]) >= 0;
  }
  double distance_squared(Vec3d q) const {
    if (above(q)) return square(dot(normal, q - p[0])) / dot(normal, normal);
    return min(segment_distance_squared(q, p[0], p[1] - p[0]),
               min(segment_distance_squared(q, p[1], p[2] - p[1]), segment_distance_squared(q, p[2], p[0] - p[2])));
  }
  Vec3d nearest(Vec3d q) const {
    if (above(q)) return q - normal * (dot(normal, q - p[0]) / dot(normal, normal));
    Vec3d best{};
    double least = 1e300;
    for (int i = 0; i < 3; ++i) {
      const Vec3d e = p[(i + 1) % 3] - p[i];
      const Vec3d at = p[i] + e * clamped(dot(q - p[i], e) / dot(e, e));
      if (length_squared(q - at) < least) least = length_squared(q - at), best = at;
    }
    return best;
  }
  /// Of the segment from a by u.
  double distance_squared(Vec3d a, Vec3d u) const {
    const double begin = dot(normal, a - p[0]), rise = dot(normal, u);
    if (begin * (begin + rise) <= 0 && rise != 0 && above(a - u * (begin / rise))) return 0;
    double least = min(distance_squared(a), distance_squared(a + u));
    for (int i = 0; i < 3; ++i) least = min(least, segments_distance_squared(p[i], p[(i + 1) % 3] - p[i], a, u));
    return least;
  }
};

/// A point against a triangle swept by a ball.
void meet_triangle(Vec3d o, Vec3d d, const Corners& c, Vec3d shift, double r, First& first) {
  Vec3d n = c.normal;
  const Vec3d m = o - c.p[0] - shift;
  double height = dot(n, m), speed = dot(n, d);
  if (height < 0) n = -n, height = -height, speed = -speed;
  const double size = math::sqrt(dot(n, n)), above = height - r * size;
  if (above > 0) {
    if (!(speed < 0) || above > -speed * first.time) return;
    const double t = above / -speed;
    const Vec3d p = o - shift + d * t;
    if (c.above(p)) {
      first.offer(t, n, p - n * (r / size) + shift);
      return;  // the sum is convex and its face is met
    }
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3d a = c.p[i];
    meet_side(o, d, a + shift, c.p[(i + 1) % 3] - a, r, first);
    meet_ball(o, d, a + shift, r, first);
  }
}

Sweep at_start(Vec3d p) {
  Sweep s;
  s.hit = true;
  s.core_point = p;
  return s;
}
Sweep result(const First& first, const Oncoming& way) {
  Sweep s;
  if (!first.hit) return s;
  s.hit = true;
  s.time = way.start + first.time;
  s.normal = normalize(first.normal);
  s.core_point = first.core;
  return s;
}

/// Time within which the intervals of every axis overlap.
struct Closing {
  double enter = -1e300, leave = 1e300, limit;
  Vec3d normal{};
  explicit Closing(double l) : limit(l) {}
  /// A's interval and B's (middle ± reach, moving at speed) along an axis; `even`: how much later an axis must close to
  /// be preferred to those before. False: never together within the limit.
  bool along(Vec3d axis, double low, double high, double middle, double reach, double speed, double even = 0) {
    const double to_low = low - (middle + reach), to_high = high - (middle - reach);
    if (speed == 0) return to_low <= 0 && to_high >= 0;
    const double in = (speed > 0 ? to_low : to_high) / speed, out = (speed > 0 ? to_high : to_low) / speed;
    if (in > enter + even) enter = in, normal = speed > 0 ? -axis : axis;
    leave = min(leave, out);
    return enter <= leave && enter <= limit && leave >= 0;
  }
  Sweep result(Vec3d start) const {
    if (enter < 0) return at_start(start);
    Sweep s;
    s.hit = true;
    s.time = enter;
    s.normal = normalize(normal);
    return s;
  }
};

/// A point in common to two convex sets that touch, by projecting onto one and the other (von Neumann 1949).
template <class OntoA, class OntoB>
Vec3d common_point(Vec3d from, OntoA&& onto_a, OntoB&& onto_b) {
  Vec3d p = onto_a(from);
  for (int i = 0; i < 24; ++i) {
    const Vec3d q = onto_b(p);
    const double apart = length_squared(q - p);
    const Vec3d next = onto_a(q);
    if (length_squared(next - q) >= 0.9999 * apart && i > 0) return next;
    p = next;
  }
  return p;
}
constexpr double edge_bias = 1e-9;  // faces before edges that close at the same moment

bool parallel(Vec3d axis, double scale) { return !(dot(axis, axis) > 1e-16 * scale); }

/// A box in A's frame, as its half sides.
struct Sides {
  Vec3d half[3];
  Sides(const Convex& c, const Mat3d& rotation) {
    half[0] = rotation * Vec3d{double(c.half.x), 0, 0};
    half[1] = rotation * Vec3d{0, double(c.half.y), 0};
    half[2] = rotation * Vec3d{0, 0, double(c.half.z)};
  }
  double reach(Vec3d axis) const {
    return math::abs(dot(half[0], axis)) + math::abs(dot(half[1], axis)) + math::abs(dot(half[2], axis));
  }
};

/// The corner, edge or face of a box, about `center`, that lies farthest along a unit direction.
struct FarSide {
  Vec3d middle, span[3];
  int count = 0;
  FarSide(Vec3d center, const Vec3d* half, Vec3d direction) : middle(center) {
    for (int k = 0; k < 3; ++k) {
      const double along = dot(half[k], direction);
      if (square(along) < 1e-8 * dot(half[k], half[k]))
        span[count++] = half[k];
      else
        middle += along > 0 ? half[k] : -half[k];
    }
  }
  Vec3d nearest(Vec3d p) const {
    Vec3d q = middle;
    for (int k = 0; k < count; ++k)
      q += span[k] * math::clamp(dot(p - middle, span[k]) / dot(span[k], span[k]), -1.0, 1.0);
    return q;
  }
};

bool box_on_triangle(const Corners& c, const Convex& b, const Mat3d& turn, Vec3d center, Vec3d way, double limit,
                     Sweep& out) {
  out = {};
  const Sides box(b, turn);
  Closing axes(limit);
  const auto test = [&](Vec3d axis, double even) {
    const double x = dot(axis, c.p[0]), y = dot(axis, c.p[1]), z = dot(axis, c.p[2]);
    return axes.along(axis, min(x, min(y, z)), max(x, max(y, z)), dot(axis, center), box.reach(axis), dot(axis, way),
                      even);
  };
  const double level = dot(c.normal, c.p[0]);
  if (!axes.along(c.normal, level, level, dot(c.normal, center), box.reach(c.normal), dot(c.normal, way))) return true;
  for (const Vec3d& side : box.half)
    if (!test(side, 0)) return true;
  for (int i = 0; i < 3; ++i) {
    const Vec3d edge = c.p[(i + 1) % 3] - c.p[i];
    for (const Vec3d& side : box.half) {
      const Vec3d axis = cross(edge, side);
      if (!parallel(axis, dot(edge, edge) * dot(side, side)) && !test(axis, edge_bias)) return true;
    }
  }
  out = axes.result(center);
  if (out.time == 0 && out.normal == Vec3d{}) return true;
  const FarSide far(center + way * out.time, box.half, -out.normal);
  if (far.count == 0)
    out.core_point = far.middle;
  else
    out.core_point =
        common_point(far.middle, [&](Vec3d p) { return c.nearest(p); }, [&](Vec3d p) { return far.nearest(p); });
  return true;
}

bool box_on_box(const Convex& a, const Convex& b, const Mat3d& turn, Vec3d center, Vec3d way, double limit,
                Sweep& out) {
  out = {};
  const Sides box(b, turn);
  const Vec3d half(a.half);
  Closing axes(limit);
  for (int k = 0; k < 3; ++k) {
    Vec3d axis{};
    axis[k] = 1;
    const double reach = math::abs(box.half[0][k]) + math::abs(box.half[1][k]) + math::abs(box.half[2][k]);
    if (!axes.along(axis, -half[k], half[k], center[k], reach, way[k])) return true;
  }
  const auto test = [&](Vec3d axis, double reach, double even) {
    const double own = dot(half, abs(axis));
    return axes.along(axis, -own, own, dot(axis, center), reach, dot(axis, way), even);
  };
  for (const Vec3d& side : box.half)
    if (!test(side, dot(side, side), 0)) return true;
  for (int k = 0; k < 3; ++k)
    for (const Vec3d& side : box.half) {
      const Vec3d axis =
          k == 0 ? Vec3d{0, -side.z, side.y} : (k == 1 ? Vec3d{side.z, 0, -side.x} : Vec3d{-side.y, side.x, 0});
      if (!parallel(axis, dot(side, side)) && !test(axis, box.reach(axis), edge_bias)) return true;
    }
  out = axes.result(center);
  if (out.time == 0 && out.normal == Vec3d{}) return true;
  const FarSide far(center + way * out.time, box.half, -out.normal);
  if (far.count == 0) {
    out.core_point = far.middle;
    return true;
  }
  const Vec3d own[3] = {{half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}};
  const FarSide near({}, own, out.normal);
  out.core_point =
      near.count == 0
          ? near.middle
          : common_point(far.middle, [&](Vec3d p) { return near.nearest(p); }, [&](Vec3d p) { return far.nearest(p); });
  return true;
}

/// A point against a box swept by a ball of r > 0.
void ball_on_box(const Convex& a, Vec3d center, Vec3d way, double r, double limit, Sweep& out) {
  out = {};
  const Vec3d half(a.half);
  const Vec3d inside = max(min(center, half), -half);
  if (length_squared(center - inside) <= r * r) {
    out = at_start(inside);
    return;
  }
  // The box grown by r, first: where its face is met over the sharp face, that is it.
  double enter = 0, leave = limit;
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    const double reach = half[k] + r;
    if (way[k] == 0) {
      if (math::abs(center[k]) > reach) return;
      continue;
    }
    const double to_low = (-reach - center[k]) / way[k], to_high = (reach - center[k]) / way[k];
    const double in = min(to_low, to_high);
    if (in > enter) enter = in, axis = k;
    leave = min(leave, max(to_low, to_high));
  }
  if (enter > leave) return;
  Oncoming on{center + way * enter, way, enter, limit - enter};
  const Vec3d p = on.from;
  const Vec3d core = max(min(p, half), -half);
  const int outside = (math::abs(p.x) > half.x) + (math::abs(p.y) > half.y) + (math::abs(p.z) > half.z);
  if (axis >= 0 && outside == 1) {
    First face{0};
    Vec3d n{};
    n[axis] = p[axis] > 0 ? 1 : -1;
    face.offer(0, n, core);
    out = result(face, on);
    return;
  }
  First first{on.limit};
  for (int k = 0; k < 3; ++k) {
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    for (int s = 0; s < 4; ++s) {
      Vec3d a0{}, edge{};
      a0[k] = -half[k], edge[k] = 2 * half[k];
      a0[u] = s & 1 ? half[u] : -half[u];
      a0[v] = s & 2 ? half[v] : -half[v];
      // Only edges on the sides by which it comes.
      if (a0[u] * way[u] > 0 && a0[v] * way[v] > 0) continue;
      meet_side(p, way, a0, edge, r, first);
    }
  }
  for (int s = 0; s < 8; ++s)
    meet_ball(p, way, {s & 1 ? half.x : -half.x, s & 2 ? half.y : -half.y, s & 4 ? half.z : -half.z}, r, first);
  out = result(first, on);
}

/// A point against a segment (or a point) swept by a ball.
void ball_on_segment(Vec3d a, Vec3d e, Vec3d center, Vec3d way, double r, double limit, Sweep& out) {
  out = {};
  const double ee = dot(e, e);
  const Vec3d near = a + e * (ee > 0 ? clamped(dot(center - a, e) / ee) : 0);
  if (length_squared(center - near) <= r * r) {
    out = at_start(near);
    return;
  }
  Oncoming on{center, way, 0, limit};
  if (!on.toward(a + e * 0.5, r + 0.5 * math::sqrt(ee))) return;
  First first{on.limit};
  if (ee > 0) {
    meet_side(on.from, way, a, e, r, first);
    meet_ball(on.from, way, a + e, r, first);
  }
  meet_ball(on.from, way, a, r, first);
  out = result(first, on);
}

/// How many times u there is in p = x u + y v.
double along_of(Vec3d p, Vec3d u, Vec3d v) {
  const Vec3d w = cross(u, v);
  const double ww = dot(w, w);
  return ww > 0 ? triple(p, v, w) / ww : 0;
}

/// A ball or capsule (half segment `s`) against a triangle.
void capsule_on_triangle(const Corners& c, Vec3d center, Vec3d s, Vec3d way, double r, double limit, Sweep& out) {
  out = {};
  const bool ball = s == Vec3d{};
  const Vec3d middle = (c.p[0] + c.p[1] + c.p[2]) * (1.0 / 3);
  const double reach = math::sqrt(max(length_squared(c.p[0] - middle),
                                      max(length_squared(c.p[1] - middle), length_squared(c.p[2] - middle)))) +
                       r + (ball ? 0 : math::length(s));
  Oncoming on{center, way, 0, limit};
  const bool comes = on.toward(middle, reach);
  if (on.start == 0) {
    const double size2 = dot(c.normal, c.normal), high = math::abs(dot(c.normal, center - c.p[0]));
    const double thick = ball ? 0 : math::abs(dot(c.normal, s));
    if (high <= thick || square(high - thick) <= r * r * size2) {
      if ((ball ? c.distance_squared(center) : c.distance_squared(center - s, s * 2.0)) <= r * r) {
        out = at_start(center);
        return;
      }
    }
  }
  if (!comes) return;
  First first{on.limit};
  if (ball) {
    meet_triangle(on.from, way, c, {}, r, first);
  } else {
    // The segment's part of the sum is taken off the point that was met.
    const auto meet = [&](auto&& part) {
      First found{first.time};
      part(found);
      if (found.hit && (!first.hit || found.time < first.time)) first = found;
    };
    for (const Vec3d& end : {s, -s}) meet([&](First& f) { meet_triangle(on.from, way, c, end, r, f), f.core -= end; });
    for (int i = 0; i < 3; ++i) {
      const Vec3d side = c.p[(i + 1) % 3] - c.p[i];
      meet([&](First& f) { meet_side(on.from, way, c.p[i] - s, s * 2.0, r, f), f.core = c.p[i]; });
      meet([&](First& f) {
        meet_parallelogram(on.from, way, c.p[i] - s, side, s * 2.0, r, f);
        f.core = c.p[i] + side * along_of(f.core - c.p[i] + s, side, s);
      });
    }
  }
  out = result(first, on);
}

}  // namespace sweep

bool closed_cast(const Convex& a, const Convex& b, const Transform3f& x, Vec3d way, double limit, Sweep& out) {
  using namespace sweep;
  const Vec3d center(x.p);
  const double r = double(a.radius) + double(b.radius);
  const auto turn = [&] { return to_matrix(normalize(Quatd(x.q))); };
  if (a.kind == CoreKind::triangle) {
    if (b.kind == CoreKind::point) return capsule_on_triangle(Corners(a), center, {}, way, r, limit, out), true;
    if (b.kind == CoreKind::segment)
      return capsule_on_triangle(Corners(a), center, turn() * Vec3d(b.half), way, r, limit, out), true;
    return b.kind == CoreKind::box && r == 0 && box_on_triangle(Corners(a), b, turn(), center, way, limit, out);
  }
  if (b.kind == CoreKind::point) {
    if (a.kind == CoreKind::point || a.kind == CoreKind::segment)
      return ball_on_segment(-Vec3d(a.half), Vec3d(a.half) * 2.0, center, way, r, limit, out), true;
    if (a.kind == CoreKind::box && r > 0) return ball_on_box(a, center, way, r, limit, out), true;
    return false;
  }
  if (a.kind != CoreKind::box || b.kind != CoreKind::box || r != 0) return false;
  Oncoming near{center, way, 0, limit};
  const double reach = math::length(Vec3d(a.half)) + math::length(Vec3d(b.half));
  out = {};
  if (length_squared(center) > reach * reach && !near.toward({}, reach)) return true;
  return box_on_box(a, b, turn(), center, way, limit, out);
}

bool closed_overlap(const Convex& a, const Convex& b, const Transform3f& x, bool& overlap) {
  using namespace sweep;
  const Vec3d center(x.p);
  const double r = double(a.radius) + double(b.radius);
  Sweep s;
  if (b.kind == CoreKind::point) {
    switch (a.kind) {
      case CoreKind::point:
      case CoreKind::segment:
        overlap = segment_distance_squared(center, -Vec3d(a.half), Vec3d(a.half) * 2.0) <= r * r;
        return true;
      case CoreKind::box: {
        const Vec3d half(a.half);
        overlap = length_squared(center - max(min(center, half), -half)) <= r * r;
        return true;
      }
      case CoreKind::triangle: {
        const Corners c(a);
        const double high = dot(c.normal, center - c.p[0]);  // over the plane, times the normal's length
        overlap = high * high <= r * r * dot(c.normal, c.normal) && c.distance_squared(center) <= r * r;
        return true;
      }
      default:
        return false;
    }
  }
  if (b.kind != CoreKind::box || r != 0) return false;
  if (a.kind == CoreKind::box)
    box_on_box(a, b, to_matrix(normalize(Quatd(x.q))), center, {}, 0, s);
  else if (a.kind == CoreKind::triangle)
    box_on_triangle(Corners(a), b, to_matrix(normalize(Quatd(x.q))), center, {}, 0, s);
  else
    return false;
  overlap = s.hit;
  return true;
}

}  // namespace carom::geometry::detail
