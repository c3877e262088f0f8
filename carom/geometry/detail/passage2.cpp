#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/detail/passage.h"
#include "carom/geometry/detail/swept2.h"

namespace carom::geometry::detail {
namespace passage2 {

/// The polygon less `by` along every edge. Something is left where that is less than its middle's distance from each.
Rounded2 drawn_in(const Rounded2& s, float by) {
  Vec2f from[2 * max_polygon_vertices], to[2 * max_polygon_vertices];
  int count = s.count;
  for (int i = 0; i < count; ++i) from[i] = s.v[i];
  for (int e = 0; e < s.count; ++e) {
    const float offset = dot(s.n[e], s.v[e]) - by;
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const Vec2f p = from[i], q = from[i + 1 < count ? i + 1 : 0];
      const float hp = dot(s.n[e], p) - offset, hq = dot(s.n[e], q) - offset;
      if (hp <= 0) to[kept++] = p;
      if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) to[kept++] = p + (q - p) * (hp / (hp - hq));
    }
    count = kept;
    for (int i = 0; i < count; ++i) from[i] = to[i];
  }
  Rounded2 r;
  for (int i = 0; i < count && r.count < max_polygon_vertices; ++i) {
    const Vec2f last = r.count > 0 ? r.v[r.count - 1] : from[count - 1];
    if (length(from[i] - last) > 0.01f * by) r.v[r.count++] = from[i];
  }
  if (r.count < 3) {
    r.count = 1;
    r.v[0] = center_of(s);
    return r;
  }
  for (int i = 0; i < r.count; ++i) {
    const Vec2f t = normalize(r.v[r.next(i)] - r.v[i]);
    r.n[i] = {t.y, -t.x};
  }
  return r;
}

/// What stands for the inner parts of a shape.
Rounded2 guard_of(const Rounded2& s, float inner) {
  Rounded2 g = s;
  if (s.count < 3) {
    g.radius = 0.25f * s.radius;
    return g;
  }
  const float by = 0.75f * min(inner, size_of(s));
  if (by <= s.radius) {
    g.radius = s.radius - by;
    return g;
  }
  return drawn_in(s, by - s.radius);
}

struct Search {
  const Passage2& passage;
  const Motion2 a, b;
  const Rounded2 core;
  const Swept<Vec2d> swept_core;
  Vec2d origin;            ///< the start's place, from which all is seen
  Transform2d start, end;  ///< of a in the frame of b
  double inner, shallow, target = stop_distance;
  double sagitta;  ///< m: no point strays farther from between its ends
  double limit;
  Rounded2 guard_core;
  bool has_guard = false;

  Search(const Passage2& p, const Sweep2& other, float most)
      : passage(p),
        a(p.sweep),
        b(other),
        core(rounded_of(p.shape)),
        swept_core(swept(core, a)),
        start(inverse(b.at(0)) * a.at(0)),
        end(inverse(b.at(1)) * a.at(1)),
        inner(p.inner),
        shallow(min(0.25 * inner, 0.005 + 0.01 * inner)),
        sagitta(a.sagitta * (math::length(swept_core.arm) + swept_core.reach)),
        limit(most) {
    if (b.turns())
      sagitta += b.sagitta * (max(math::length(start.p - b.local_center), math::length(end.p - b.local_center)) +
                              math::length(swept_core.arm) + swept_core.reach);
  }

  /// The height of the lowest point of a core of `a` over a line of b.
  static double lowest(const Rounded2& c, const Transform2d& at, Vec2d n, double offset) {
    double least = 1e300;
    for (int i = 0; i < c.count; ++i) least = min(least, dot(n, transform_point(at, Vec2d(c.v[i]))));
    return least - offset - double(c.radius);
  }
  /// Is a at most shallow under a line of b, and was it never behind it? Then it does not pass what lies under that.
  bool clears(Vec2d n, double offset) const {
    const double most = 0.5 * inner;
    if (lowest(core, end, n, offset) < max(-shallow, sagitta - most)) return false;
    return sagitta <= 0.25 * inner || lowest(core, start, n, offset) >= sagitta - most;
  }
  /// Does the lowest corner of a touch a line of b from the start, seen at a glance, or stand behind it, while the
  /// middle, which is in front, is over the line too?
  bool touches(const Rounded2& line, Vec2d n, double offset, Vec2d middle) const {
    Vec2d corner;
    double least = 1e300;
    for (int i = 0; i < core.count; ++i) {
      const Vec2d p = transform_point(start, Vec2d(core.v[i]));
      if (const double height = dot(n, p); height < least) least = height, corner = p;
    }
    if (least - offset - double(core.radius) > 0.5 * target) return false;
    const Vec2d first(line.v[0]), along(line.v[1] - line.v[0]);
    const auto over = [&](Vec2d p) {
      const double from = dot(along, p - first);
      return from >= 0 && from <= dot(along, along);
    };
    return over(corner) && (least >= offset || over(middle));
  }
  /// Does the guarded part of a, of which no point is nearer to its surface than this, stay above a line of b?
  bool guard_clears(Vec2d n, double offset) const {
    const double inset = 0.74 * double(core.count < 3 ? core.radius : min(float(inner), size_of(core)));
    return min(lowest(core, start, n, offset), lowest(core, end, n, offset)) + inset > sagitta + target + 1e-5;
  }
  /// Do the boxes about a stay so to one of the four sides of a box about b?
  bool clears(const Bounds2f& from, const Bounds2f& to, const Bounds2f& about) const {
    const float at_end = float(max(-shallow, sagitta - 0.5 * inner)), at_start = float(sagitta - 0.5 * inner);
    for (int k = 0; k < 2; ++k) {
      if (to.low[k] - about.high[k] >= at_end && from.low[k] - about.high[k] >= at_start) return true;
      if (about.low[k] - to.high[k] >= at_end && about.low[k] - from.high[k] >= at_start) return true;
    }
    return false;
  }

