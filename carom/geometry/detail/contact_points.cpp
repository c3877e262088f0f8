#include "carom/geometry/detail/contact_points.h"

namespace carom::geometry::detail {

void write_points(const ContactPoints& c, Vec3f normal, Manifold3& out) {
  out.normal = normal;
  out.count = 0;
  if (c.count <= 2) {
    for (int i = 0; i < c.count; ++i) out.points[out.count++] = c.point[i];
    return;
  }
  Vec3f low = c.point[0].point, high = low;
  float least = c.point[0].separation;
  for (int i = 1; i < c.count; ++i) {
    low = min(low, c.point[i].point), high = max(high, c.point[i].point);
    least = min(least, c.point[i].separation);
  }
  const float tie = 1e-3f * length(high - low);
  int chosen[4] = {};
  while (c.point[chosen[0]].separation > least + tie) ++chosen[0];
  const Vec3f p0 = c.point[chosen[0]].point;
  // Points that hang far above the others count little: they carry no load while the deep ones do.
  const auto value = [&](int i, float x) {
    return x / (1 + max(0.0f, c.point[i].separation - least - tie) / (tie * 20 + 1e-12f));
  };
  float best = -1;
  for (int i = 0; i < c.count; ++i) {
    if (i == chosen[0]) continue;
    const float v = value(i, length_squared(c.point[i].point - p0));
    if (v > best * 1.002f) best = v, chosen[1] = i;
  }
  const Vec3f p1 = c.point[chosen[1]].point;
  const Vec3f along = normalize(p1 - p0), across = cross(normal, along);
  float low_t = 0, high_t = 0, width = 0;
  for (int i = 0; i < c.count; ++i) {
    const Vec3f d = c.point[i].point - p0;
    low_t = min(low_t, dot(d, along)), high_t = max(high_t, dot(d, along));
    width = max(width, abs(dot(d, across)));
  }
  const float narrow = 0.01f * (high_t - low_t);
  if (width < narrow) {  // a line: its ends, and the deepest where it is neither
    // The edge of a thin plate is a strip, and the plate stands on its lower border: of what lies side by side at an
    // end, the deeper one carries.
    const auto end_at = [&](float from, float to) {
      int end = -1;
      for (int i = 0; i < c.count; ++i) {
        const float t = dot(c.point[i].point - p0, along);
        if (t < from || t > to) continue;
        if (end < 0 || c.point[i].separation < c.point[end].separation - 0.05f * width) end = i;
      }
      return end;
    };
    const int first = end_at(low_t, low_t + narrow), last = end_at(high_t - narrow, high_t);
    out.points[out.count++] = c.point[first];
    out.points[out.count++] = c.point[last];
    const float ends = min(c.point[first].separation, c.point[last].separation);
    if (first != chosen[0] && last != chosen[0] && least < ends - tie) out.points[out.count++] = c.point[chosen[0]];
    return;
  }
  if (c.count <= 4) {
    for (int i = 0; i < c.count; ++i) out.points[out.count++] = c.point[i];
    return;
  }
  // What lies on the first line, to rounding, spans nothing beside it.
  const float none = 0.01f * width * length(p1 - p0);
  float most = none, fewest = -none;
  int third = -1, fourth = -1;
  for (int i = 0; i < c.count; ++i) {
    if (i == chosen[0] || i == chosen[1]) continue;
    const float area = value(i, triple(normal, p1 - p0, c.point[i].point - p0));
    if (area > most * 1.002f) most = area, third = i;
    if (area < fewest * 1.002f) fewest = area, fourth = i;
  }
  // All on one side of the first line: the fourth point is the one farthest outside the triangle found so far.
  if (third < 0 && fourth >= 0) third = fourth, fourth = -1;
  if (third >= 0 && fourth < 0) {
    const Vec3f p2 = c.point[third].point;
    const float sense = triple(normal, p1 - p0, p2 - p0) > 0 ? 1.0f : -1.0f;
    float outside = 0;
    for (int i = 0; i < c.count; ++i) {
      if (i == chosen[0] || i == chosen[1] || i == third) continue;
      const Vec3f q = c.point[i].point;
      const float a = sense * triple(normal, p2 - p1, q - p1), b = sense * triple(normal, p0 - p2, q - p2);
      const float v = value(i, max(-a, -b));
      if (v > outside * 1.002f) outside = v, fourth = i;
    }
  }
  out.points[out.count++] = c.point[chosen[0]];
  out.points[out.count++] = c.point[chosen[1]];
  if (third >= 0) out.points[out.count++] = c.point[third];
  if (fourth >= 0) out.points[out.count++] = c.point[fourth];
}

namespace {
struct ClipPoint {
  Vec3f p;
  std::uint32_t id;
};
}  // namespace

void clip_to_face(const Feature& ref, float radius_r, const Feature& inc, float radius_i, float margin,
                  std::uint32_t tag, ContactPoints& out, float widen) {
  RawArray<ClipPoint, 56> buffer[2];
  ClipPoint* in = buffer[0].items;
  ClipPoint* next = buffer[1].items;
  int count = inc.count;
  for (int i = 0; i < count; ++i) in[i] = {inc.point[i], inc.id[i]};
  const bool closed = count > 2;
  for (int e = 0; e < ref.count && count > 0; ++e) {
    const Vec3f a = ref.point[e], b = ref.point[e + 1 < ref.count ? e + 1 : 0];
    const Vec3f side = cross(b - a, ref.normal);  // outward
    const float tolerance = max(1e-5f * dot(side, side), widen * length(side));
    float offset[56];
    bool all = true;
    for (int i = 0; i < count; ++i) {
      offset[i] = dot(side, in[i].p - a);
      if (offset[i] <= tolerance) offset[i] = min(offset[i], 0.0f);
      all = all && offset[i] <= 0;
    }
    if (all) continue;
    int kept = 0;
    const int last = closed ? count : max(count - 1, 1);
    for (int i = 0; i < last && kept < 54; ++i) {
      const int j = i + 1 < count ? i + 1 : 0;
      if (offset[i] <= 0) next[kept++] = in[i];
      if (count > 1 && (offset[i] <= 0) != (offset[j] <= 0)) {
        const float t = offset[i] / (offset[i] - offset[j]);
        // The two corners in a fixed order: the name is that of the edge, whichever end is inside.
        const std::uint32_t u = min(in[i].id, in[j].id), v = max(in[i].id, in[j].id);
        next[kept++] = {in[i].p + (in[j].p - in[i].p) * t,
                        std::uint32_t(e + 1) << 8 | ((u * 31 + v * 7) & 0xffff) << 14 | (u & 0xff)};
      }
    }
    if (!closed && count == 2 && offset[1] <= 0) next[kept++] = in[1];
    ClipPoint* t = in;
    in = next, next = t;
    count = kept;
  }
  for (int i = 0; i < count; ++i) {
    const float d = dot(ref.normal, in[i].p - ref.point[0]);
    const float s = d - radius_r - radius_i;
    if (s <= margin) out.add(in[i].p + ref.normal * (0.5f * (radius_r - radius_i - d)), s, in[i].id ^ tag);
  }
}

void flip(Manifold3& m, const Transform3f& a_in_b) {
  m.normal = -rotate(a_in_b.q, m.normal);
  for (int i = 0; i < m.count; ++i) m.points[i].point = transform_point(a_in_b, m.points[i].point);
}

void closest_on_segments(Vec3f p1, Vec3f d1, Vec3f p2, Vec3f d2, float& s, float& t) {
  const Vec3f r = p1 - p2;
  const float a = dot(d1, d1), e = dot(d2, d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2);
  s = t = 0;
  if (!(a > 0) && !(e > 0)) return;
  if (!(a > 0)) {
    t = clamp(f / e, 0.0f, 1.0f);
    return;
  }
  if (!(e > 0)) {
    s = clamp(-c / a, 0.0f, 1.0f);
    return;
  }
  const float det = a * e - b * b;
  s = det > 1e-6f * a * e ? clamp((b * f - c * e) / det, 0.0f, 1.0f) : 0.5f;
  t = (b * s + f) / e;
  if (t < 0)
    t = 0, s = clamp(-c / a, 0.0f, 1.0f);
  else if (t > 1)
    t = 1, s = clamp((b - c) / a, 0.0f, 1.0f);
}

}  // namespace carom::geometry::detail
