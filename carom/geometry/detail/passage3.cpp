#include "carom/geometry/detail/passage.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/swept3.h"

namespace carom::geometry::detail {
namespace passage3 {

/// What stands for the inner parts of a shape.
struct Guard {
  Convex core;
  Transform3d local{};
};

/// The line between the farthest corner from the centroid and the one opposite, drawn in by `by`.
bool longest_line(const Hull& hull, float by, Vec3f& from, Vec3f& to) {
  from = to = hull.centroid;
  float most = 0;
  for (const Vec3f& v : hull.vertices)
    if (const float d = math::distance_squared(v, hull.centroid); d > most) most = d, from = v;
  most = 0;
  for (const Vec3f& v : hull.vertices)
    if (const float d = dot(v - hull.centroid, hull.centroid - from); d > most) most = d, to = v;
  const Vec3f way = to - from;
  const float length = math::length(way);
  if (!(length > 2.5f * by)) return false;
  from += way * (by / length), to -= way * (by / length);
  return true;
}

/// One or two.
int guards_of(const Shape3& s, float inner, Guard (&out)[2]) {
  const float by = 0.75f * inner;
  Convex c = convex_of(s);
  switch (s.type) {
    case ShapeType3::capsule:
      c.radius -= by;
      break;
    case ShapeType3::box:
    case ShapeType3::cylinder: {
      const float least = c.radius - by;
      c.half = c.half + Vec3f{least, least, least};
      c.radius = 0;
      break;
    }
    case ShapeType3::ellipsoid:
      c.half = c.half - Vec3f{by, by, by};
      break;
    case ShapeType3::hull: {
      out[1].core.radius = 0.25f * inner;
      out[1].local.p = Vec3d(s.hull->centroid);
      Vec3f a, b;
      if (!longest_line(*s.hull, by, a, b)) break;
      const Vec3f way = b - a;
      const float length = math::length(way);
      out[0].core.kind = CoreKind::segment;
      out[0].core.half = {0, 0.5f * length, 0};
      out[0].core.radius = 0.125f * inner;
      // From local y to the line.
      const Quatf turn = way.y > -0.999f * length
                             ? normalize(Quatf{1 + way.y / length, cross(Vec3f{0, 1, 0}, way / length)})
                             : Quatf{0, {1, 0, 0}};
      out[0].local = {Vec3d((a + b) * 0.5f), Quatd(turn)};
      return 2;
    }
    default:
      break;
  }
  if (s.type == ShapeType3::sphere || s.type == ShapeType3::cone || s.type == ShapeType3::hull) {
    out[0].local.p = Vec3d(inner_point(c));
    c = {};
    c.radius = 0.25f * inner;
  }
  out[0].core = c;
  return 1;
}

struct Search {
  const Passage3& passage;
  const Motion3 a, b;
  const Convex core;
  const Swept<Vec3d> swept_core;
  Transform3d start, end;  ///< of a in the frame of b
  double inner, shallow, target = stop_distance;
  double sagitta;  ///< m: no point strays farther from between its ends
  double limit;
  Guard guards[2];
  int guard_count = 0;

  Search(const Passage3& p, const Sweep3& other, float most)
      : passage(p),
        a(p.sweep),
        b(other),
        core(convex_of(p.shape)),
        swept_core(swept(core, a)),
        start(inverse(b.at(0)) * a.at(0)),
        end(inverse(b.at(1)) * a.at(1)),
        inner(p.inner),
        shallow(min(0.25 * inner, 0.005 + 0.01 * inner)),
        sagitta(a.sagitta * (math::length(swept_core.arm) + swept_core.reach)),
        limit(most) {
    if (!b.turns()) return;
    // Seen from what turns, the turns of both add, and a straight way bends: at a part t of a turn θ by t (1 − t) θ of
    // the way, so by a quarter of θ at most, and a little more as the turn is not even.
    const double size = a.turns() ? math::length(swept_core.arm) + swept_core.reach
                                  : math::length(a.local_center) + double(outer_size(core));
    const Vec3d from = transform_point(start, a.local_center) - b.local_center,
                to = transform_point(end, a.local_center) - b.local_center;
    sagitta = square(math::sqrt(a.sagitta) + math::sqrt(b.sagitta)) * size +
              b.sagitta * max(math::length(from), math::length(to)) + 0.3 * b.most_rate * math::length(to - from);
  }