  void keep(const TimeOfImpact& t) {
    if (t.state == ImpactState::hit) limit = min(limit, double(t.time));
  }

  /// `part` is convex and stands in the frame of b; `front`: the normal of a line that stops only what is there.
  void meet(const Rounded2& part, const Vec2d* front = nullptr) {
    const Swept<Vec2d> swept_part = swept(part, b);
    CoreGap2 gap{core, part, a, b};
    const TimeOfImpact t = advance<Vec2d>(
        target, limit, gap,
        [&](double time, Vec2d n) { return a.speed(n, swept_core, time) + b.speed(-n, swept_part, time); },
        [&](double time, Vec2d n) {
          const Transform2d at = b.at(time, gap.origin);
          const Vec2d out = inverse_rotate(at.q, -n);
          return clears(out, dot(out, inverse_transform_point(at, Vec2d(gap.last.point_b))) + double(part.radius));
        });
    if (t.state == ImpactState::hit && t.time > 0) return keep(t);
    if (t.state == ImpactState::separated || !passage.guarded) return;
    guard(part, swept_part, front);
  }
  void guard(const Rounded2& part, const Swept<Vec2d>& swept_part, const Vec2d* front) {
    if (!has_guard) guard_core = guard_of(core, float(inner)), has_guard = true;
    if (stop_guard(guard_core, part, swept_part)) return;
    // A heap that falls on what is thin presses it in deeper step by step: then its middle must not pass.
    Rounded2 point;
    point.count = 1;
    point.v[0] = center_of(core);
    if (stop_guard(point, part, swept_part) || front == nullptr) return;
    // Nor, where the middle is in a line, what is still in front of that.
    const auto height = [&](Vec2f corner) { return dot(*front, transform_point(start, Vec2d(corner))); };
    for (int i = 0; i < core.count; ++i)
      if (height(core.v[i]) > height(point.v[0])) point.v[0] = core.v[i];
    stop_guard(point, part, swept_part);
  }
  /// False: it is too late, the guard stands at the surface or behind it.
  bool stop_guard(const Rounded2& guarded, const Rounded2& part, const Swept<Vec2d>& swept_part) {
    const Swept<Vec2d> s = swept(guarded, a);
    CoreGap2 gap{guarded, part, a, b};
    Vec2d n{};
    const double first = gap(0, n);
    if (!(first > min(1e-5, 0.01 * inner))) return false;
    const double near = min(min(target, 0.25 * inner), 0.5 * first);
    keep(advance<Vec2d>(
        near, limit, gap, [&](double t, Vec2d along) { return a.speed(along, s, t) + b.speed(-along, swept_part, t); },
        [](double, Vec2d) { return false; }));
    return true;
  }
  void meet_segment(const Shape2& segment) {
    const Rounded2 line = rounded_of(segment);
    if (line.count < 2) return meet(line);
    const Vec2d n(line.n[0]), p(line.v[0]);
    const Vec2d middle = transform_point(start, Vec2d(center_of(core)));
    if (dot(n, middle - p) < 0) return;  // from behind
    const double offset = dot(n, p);
    if (clears(n, offset)) return;
    if (touches(line, n, offset, middle) && (!passage.guarded || guard_clears(n, offset))) return;
    meet(line, &n);
  }
};

}  // namespace passage2

float free_fraction(const Passage2& a, const Shape2& b, const Sweep2& b_sweep, float limit) {
  if (a.shape.type == ShapeType2::chain || a.shape.type == ShapeType2::chain_segment) return limit;
  passage2::Search search(a, b_sweep, limit);
  const Bounds2f from = bounds(a.shape, in_float(search.start)), to = bounds(a.shape, in_float(search.end));
  if (b.type == ShapeType2::chain) {
    const Bounds2f all = merge(from, to);
    const Vec2f most = max(abs(all.low), abs(all.high));
    visit_segments(*b.chain, grow(all, float(search.sagitta) + 1e-6f * max(most.x, most.y)), [&](int i) {
      search.meet_segment(Shape2(b.chain->segment(i)));
      return search.limit > 0;
    });
  } else if (b.type == ShapeType2::chain_segment) {
    search.meet_segment(b);
  } else if (!search.clears(from, to, bounds(b, {}))) {
    search.meet(rounded_of(b));
  }
  return float(search.limit);
}

Bounds2f swept_bounds(const Shape2& shape, const Sweep2& sweep) {
  const Motion2 m(sweep);
  const Bounds2f all = merge(bounds(shape, in_float(m.at(0))), bounds(shape, in_float(m.at(1))));
  if (!m.turns() || shape.type == ShapeType2::chain) return all;
  const Swept<Vec2d> s = swept(rounded_of(shape), m);
  return grow(all, float(m.sagitta * (math::length(s.arm) + s.reach)));
}

}  // namespace carom::geometry::detail
