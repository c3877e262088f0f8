#include "carom/geometry/detail/rounded2.h"

namespace carom::geometry::detail {

static Rounded2 line(Vec2f a, Vec2f b, float radius) {
  Rounded2 r;
  r.radius = radius;
  r.v[0] = a, r.v[1] = b;
  const Vec2f t = normalize(b - a);
  r.n[0] = {t.y, -t.x}, r.n[1] = {-t.y, t.x};
  r.count = t == Vec2f{} ? 1 : 2;
  return r;
}

Rounded2 rounded_of(const Shape2& s) {
  switch (s.type) {
    case ShapeType2::capsule: {
      Rounded2 r;
      r.radius = s.capsule.radius;
      r.v[0] = {0, -s.capsule.half_length}, r.v[1] = {0, s.capsule.half_length};
      r.n[0] = {1, 0}, r.n[1] = {-1, 0};
      r.count = s.capsule.half_length > 0 ? 2 : 1;
      return r;
    }
    case ShapeType2::polygon: {
      Rounded2 r;
      r.count = s.polygon.count;
      r.radius = s.polygon.radius;
      for (int i = 0; i < r.count; ++i) r.v[i] = s.polygon.vertices[i], r.n[i] = s.polygon.normals[i];
      return r;
    }
    case ShapeType2::segment:
      return line(s.segment.a, s.segment.b, 0);
    case ShapeType2::chain_segment:
      return line(s.chain_segment.a, s.chain_segment.b, 0);
    default: {
      Rounded2 r;
      r.count = 1;
      r.v[0] = {};
      r.radius = s.circle.radius;
      return r;
    }
  }
}

Rounded2 placed(const Rounded2& s, const Transform2f& t) {
  Rounded2 r;
  r.count = s.count;
  r.radius = s.radius;
  for (int i = 0; i < s.count; ++i) r.v[i] = transform_point(t, s.v[i]), r.n[i] = rotate(t.q, s.n[i]);
  return r;
}

Rounded2 placed(const Shape2& s, const Transform2f& t) {
  if (s.type != ShapeType2::polygon) return placed(rounded_of(s), t);
  Rounded2 r;
  r.count = s.polygon.count;
  r.radius = s.polygon.radius;
  for (int i = 0; i < r.count; ++i) {
    r.v[i] = transform_point(t, s.polygon.vertices[i]);
    r.n[i] = rotate(t.q, s.polygon.normals[i]);
  }
  return r;
}

Vec2f center_of(const Rounded2& s) {
  Vec2f sum{};
  for (int i = 0; i < s.count; ++i) sum += s.v[i];
  return sum * (1.0f / float(s.count));
}

float size_of(const Rounded2& s) {
  if (s.count < 3) return s.radius;
  const Vec2f c = center_of(s);
  float least = 3.4e38f;
  for (int i = 0; i < s.count; ++i) least = min(least, dot(s.n[i], s.v[i] - c));
  return least + s.radius;
}

float separation_along(const Rounded2& a, int edge, const Rounded2& b) {
  const Vec2f n = a.n[edge];
  float least = dot(n, b.v[0]);
  for (int i = 1; i < b.count; ++i) least = min(least, dot(n, b.v[i]));
  return least - dot(n, a.v[edge]);
}

EdgeAxis best_edge(const Rounded2& a, const Rounded2& b) {
  EdgeAxis best;
  if (a.count < 2) return best;
  for (int i = 0; i < a.count; ++i) {
    const float s = separation_along(a, i, b);
    if (s > best.separation) best = {i, s};
  }
  return best;
}

Vec2f closest_on_line(Vec2f a, Vec2f b, Vec2f p) {
  const Vec2f d = b - a;
  const float l2 = dot(d, d);
  return l2 > 0 ? a + d * clamp(dot(p - a, d) / l2, 0.0f, 1.0f) : a;
}

void closest_of_lines(Vec2f a0, Vec2f a1, Vec2f b0, Vec2f b1, Vec2f& p, Vec2f& q) {
  const Vec2f da = a1 - a0, db = b1 - b0;
  const float a2 = dot(da, da), b2 = dot(db, db);
  const float ia = a2 > 0 ? 1 / a2 : 0, ib = b2 > 0 ? 1 / b2 : 0;
  const auto on_a = [&](Vec2f c) { return a0 + da * clamp(dot(c - a0, da) * ia, 0.0f, 1.0f); };
  const auto on_b = [&](Vec2f c) { return b0 + db * clamp(dot(c - b0, db) * ib, 0.0f, 1.0f); };
  const Vec2f on[4][2] = {{a0, on_b(a0)}, {a1, on_b(a1)}, {on_a(b0), b0}, {on_a(b1), b1}};
  float least = 3.4e38f;
  for (const auto& pair : on) {
    const float d = distance_squared(pair[0], pair[1]);
    if (d < least) least = d, p = pair[0], q = pair[1];
  }
}

// Apart, the separation along the edge normals is greatest at a border of the cone of normals in which the closest
// direction lies, so the edge found and the corner it sees belong to the closest features.
CoreDistance2 core_distance(const Rounded2& a, const Rounded2& b) {
  return core_distance(a, b, best_edge(a, b), best_edge(b, a));
}

CoreDistance2 core_distance(const Rounded2& a, const Rounded2& b, const EdgeAxis& ea, const EdgeAxis& eb) {
  CoreDistance2 out;
  const float best = max(ea.separation, eb.separation);
  const bool points = a.count == 1 && b.count == 1;
  const bool flat = a.count <= 2 && b.count <= 2;  // lines in line part along no normal of theirs
  const float scale =
      flat ? length(b.v[0] - a.v[0]) + length(a.v[a.count - 1] - a.v[0]) + length(b.v[b.count - 1] - b.v[0]) : 0;
  if (points || best > 0 || (flat && best > -1e-6f * scale)) {
    if (points) {
      out.point_a = a.v[0], out.point_b = b.v[0];
    } else if (flat) {
      closest_of_lines(a.v[0], a.v[a.count - 1], b.v[0], b.v[b.count - 1], out.point_a, out.point_b);
    } else {
      const bool of_a = ea.separation >= eb.separation;
      const Rounded2 &r = of_a ? a : b, &s = of_a ? b : a;
      const int e = of_a ? ea.edge : eb.edge;
      int corner = 0;
      for (int i = 1; i < s.count; ++i)
        if (dot(r.n[e], s.v[i]) < dot(r.n[e], s.v[corner])) corner = i;
      Vec2f p, q, p2, q2;
      closest_of_lines(r.v[e], r.v[r.next(e)], s.v[s.before(corner)], s.v[corner], p, q);
      closest_of_lines(r.v[e], r.v[r.next(e)], s.v[corner], s.v[s.next(corner)], p2, q2);
      if (distance_squared(p2, q2) < distance_squared(p, q)) p = p2, q = q2;
      // The closest corner may lie round the end of the edge. Between its ends what is nearest there is nearest of all.
      const Vec2f edge = r.v[r.next(e)] - r.v[e];
      const float along = dot(p - r.v[e], edge), whole = dot(edge, edge);
      if (along < 1e-3f * whole) {
        closest_of_lines(r.v[r.before(e)], r.v[e], s.v[corner], s.v[s.next(corner)], p2, q2);
        if (distance_squared(p2, q2) < distance_squared(p, q)) p = p2, q = q2;
      }
      if (along > 0.999f * whole) {
        closest_of_lines(r.v[r.next(e)], r.v[r.next(r.next(e))], s.v[s.before(corner)], s.v[corner], p2, q2);
        if (distance_squared(p2, q2) < distance_squared(p, q)) p = p2, q = q2;
      }
      out.point_a = of_a ? p : q, out.point_b = of_a ? q : p;
    }
    const Vec2f d = out.point_b - out.point_a;
    out.distance = length(d);
    const Vec2f fallback =
        ea.separation >= eb.separation && a.count > 1 ? a.n[ea.edge] : (b.count > 1 ? -b.n[eb.edge] : Vec2f{0, 1});
    out.normal = normalize_or(d, fallback, 1e-12f);
    return out;
  }
  const bool of_a = ea.separation >= eb.separation;
  const Rounded2 &r = of_a ? a : b, &s = of_a ? b : a;
  const int e = of_a ? ea.edge : eb.edge;
  int corner = 0;
  for (int i = 1; i < s.count; ++i)
    if (dot(r.n[e], s.v[i]) < dot(r.n[e], s.v[corner])) corner = i;
  const Vec2f on_s = s.v[corner], on_r = on_s - r.n[e] * best;
  out.distance = best;
  out.point_a = of_a ? on_r : on_s, out.point_b = of_a ? on_s : on_r;
  out.normal = of_a ? r.n[e] : -r.n[e];
  return out;
}

}  // namespace carom::geometry::detail