  /// The height of the lowest point of a core of `a` over a plane of b.
  static double lowest(const Convex& c, const Transform3d& at, Vec3d n, double offset) {
    const Vec3d p = support(c, inverse_rotate(at.q, -n));
    return dot(n, transform_point(at, p)) - offset - double(c.radius);
  }
  /// Is a at most shallow under a plane of b, and was it never behind it? Then it does not pass what lies under that.
  bool clears(Vec3d n, double offset) const {
    const double most = 0.5 * inner;
    if (lowest(core, end, n, offset) < max(-shallow, sagitta - most)) return false;
    return sagitta <= 0.25 * inner || lowest(core, start, n, offset) >= sagitta - most;
  }
  /// The same for the six planes of a box about b, of the boxes about a.
  bool clears(const Bounds3f& from, const Bounds3f& to, const Bounds3f& about) const {
    const float at_end = float(max(-shallow, sagitta - 0.5 * inner)), at_start = float(sagitta - 0.5 * inner);
    for (int k = 0; k < 3; ++k) {
      if (to.low[k] - about.high[k] >= at_end && from.low[k] - about.high[k] >= at_start) return true;
      if (about.low[k] - to.high[k] >= at_end && about.low[k] - from.high[k] >= at_start) return true;
    }
    return false;
  }

  /// Does a keep beside b along the direction, the same all the time, in which their middles fly past each other? For
  /// what turns, where planes of b see a bent way.
  bool flies_past(const Convex& part) const {
    const Transform3d at_a[2] = {a.at(0), a.at(1)}, at_b[2] = {b.at(0), b.at(1)};
    const Vec3d inside_a(inner_point(core)), inside_b(inner_point(part));
    const Vec3d from = transform_point(at_a[0], inside_a) - transform_point(at_b[0], inside_b),
                way = transform_point(at_a[1], inside_a) - transform_point(at_b[1], inside_b) - from;
    const double square_of_way = length_squared(way);
    const double t = square_of_way > 0 ? clamp(-dot(from, way) / square_of_way, 0.0, 1.0) : 0.0;
    const Vec3d between = from + way * t;
    const double apart = math::length(between);
    if (!(apart > 1e-3)) return false;
    const Vec3d n = between * (1 / apart);
    double height[2];
    for (int k = 0; k < 2; ++k) {
      const Vec3d top = transform_point(at_b[k], support(part, inverse_rotate(at_b[k].q, n)));
      height[k] = lowest(core, at_a[k], n, dot(n, top) + double(part.radius));
    }
    const Swept<Vec3d> swept_part = swept(part, b);
    const double stray = a.sagitta * (math::length(swept_core.arm) + swept_core.reach) +
                         b.sagitta * (math::length(swept_part.arm) + swept_part.reach),
                 most = 0.5 * inner;
    return height[1] >= max(-shallow, stray - most) && height[0] >= stray - most;
  }

  void keep(const TimeOfImpact& t) {
    if (t.state == ImpactState::hit) limit = min(limit, double(t.time));
  }

  /// Where the inner parts of what touches already would come too near. `gap_of(guard)` gives the distance of a guard.
  template <class GapOf, class Closing>
  void guard(GapOf&& gap_of, Closing&& closing) {
    if (guard_count == 0) guard_count = guards_of(passage.shape, passage.inner, guards);
    for (int i = 0; i < guard_count; ++i) {
      Guard held = guards[i];
      const bool shrinks = held.core.kind == CoreKind::box || held.core.kind == CoreKind::segment ||
                           held.core.kind == CoreKind::cylinder;
      double first = 0;
      float less = passage.inner;
      // Where it is too late for this one (the end of a rod is in a wall already), for what lies farther inside.
      for (int tries = 0; tries < (shrinks ? 5 : 1); ++tries, less *= 2) {
        if (tries > 0) held.core.half = max(held.core.half - Vec3f{less, less, less}, Vec3f{});
        Vec3d n{};
        first = gap_of(held)(0, n);
        if (first > 1e-6) break;
      }
      if (!(first > 1e-6)) continue;
      const Swept<Vec3d> s = swept(held.core, a, held.local);
      auto gap = gap_of(held);
      const double near = min(min(target, 0.25 * inner), 0.5 * first);
      keep(advance<Vec3d>(
          near, limit, gap, [&](double t, Vec3d along) { return closing(t, along, s); },
          [](double, Vec3d) { return false; }));
    }
  }

