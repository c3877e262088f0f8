// Circles and capsules against each other and against polygons in closed form: the same as against_point() and
// polygons() of manifold2.cpp, in the frame of the shape with more corners.
#include "carom/geometry/detail/polygon_lanes.h"
#include "carom/geometry/detail/rounded2.h"
#include "carom/geometry/manifold.h"

namespace carom::geometry::detail {

void single_contact(Vec2f a, float ra, Vec2f b, float rb, Vec2f n, float d, std::uint32_t id, Manifold2& out) {
  const float s = d - ra - rb;
  out.normal = n;
  out.count = 1;
  out.points[0] = {(a + n * ra + b - n * rb) * 0.5f, s, id};
}

void between_points(Vec2f a, float ra, Vec2f b, float rb, float margin, std::uint32_t id, Manifold2& out) {
  const Vec2f d = b - a;
  const float l = length(d);
  const Vec2f n = l > 1e-12f ? d * (1 / l) : Vec2f{0, 1};
  if (l <= ra + rb + margin) return single_contact(a, ra, b, rb, n, l, id, out);
  out.normal = n;
  out.points[0].separation = l - ra - rb;
}

void over_border(Manifold2& m, Vec2f edge_normal, float above, float radius) {
  if (m.count == 0 || above - radius <= -min(0.005f * radius, 0.001f)) return;
  if (dot(m.normal, edge_normal) > 0.85f) {
    m.normal = edge_normal;
  } else if (m.points[0].separation > 0) {
    m.count = 0;
    m.normal = {};
  }
}

namespace round_pair {

using polygon_pair::greatest_of;
using polygon_pair::Lanes;
using polygon_pair::least_of;
using polygon_pair::place_of;
using polygon_pair::Vectors;

CAROM_SIMD_INLINE int next(const Polygon& p, int i) { return i + 1 < p.count ? i + 1 : 0; }

/// What was found in the frame of B, which x places in that of A, from B to A.
void seen_from_a(const Transform2f& x, Manifold2& m) {
  m.normal = -rotate(x.q, m.normal);
  for (int i = 0; i < m.count; ++i) m.points[i].point = transform_point(x, m.points[i].point);
}

/// A polygon and a circle about p, in the frame of the polygon; the normal points to the circle.
template <int N>
void polygon_circle(const Polygon& a, Vec2f p, float radius, float margin, Manifold2& out) {
  Vectors<N> v, n;
  v.load(a.vertices, a.count);
  n.load(a.normals, a.count);
  Lanes s[N], greatest = Lanes::splat(-3.4e38f);
  for (int k = 0; k < N; ++k) {
    s[k] = n.along(k, p) - (n.x[k] * v.x[k] + n.y[k] * v.y[k]);
    greatest = max(greatest, s[k]);
  }
  const float best = greatest_of(greatest);
  const int edge = place_of<N>(s, best);
  const Vec2f normal = a.normals[edge];
  if (best > a.radius + radius + margin) {
    out.normal = normal;
    out.points[0].separation = best - a.radius - radius;
    return;
  }
  if (best > 0) {
    const Vec2f q = closest_on_line(a.vertices[edge], a.vertices[next(a, edge)], p), d = p - q;
    if (dot(d, d) > 1e-12f * best && distance_squared(q, p) > best * best * 1.000001f) {  // round a corner
      between_points(q, a.radius, p, radius, margin, 0, out);
      if (a.radius == 0) over_border(out, normal, best, a.radius + radius);
      return;
    }
  }
  single_contact(p - normal * best, a.radius, p, radius, normal, best, 0, out);
}

/// A capsule's line.
struct Line {
  Vec2f end[2], normal;  ///< of the edge from end[0] to end[1]; the other side has the opposite

