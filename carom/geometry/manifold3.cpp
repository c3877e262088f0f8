// Contact manifolds in space: closed forms for round pairs, and the table that picks the method for any two shapes.
#include "carom/geometry/detail/contact_points.h"

namespace carom::geometry {
namespace pairs3 {

using detail::closest_on_segments;

// Surfaces whose cores are √l2 apart.
void apart(float l2, float radii, Manifold3& out) { out.points[0].separation = sqrt(l2) - radii; }

void point_point(Vec3f a, float ra, Vec3f b, float rb, float margin, std::uint32_t id, Manifold3& out) {
  const Vec3f d = b - a;
  const float l2 = dot(d, d), reach = ra + rb + margin;
  if (l2 > reach * reach) return apart(l2, ra + rb, out);
  const float l = sqrt(l2);
  const Vec3f n = l > 1e-12f ? d * (1 / l) : Vec3f{0, 1, 0};
  const float s = l - ra - rb;
  out.normal = n;
  out.count = 1;
  out.points[0] = {a + n * (ra + 0.5f * s), s, id};
}

void sphere_sphere(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache&, Manifold3& out) {
  point_point({}, a.sphere.radius, x.p, b.sphere.radius, margin, 0, out);
}

void capsule_sphere(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache&, Manifold3& out) {
  const float y = clamp(x.p.y, -a.capsule.half_length, a.capsule.half_length);
  point_point({0, y, 0}, a.capsule.radius, x.p, b.sphere.radius, margin, 0, out);
}

// Capsules with a small angle between them meet along a stretch: crossed by φ, their cores part from the distance l by
// (φy)²/2l only, at y from the crossing. Where that is within a thousandth of l, they touch; the point that is nearest
// leaps from end to end when they turn by a hair, and is nothing that a load could stand on. A has its axis along y
// from −ha to ha, B's goes from p by d; `gap` is the least between them, at y of A.
bool along_each_other(float ha, Vec3f p, Vec3f d, float y, Vec3f gap, float ra, float rb, float margin,
                      Manifold3& out) {
  if (!(d.y * d.y > 0.75f * dot(d, d)) || ha == 0) return false;
  const Vec3f slope = d * (1 / d.y);  // of B, by y
  float low = max(-ha, min(p.y, p.y + d.y)), high = min(ha, max(p.y, p.y + d.y));
  const float least = 0.1f * min(ha, 0.5f * abs(d.y)), l2 = dot(gap, gap);
  if (!(high - low > least) || !(l2 > 1e-12f * (ra + rb) * (ra + rb))) return false;
  const float l = sqrt(l2);
  const Vec3f side = normalize_or(Vec3f{gap.z, 0, -gap.x}, Vec3f{1, 0, 0}, 1e-12f);
  if (abs(gap.y) > 0.1f * l) return false;  // beside each other's ends
  const float crossing = dot(slope, side), reach = 0.0447f * l;
  if (abs(crossing) * (high - low) > reach) {
    const float middle = y - dot(p + slope * (y - p.y), side) / crossing, width = reach / abs(crossing);
    low = max(low, middle - width), high = min(high, middle + width);
    if (!(high - low > least)) return false;
  }
  const auto core_b = [&](float at) { return p + slope * (at - p.y); };
  const float middle = 0.5f * (low + high);
  const Vec3f between = core_b(middle) - Vec3f{0, middle, 0}, mean = Vec3f{0, 1, 0} + normalize(slope);
  const Vec3f across = between - mean * (dot(between, mean) / dot(mean, mean));
  const float distance = length(across);
  if (!(distance > 1e-6f * (ra + rb))) return false;
  const Vec3f normal = across / distance;
  // Toward or away from each other: the distance is that of an end.
  const float tilt = abs(dot(normal, slope));
  if (tilt > 0.06f || tilt * (high - low) > 0.05f * l) return false;
  out.normal = normal;
  for (int k = 0; k < 2; ++k) {
    const Vec3f a{0, k == 0 ? low : high, 0}, b = core_b(a.y);
    const float separation = dot(out.normal, b - a) - ra - rb;
    if (separation > margin) continue;
    out.points[out.count++] = {(a + b + out.normal * (ra - rb)) * 0.5f, separation, std::uint32_t(1 + k)};
  }
  return out.count > 0;
}

void capsule_capsule(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache&, Manifold3& out) {
  const float ha = a.capsule.half_length, hb = b.capsule.half_length, ra = a.capsule.radius, rb = b.capsule.radius;
  const Vec3f axis = rotate(x.q, Vec3f{0, 1, 0});
  const Vec3f d1{0, 2 * ha, 0}, p1{0, -ha, 0}, d2 = axis * (2 * hb), p2 = x.p - axis * hb;
  float s, t;
  closest_on_segments(p1, d1, p2, d2, s, t);
  const Vec3f ca = p1 + d1 * s, cb = p2 + d2 * t, gap = cb - ca;
  const float l2 = dot(gap, gap), reach = ra + rb + margin;
  if (l2 > reach * reach) return apart(l2, ra + rb, out);
  if (along_each_other(ha, p2, d2, ca.y, gap, ra, rb, margin, out)) return;
  if (l2 > 1e-12f * (ra + rb) * (ra + rb)) return point_point(ca, ra, cb, rb, margin, 0, out);
  // The axes cross: push along their common normal.
  const Vec3f n = normalize_or(cross(d1, d2), normalize_or(cross(axis, Vec3f{1, 0, 0}), Vec3f{0, 0, 1}, 1e-3f), 1e-12f);
  out.normal = n;
  out.count = 1;
  out.points[0] = {ca + n * (0.5f * (ra - rb)), -ra - rb, 0};
}

void box_sphere(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache&, Manifold3& out) {
  const Vec3f h = a.box.half_extents, c = x.p;
  const Vec3f q{clamp(c.x, -h.x, h.x), clamp(c.y, -h.y, h.y), clamp(c.z, -h.z, h.z)};
  const Vec3f d = c - q;
  const float l2 = dot(d, d), r = b.sphere.radius, reach = a.box.radius + r + margin;
  if (l2 > reach * reach) return apart(l2, a.box.radius + r, out);
  const Vec3f gap = abs(c) - h;
  const int axis = gap.x >= gap.y && gap.x >= gap.z ? 0 : (gap.y >= gap.z ? 1 : 2);
  if (l2 > 1e-12f * dot(h, h)) {
    point_point(q, a.box.radius, c, r, margin, 0, out);
    const float radius = a.box.radius + r;
    if (out.count > 0 && a.box.radius == 0 && gap[axis] - radius > -detail::border_tolerance(radius)) {
      if (gap[axis] * gap[axis] > detail::border_cosine * detail::border_cosine * l2) {
        out.normal = {};
        out.normal[axis] = c[axis] < 0 ? -1.0f : 1.0f;
      } else if (out.points[0].separation > 0) {
        out.count = 0;  // above the face's level and well beside it: nothing to meet yet
      }
    }
    return;
  }
  // The centre is in the box: out by the nearest face.
  Vec3f n{};
  n[axis] = c[axis] < 0 ? -1.0f : 1.0f;
  const float s = gap[axis] - a.box.radius - r;
  out.normal = n;
  out.count = 1;
  out.points[0] = {c - n * (r + 0.5f * s), s, 0};
}

// A capsule's core against a box: the best of the box's faces and of the axes across both; two points on a face.
void box_capsule(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache& cache,
                 Manifold3& out) {
  const Vec3f h = a.box.half_extents;
  const float radius = a.box.radius + b.capsule.radius;
  const Vec3f axis = rotate(x.q, Vec3f{0, 1, 0}), half = axis * b.capsule.half_length, reach = abs(half);
  const Vec3f s = abs(x.p) - h - reach;
  const int face = s.x >= s.y && s.x >= s.z ? 0 : (s.y >= s.z ? 1 : 2);
  if (s[face] > radius + margin) {
    out.points[0].separation = s[face] - radius;
    return;
  }
  // On a face: part of the segment stands over it, and it is not deeper there than the radius allows to see.
  Vec3f n{};
  n[face] = x.p[face] < 0 ? -1.0f : 1.0f;
  const int u = (face + 1) % 3, v = (face + 2) % 3;
  float t0 = -1, t1 = 1;
  for (const int k : {u, v}) {
    const float p = x.p[k], d = half[k];
    if (abs(d) < 1e-7f * h[k]) {
      if (abs(p) > h[k]) t0 = 2;
      continue;
    }
    const float ta = (-h[k] - p) / d, tb = (h[k] - p) / d;
    t0 = max(t0, min(ta, tb)), t1 = min(t1, max(ta, tb));
  }
  const float slope = dot(n, half);
  const float lowest = slope < 0 ? 1.0f : -1.0f;
  const bool nearest_is_over = t0 <= t1 && (slope == 0 || (lowest > 0 ? t1 >= 1 - 1e-4f : t0 <= -1 + 1e-4f));
  // Lying nearly level it is a face contact wherever it overhangs; steep, only if the lower end is over the face.
  const bool level = abs(slope) < 0.02f * b.capsule.half_length;
  const bool shallow = s[face] > -0.5f * min(h.x, min(h.y, h.z));
  // Where the core is inside, a way out across the capsule and an edge of the box may be shorter than out by the face.
  const auto edge_is_nearer = [&] {
    if (s[face] >= 0) return false;
    float best = -1e30f;
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
      const float l2 = axis[j] * axis[j] + axis[k] * axis[k];
      if (l2 < 1e-4f) continue;
      const float apart = abs(x.p[j] * axis[k] - x.p[k] * axis[j]) - h[j] * abs(axis[k]) - h[k] * abs(axis[j]);
      best = max(best, apart / math::sqrt(l2));
    }
    return best > s[face] * 0.95f;
  };
  if (t0 <= t1 && shallow && (nearest_is_over || (level && s[face] > -1e-3f * h[face])) && !edge_is_nearer()) {
    out.normal = n;
    for (int k = 0; k < 2; ++k) {
      const float t = k == 0 ? t0 : t1;
      const Vec3f p = x.p + half * t;
      const float separation = n[face] * p[face] - h[face] - radius;
      if (separation > margin) continue;
      const Vec3f on_b = p - n * b.capsule.radius;
      out.points[out.count++] = {on_b - n * (0.5f * separation), separation, std::uint32_t(k)};
      if (t1 - t0 < 1e-4f) break;
    }
    if (out.count > 0) return;
  }
  detail::collide_cores(detail::convex_of(a), detail::convex_of(b), x, margin, cache, out);
}

void box_box(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache& cache, Manifold3& out) {
  if (a.box.radius == 0 && b.box.radius == 0) return detail::collide_box_box(a.box, b.box, x, margin, cache, out);
  detail::collide_cores(detail::convex_of(a), detail::convex_of(b), x, margin, cache, out);
}

void general(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache& cache, Manifold3& out) {
  detail::collide_cores(detail::convex_of(a), detail::convex_of(b), x, margin, cache, out);
}

void plane_any(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache&, Manifold3& out) {
  detail::collide_plane(a.plane, detail::convex_of(b), x, margin, out);
}

using Collide = void (*)(const Shape3&, const Shape3&, const Transform3f&, float, PairCache&, Manifold3&);

template <Collide F>
void flipped(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache& cache, Manifold3& out) {
  F(b, a, inverse(x), margin, cache, out);
  if (out.count > 0)
    detail::flip(out, x);
  else
    out.normal = -rotate(x.q, out.normal);
}
// A cylinder or cone on a box is asked about in its own frame, where the corners of a wide box would lose a tenth of a
// millimetre: so of the box only what is near counts.
void box_round(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, PairCache& cache, Manifold3& out) {
  const bool cone = b.type == ShapeType3::cone;
  const float outer = cone ? b.cone.half_height + b.cone.radius + b.cone.rounding
                           : b.cylinder.half_height + b.cylinder.radius + b.cylinder.rounding;
  const float around = 8 * outer + margin;
  const Vec3f h = a.box.half_extents, reach{around, around, around};
  const Vec3f low = max(-h, x.p - reach), high = min(h, x.p + reach), half = (high - low) * 0.5f;
  if (half == h || !(half.x > 0 && half.y > 0 && half.z > 0)) return flipped<general>(a, b, x, margin, cache, out);
  const Vec3f center = (low + high) * 0.5f;
  flipped<general>(Box{half, a.box.radius}, b, {x.p - center, x.q}, margin, cache, out);
  for (int i = 0; i < out.count; ++i) out.points[i].point += center;
}

void none(const Shape3&, const Shape3&, const Transform3f&, float, PairCache&, Manifold3&) {}

// Rows: A; columns: B; sphere, capsule, box, cylinder, cone, ellipsoid, hull, plane.
constexpr Collide table[8][8] = {
    {sphere_sphere, flipped<capsule_sphere>, flipped<box_sphere>, flipped<general>, flipped<general>, flipped<general>,
     flipped<general>, flipped<plane_any>},
    {capsule_sphere, capsule_capsule, flipped<box_capsule>, flipped<general>, flipped<general>, flipped<general>,
     flipped<general>, flipped<plane_any>},
    {box_sphere, box_capsule, box_box, box_round, box_round, general, general, flipped<plane_any>},
    {general, general, general, general, flipped<general>, flipped<general>, flipped<general>, flipped<plane_any>},
    {general, general, general, general, general, flipped<general>, flipped<general>, flipped<plane_any>},
    {general, general, flipped<general>, general, general, general, flipped<general>, flipped<plane_any>},
    {general, general, flipped<general>, general, general, general, general, flipped<plane_any>},
    {plane_any, plane_any, plane_any, plane_any, plane_any, plane_any, plane_any, none},
};

}  // namespace pairs3

void collide(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, float margin, PairCache& cache,
             Manifold3& out) {
  out.count = 0;
  out.child = out.material = 0;
  out.normal = {};
  out.points[0].separation = margin;
  if (a.type > ShapeType3::plane || b.type > ShapeType3::plane) return;
  pairs3::table[int(a.type)][int(b.type)](a, b, b_in_a, margin, cache, out);
}

}  // namespace carom::geometry