  /// `part` is convex and stands in the frame of b.
  void meet(const Convex& part) {
    const Swept<Vec3d> swept_part = swept(part, b);
    const auto closing = [&](double t, Vec3d n, const Swept<Vec3d>& s) {
      return a.speed(n, s, t) + b.speed(-n, swept_part, t);
    };
    const double bend = bend_of(b, swept_part);
    CoreGap gap{core, part, a, b, 4 * target, bend + bend_of(a, swept_core)};
    const TimeOfImpact t = advance<Vec3d>(
        target, limit, gap, [&](double time, Vec3d n) { return closing(time, n, swept_core); },
        [&](double time, Vec3d n) {
          const Transform3d at = b.at(time);
          const Vec3d out = inverse_rotate(at.q, -n);
          return clears(out, dot(out, support(part, out)) + double(part.radius));
        });
    if (t.state == ImpactState::hit && t.time > 0) return keep(t);
    if (t.state == ImpactState::separated || !passage.guarded) return;
    guard(
        [&](const Guard& g) {
          return CoreGap{g.core, part, a, b, 4 * target, bend + bend_of(a, swept(g.core, a, g.local)), g.local};
        },
        closing);
  }
  void meet_plane(const Plane& plane) {
    const Vec3d normal(plane.normal);
    if (clears(normal, 0)) return;
    const auto gap_of = [&](const Convex& c, const Transform3d& local) {
      return [this, &c, local, normal](double t, Vec3d& n) {
        const Transform3d at = inverse(b.at(t)) * a.at(t) * local;
        n = -rotate(b.rotation(t), normal);
        return lowest(c, at, normal, 0);
      };
    };
    // Planes stand still: their own turning would move them by unbounded amounts.
    const auto closing = [&](double t, Vec3d n, const Swept<Vec3d>& s) { return a.speed(n, s, t) - dot(b.way, n); };
    const TimeOfImpact t = advance<Vec3d>(
        target, limit, gap_of(core, {}), [&](double time, Vec3d n) { return closing(time, n, swept_core); },
        [](double, Vec3d) { return false; });
    if (t.state == ImpactState::hit && t.time > 0) return keep(t);
    if (t.state == ImpactState::separated || !passage.guarded) return;
    guard([&](const Guard& g) { return gap_of(g.core, g.local); }, closing);
  }
  void meet_surface(const Shape3& surface, const Bounds3f& box) {
    const Vec3d inside(inner_point(core));
    const Vec3d from = transform_point(start, inside);
    visit_triangles(surface, box, false, [&](const SurfaceTriangle& t) {
      const Vec3d p(t.corner[0]), across = cross(Vec3d(t.corner[1]) - p, Vec3d(t.corner[2]) - p);
      if (dot(across, from - p) < 0) return true;  // from behind
      const Vec3d n = normalize(across);
      if (clears(n, dot(n, p))) return true;
      meet(convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]));
      return limit > 0;
    });
  }
};

}  // namespace passage3

float free_fraction(const Passage3& a, const Shape3& b, const Sweep3& b_sweep, float limit) {
  if (!is_convex(a.shape)) return limit;
  passage3::Search search(a, b_sweep, limit);
  if (b.type == ShapeType3::plane) {
    search.meet_plane(b.plane);
  } else {
    const Bounds3f from = bounds(a.shape, in_float(search.start)), to = bounds(a.shape, in_float(search.end));
    if (is_convex(b)) {
      if (search.clears(from, to, bounds(b, {}))) return limit;
      const Convex part = convex_of(b);
      if (!search.b.turns() || !search.flies_past(part)) search.meet(part);
    } else if (is_surface(b)) {
      const Bounds3f all = merge(from, to);
      const Vec3f most = max(abs(all.low), abs(all.high));
      search.meet_surface(b, grow(all, float(search.sagitta) + 1e-6f * max(most.x, max(most.y, most.z))));
    }
  }
  return float(search.limit);
}

Bounds3f swept_bounds(const Shape3& shape, const Sweep3& sweep) {
  const auto at = [&](const Vec3f& center, const Quatf& rotation) {
    const Quatf q = normalize(rotation);
    return bounds(shape, Transform3f{center - rotate(q, sweep.local_center), q});
  };
  const Bounds3f all = merge(at(sweep.c0, sweep.q0), at(sweep.c1, sweep.q1));
  if (sweep.q0 == sweep.q1 || !is_convex(shape)) return all;
  // How far the arc of a point strays from its chord: 1 − cos(θ/2) of its arm, with cos(θ/2) the product of the two.
  const float cosine =
      math::abs(dot(sweep.q0, sweep.q1)) / math::sqrt(dot(sweep.q0, sweep.q0) * dot(sweep.q1, sweep.q1));
  const Convex core = convex_of(shape);
  const Vec3d middle(inner_point(core));
  const float arm = math::length(Vec3f(middle) - sweep.local_center) + float(reach_about(core, middle));
  return grow(all, (1 - cosine + 2e-7f) * 1.0001f * arm);
}

}  // namespace carom::geometry::detail