  CAROM_SIMD_INLINE Line(const Capsule2& c, const Transform2f& x) {
    const Vec2f half{-x.q.s * c.half_length, x.q.c * c.half_length};
    end[0] = x.p - half, end[1] = x.p + half;
    normal = {x.q.c, x.q.s};
  }
};

/// The closest points of a polygon and a line that lie apart; s[j]: how far its ends are from the edges.
template <int N>
CAROM_SIMD_INLINE float closest(const Polygon& a, const Vectors<N>& v, const Line& line, const Lanes (&s)[2][N],
                                Vec2f& on_a, Vec2f& on_line) {
  float least = 3.4e38f;
  for (int j = 0; j < 2; ++j) {
    Lanes greatest = s[j][0];
    for (int k = 1; k < N; ++k) greatest = max(greatest, s[j][k]);
    const float best = greatest_of(greatest);
    if (!(best > 0 && best * best < least)) continue;
    const int edge = place_of<N>(s[j], best);
    const Vec2f q = closest_on_line(a.vertices[edge], a.vertices[next(a, edge)], line.end[j]);
    const float d = distance_squared(q, line.end[j]);
    if (d < least) least = d, on_a = q, on_line = line.end[j];
  }
  const Vec2f along = line.end[1] - line.end[0];
  const float inverse = 1 / dot(along, along);
  const Lanes x0 = Lanes::splat(line.end[0].x), y0 = Lanes::splat(line.end[0].y);
  const Lanes ux = Lanes::splat(along.x), uy = Lanes::splat(along.y);
  Lanes t[N], d[N], nearest = Lanes::splat(3.4e38f);
  for (int k = 0; k < N; ++k) {
    const Lanes wx = v.x[k] - x0, wy = v.y[k] - y0;
    t[k] = min(max((wx * ux + wy * uy) * Lanes::splat(inverse), Lanes::splat(0)), Lanes::splat(1));
    const Lanes rx = wx - t[k] * ux, ry = wy - t[k] * uy;
    d[k] = rx * rx + ry * ry;
    nearest = min(nearest, d[k]);
  }
  const float corner_distance = least_of(nearest);
  if (corner_distance < least) {
    const int corner = place_of<N>(d, corner_distance);
    least = corner_distance;
    on_a = a.vertices[corner];
    on_line = line.end[0] + along * t[corner / 4][corner % 4];
  }
  return math::sqrt(least);
}

/// In the frame of the polygon. `of_b`: the capsule is B; else the normal points from it to the polygon.
template <int N>
void polygon_capsule(const Polygon& a, const Capsule2& capsule, const Transform2f& x, bool of_b, float margin,
                     PairCache& cache, Manifold2& out) {
  Vectors<N> v, n;
  v.load(a.vertices, a.count);
  n.load(a.normals, a.count);
  const Line line(capsule, x);
  const float radius = a.radius + capsule.radius, way = of_b ? 1.0f : -1.0f;
  Lanes s[2][N], both[N], greatest = Lanes::splat(-3.4e38f);
  Lanes low = Lanes::splat(3.4e38f), high = Lanes::splat(-3.4e38f);
  for (int k = 0; k < N; ++k) {
    const Lanes at = n.x[k] * v.x[k] + n.y[k] * v.y[k], across = v.along(k, line.normal);
    s[0][k] = n.along(k, line.end[0]) - at, s[1][k] = n.along(k, line.end[1]) - at;
    both[k] = min(s[0][k], s[1][k]);
    greatest = max(greatest, both[k]);
    low = min(low, across), high = max(high, across);
  }
  const float best = greatest_of(greatest), level = dot(line.normal, line.end[0]);
  const int edge = place_of<N>(both, best);
  const float right = least_of(low) - level, left = level - greatest_of(high);
  const int side = left > right ? 1 : 0;
  const float across = side == 1 ? left : right;
  const Vec2f outward = side == 1 ? -line.normal : line.normal;  // of the capsule

  const auto apart = [&](float separation, Vec2f normal) {
    if (!(separation - radius > margin)) return false;
    out.normal = normal * way;
    out.points[0].separation = separation - radius;
    return true;
  };
  // `by_line`: the capsule's side is the reference edge; it stays so while nothing else is clearly better.
  const float slack = 1e-3f * max(polygon_pair::size_of(v, n, a), 0.0f);
  const float of_second = of_b ? across : best, of_first = of_b ? best : across;
  const bool second = of_second > of_first + (cache.kind == 2 ? -slack : slack), by_line = second == of_b;
  const auto remember = [&] {
    cache.kind = second ? 2 : 1;
    cache.a = std::uint8_t(by_line ? side : edge);
  };
  if (apart(best, a.normals[edge]) || apart(across, -outward)) return remember();
  const Vec2f normal = by_line ? -outward : a.normals[edge];  // from the polygon
  const float separation = by_line ? across : best;
  remember();

  if (separation > 1e-4f * slack) {
    Vec2f on_a{}, on_line{};
    const float d = closest<N>(a, v, line, s, on_a, on_line);
    const Vec2f direct = d > 1e-6f ? (on_line - on_a) * (1 / d) : normal;
    if (apart(d, direct)) return;
    if (d > 1e-6f && dot(direct, normal) < 0.9999f) {
      single_contact(on_a, a.radius, on_line, capsule.radius, direct, d, 1u << 25, out);
      if (!by_line && a.radius == 0) over_border(out, normal, separation, radius);
      out.normal = out.normal * way;
      return;
    }
  }
  // The part of the one edge beside the other.
  Vec2f deep;
  int corner;
  if (by_line) {
    const Vec2f t{-outward.y, outward.x}, start = line.end[side];
    const int facing = polygon_pair::lowest_along<N>(n, outward);
    clip_edge({outward, start, dot(t, line.end[1 - side] - start), side, capsule.radius},
              {a.vertices[next(a, facing)], a.vertices[facing], facing, a.radius}, second, margin, out);
    corner = polygon_pair::lowest_along<N>(v, outward);
    deep = a.vertices[corner] + outward * (0.5f * (capsule.radius - a.radius - separation));
  } else {
    const Vec2f t{-normal.y, normal.x}, start = a.vertices[edge];
    const int facing = dot(normal, line.normal) <= 0 ? 0 : 1;
    clip_edge({normal, start, dot(t, a.vertices[next(a, edge)] - start), edge, a.radius},
              {line.end[1 - facing], line.end[facing], facing, capsule.radius}, second, margin, out);
    corner = dot(normal, line.end[1]) < dot(normal, line.end[0]) ? 1 : 0;
    deep = line.end[corner] + normal * (0.5f * (a.radius - capsule.radius - separation));
  }
  // The deepest corner may stand beyond the end of the edge.
  const float deepest = separation - radius;
  float least = out.count > 0 ? out.points[0].separation : 3.4e38f;
  if (out.count > 1) least = min(least, out.points[1].separation);
  if (deepest > margin || least <= deepest + 0.02f * abs(deepest) + slack) return;
  out.normal = normal * way;
  const int place = out.count < 2 ? out.count++ : (out.points[0].separation > out.points[1].separation ? 0 : 1);
  out.points[place] = {deep, deepest, 1u << 26 | (second ? 1u << 24 : 0u) | std::uint32_t(corner)};
}

/// False, and nothing done, where they cross or lie along each other.
bool capsules(const Capsule2& a, const Capsule2& b, const Transform2f& x, float margin, PairCache& cache,
              Manifold2& out) {
  const Line other(b, x);
  const float radius = a.radius + b.radius, half = a.half_length;
  const Vec2f* const e = other.end;
  const float right = min(e[0].x, e[1].x), left = -max(e[0].x, e[1].x);
  const float level = dot(other.normal, x.p), from = -half * other.normal.y - level, to = half * other.normal.y - level;
  const float above = min(from, to), below = -max(from, to);
  const int side_a = left > right ? 1 : 0, side_b = below > above ? 1 : 0;
  const float of_a = max(right, left), of_b = max(above, below);
  const bool second = of_b > of_a;
  const float separation = second ? of_b : of_a;
  if (!(separation > -1e-5f)) return false;
  const Vec2f u{-x.q.s, x.q.c};
  const float length_a = clamp(e[0].y, -half, half), length_b = clamp(e[1].y, -half, half);
  const float from_b = clamp(dot(Vec2f{0, -half} - x.p, u), -b.half_length, b.half_length);
  const float to_b = clamp(dot(Vec2f{0, half} - x.p, u), -b.half_length, b.half_length);
  const Vec2f on[4][2] = {
      {{0, -half}, x.p + u * from_b}, {{0, half}, x.p + u * to_b}, {{0, length_a}, e[0]}, {{0, length_b}, e[1]}};
  int best = 0;
  float least = distance_squared(on[0][0], on[0][1]);
  for (int i = 1; i < 4; ++i)
    if (const float d = distance_squared(on[i][0], on[i][1]); d < least) least = d, best = i;
  const float d = math::sqrt(least);
  if (!(d > 1e-6f)) return false;
  const Vec2f direct = (on[best][1] - on[best][0]) * (1 / d);
  const Vec2f normal = second ? other.normal * (side_b == 1 ? 1.0f : -1.0f) : Vec2f{side_a == 1 ? -1.0f : 1.0f, 0};
  const bool apart = d - radius > margin;
  if (!apart && dot(direct, normal) >= 0.9999f) return false;
  cache.kind = second ? 2 : 1;
  cache.a = std::uint8_t(second ? side_b : side_a);
  if (!apart) {
    single_contact(on[best][0], a.radius, on[best][1], b.radius, direct, d, 1u << 25, out);
  } else {
    out.normal = direct;
    out.points[0].separation = d - radius;
  }
  return true;
}

void capsule_circle(const Capsule2& a, Vec2f p, float radius, float margin, Manifold2& out) {
  between_points({0, clamp(p.y, -a.half_length, a.half_length)}, a.radius, p, radius, margin, 0, out);
}

void any_polygon_circle(const Polygon& a, Vec2f p, float radius, float margin, Manifold2& out) {
  if (a.count <= 4)
    polygon_circle<1>(a, p, radius, margin, out);
  else
    polygon_circle<2>(a, p, radius, margin, out);
}

void any_polygon_capsule(const Polygon& a, const Capsule2& capsule, const Transform2f& x, bool of_b, float margin,
                         PairCache& cache, Manifold2& out) {
  if (a.count <= 4)
    polygon_capsule<1>(a, capsule, x, of_b, margin, cache, out);
  else
    polygon_capsule<2>(a, capsule, x, of_b, margin, cache, out);
}

}  // namespace round_pair

bool collide_round(const Shape2& a, const Shape2& b, const Transform2f& x, float margin, PairCache& cache,
                   Manifold2& out) {
  using namespace round_pair;
  if (a.type == ShapeType2::circle) {
    const float radius = a.circle.radius;
    if (b.type == ShapeType2::circle)
      between_points({}, radius, x.p, b.circle.radius, margin, 0, out);
    else if (b.type == ShapeType2::capsule)
      capsule_circle(b.capsule, -inverse_rotate(x.q, x.p), radius, margin, out);
    else if (b.type == ShapeType2::polygon)
      any_polygon_circle(b.polygon, -inverse_rotate(x.q, x.p), radius, margin, out);
    else
      return false;
    if (b.type != ShapeType2::circle) seen_from_a(x, out);
    return true;
  }
  const bool lines = (a.type != ShapeType2::capsule || a.capsule.half_length > 0) &&
                     (b.type != ShapeType2::capsule || b.capsule.half_length > 0);
  if (a.type == ShapeType2::capsule) {
    if (b.type == ShapeType2::circle) return capsule_circle(a.capsule, x.p, b.circle.radius, margin, out), true;
    if (!lines) return false;
    if (b.type == ShapeType2::capsule) return capsules(a.capsule, b.capsule, x, margin, cache, out);
    if (b.type != ShapeType2::polygon) return false;
    any_polygon_capsule(b.polygon, a.capsule, inverse(x), false, margin, cache, out);
    out.normal = rotate(x.q, out.normal);
    for (int i = 0; i < out.count; ++i) out.points[i].point = transform_point(x, out.points[i].point);
    return true;
  }
  if (a.type != ShapeType2::polygon) return false;
  if (b.type == ShapeType2::circle) return any_polygon_circle(a.polygon, x.p, b.circle.radius, margin, out), true;
  if (b.type != ShapeType2::capsule || !lines) return false;
  any_polygon_capsule(a.polygon, b.capsule, x, true, margin, cache, out);
  return true;
}

}  // namespace carom::geometry::detail
