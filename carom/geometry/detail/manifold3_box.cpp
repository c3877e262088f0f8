// Sharp boxes by the separating axis theorem over their 15 axes (Gottschalk, Lin & Manocha 1996) and clipping.
#include "carom/geometry/detail/contact_points.h"
#include "carom/math/simd.h"

namespace carom::geometry::detail {
namespace box_pair {

struct Corner {
  float u, v, w;
  std::uint32_t id;
};

// One side of the rectangle: keeps sign·(u or v) ≤ limit.
int clip_side(const Corner* in, int count, Corner* out, bool along_v, float sign, float limit, std::uint32_t side) {
  int kept = 0;
  Corner p = in[count - 1];
  float dp = sign * (along_v ? p.v : p.u) - limit;
  for (int i = 0; i < count; ++i) {
    const Corner q = in[i];
    const float dq = sign * (along_v ? q.v : q.u) - limit;
    if ((dp <= 0) != (dq <= 0)) {
      const float t = dp / (dp - dq);
      const std::uint32_t a = min(p.id, q.id), b = max(p.id, q.id);
      out[kept++] = {p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), p.w + t * (q.w - p.w),
                     (side << 5 | (a & 7) << 8 | (b & 7) << 11 | ((a >> 5) & 7) << 14 | ((b >> 5) & 7) << 17) + 8};
    }
    if (dq <= 0) out[kept++] = q;
    p = q, dp = dq;
  }
  return kept;
}

// The faces: `ref` has half extents hr and axes r[], `inc` likewise, its centre at c from ref's centre, all in one
// frame. n: the normal of ref's face. The other one is seen along `normal`, and so are separations.
void clip_faces(Vec3f hr, const Vec3f* r, Vec3f hi, const Vec3f* q, Vec3f c, int axis, Vec3f n, Vec3f normal,
                float margin, std::uint32_t tag, Vec3f ref_center, ContactPoints& out) {
  const int u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
  float along[3] = {dot(q[0], normal), dot(q[1], normal), dot(q[2], normal)};
  const float a0 = abs(along[0]), a1 = abs(along[1]), a2 = abs(along[2]);
  const int j = a0 >= a1 && a0 >= a2 ? 0 : (a1 >= a2 ? 1 : 2);
  const int ju = j == 2 ? 0 : j + 1, jv = j == 0 ? 2 : j - 1;
  const float sign = along[j] > 0 ? -1.0f : 1.0f;
  const Vec3f center = c + q[j] * (sign * hi[j]), eu = q[ju] * hi[ju], ev = q[jv] * hi[jv];
  const Vec3f U = r[u], V = r[v];
  const float cu = dot(center, U), cv = dot(center, V), cw = dot(center, n) - hr[axis];
  const float uu = dot(eu, U), uv = dot(eu, V), uw = dot(eu, n);
  const float vu = dot(ev, U), vv = dot(ev, V), vw = dot(ev, n);
  const std::uint32_t base = sign > 0 ? 1u << j : 0u;
  RawArray<Corner, 16> room[2];
  Corner *const x = room[0].items, *const y = room[1].items;
  constexpr int turn[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  for (int k = 0; k < 4; ++k) {
    const float su = float(turn[k][0]), sv = float(turn[k][1]);
    x[k] = {cu + su * uu + sv * vu, cv + su * uv + sv * vv, cw + su * uw + sv * vw,
            base | (su > 0 ? 1u << ju : 0u) | (sv > 0 ? 1u << jv : 0u)};
  }
  const Vec3f lean = normal - n;
  if (!(lean == Vec3f{})) {
    const float scale = 1 / dot(normal, n), lean_u = dot(normal, U), lean_v = dot(normal, V);
    for (int k = 0; k < 4; ++k) {
      x[k].w *= scale;
      x[k].u -= lean_u * x[k].w, x[k].v -= lean_v * x[k].w;
    }
  }
  int count = clip_side(x, 4, y, false, 1, hr[u], 1);
  if (count > 0) count = clip_side(y, count, x, false, -1, hr[u], 2);
  if (count > 0) count = clip_side(x, count, y, true, 1, hr[v], 3);
  if (count > 0) count = clip_side(y, count, x, true, -1, hr[v], 4);
  for (int k = 0; k < count; ++k) {
    if (x[k].w > margin) continue;
    const Vec3f p = ref_center + U * x[k].u + V * x[k].v + n * (hr[axis] + 0.5f * x[k].w) + lean * (0.5f * x[k].w);
    out.add(p, x[k].w, x[k].id | tag);
  }
}

}  // namespace box_pair

void collide_box_box(const Box& box_a, const Box& box_b, const Transform3f& x, float margin, PairCache& cache,
                     Manifold3& out) {
  using namespace box_pair;
  const Mat3f R = to_matrix(x.q);
  const Vec3f ea = box_a.half_extents, eb = box_b.half_extents, t = x.p;
  const Vec3f B[3] = {R.cx, R.cy, R.cz}, Q[3] = {abs(R.cx), abs(R.cy), abs(R.cz)};
  const Vec3f tb = t * R;  // in B's axes

  // The axis that parted them last is asked first.
  const Vec3f sa = abs(t) - ea - (Q[0] * eb.x + Q[1] * eb.y + Q[2] * eb.z);
  const float apart_a = max(sa.x, max(sa.y, sa.z));
  if (apart_a > margin) {
    out.points[0].separation = apart_a;
    const int i = sa.x == apart_a ? 0 : (sa.y == apart_a ? 1 : 2);
    out.normal[i] = t[i] < 0 ? -1.0f : 1.0f;
    return;
  }
  const Vec3f sb = abs(tb) - eb - Vec3f{dot(Q[0], ea), dot(Q[1], ea), dot(Q[2], ea)};
  const float apart_b = max(sb.x, max(sb.y, sb.z));
  if (apart_b > margin) {
    out.points[0].separation = apart_b;
    const int i = sb.x == apart_b ? 0 : (sb.y == apart_b ? 1 : 2);
    out.normal = tb[i] < 0 ? -B[i] : B[i];
    return;
  }

  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (sa[i] > sa[axis]) axis = i;
  float best = sa[axis];
  const float smallest = min(min(ea.x, min(ea.y, ea.z)), min(eb.x, min(eb.y, eb.z)));
  const float slack = 5e-4f * smallest;
  const int remembered = int(cache.kind) - 1;
  // A face keeps the contact while it is within the slack: the choice has hysteresis.
  float kept = remembered < 0 || remembered >= 6 ? -1e30f : (remembered < 3 ? sa[remembered] : sb[remembered - 3]);
  for (int i = 0; i < 3; ++i)
    if (sb[i] > best + (axis < 3 ? slack : 0)) best = sb[i], axis = i + 3;
  if (kept + 2 * slack >= best) best = kept, axis = remembered;
  const float face = best;

  // n = A_i × B_j, for all j at once; its length is the sine of the angle between the two edges.
  using Four = math::WideFloat<4>;
  const auto row = [](float x, float y, float z) { return Four{Four::Vector{x, y, z, 0}}; };
  const Four turned[3] = {row(B[0].x, B[1].x, B[2].x), row(B[0].y, B[1].y, B[2].y), row(B[0].z, B[1].z, B[2].z)};
  const Four near_b = row(eb.y, eb.z, eb.x), far_b = row(eb.z, eb.x, eb.y), one = Four::splat(1);
  int edge_i = -1, edge_j = 0;
  float edge = -1e30f, edge_scale = 1;
  for (int i = 0; i < 3; ++i) {
    const int i1 = i == 2 ? 0 : i + 1, i2 = i == 0 ? 2 : i - 1;
    const Four r1 = turned[i1], r2 = turned[i2], l2 = r1 * r1 + r2 * r2;
    const math::WideMask<4> skew = !(l2 < Four::splat(1e-4f));
    const Four scale = one / sqrt(select(skew, l2, one));
    const Four ra = Four::splat(ea[i1]) * abs(r2) + Four::splat(ea[i2]) * abs(r1);
    const Four rb = near_b * row(Q[2][i], Q[0][i], Q[1][i]) + far_b * row(Q[1][i], Q[2][i], Q[0][i]);
    const Four s =
        select(skew, (abs(Four::splat(t[i2]) * r1 - Four::splat(t[i1]) * r2) - ra - rb) * scale, Four::splat(-1e30f));
    for (int j = 0; j < 3; ++j) {
      if (s[j] > margin) {
        out.points[0].separation = s[j];
        return;
      }
      if (s[j] > edge) edge = s[j], edge_i = i, edge_j = j, edge_scale = scale[j];
    }
  }

  const bool was_edge = remembered >= 6;
  const float needed = face + (was_edge ? 0.01f : 0.05f) * abs(face) + (was_edge ? 0.5f : 2.0f) * slack;
  if (edge_i >= 0 && edge > needed) {
    const Vec3f Ai{edge_i == 0 ? 1.0f : 0.0f, edge_i == 1 ? 1.0f : 0.0f, edge_i == 2 ? 1.0f : 0.0f};
    Vec3f n = cross(Ai, B[edge_j]) * edge_scale;
    if (dot(n, t) < 0) n = -n;
    Vec3f pa{n.x > 0 ? ea.x : -ea.x, n.y > 0 ? ea.y : -ea.y, n.z > 0 ? ea.z : -ea.z};
    pa[edge_i] = 0;
    Vec3f pb = t;
    std::uint32_t name = 0;
    for (int j = 0; j < 3; ++j) {
      if (j == edge_j) continue;
      const bool up = dot(n, B[j]) < 0;
      pb += B[j] * (up ? eb[j] : -eb[j]);
      name |= up ? 1u << j : 0u;
    }
    // Closest points of the two lines, kept to the edges.
    const Vec3f r = pb - pa;
    const float b = dot(Ai, B[edge_j]), det = 1 - b * b, c1 = dot(Ai, r), c2 = dot(B[edge_j], r);
    const float u = clamp((c1 - b * c2) / det, -ea[edge_i], ea[edge_i]);
    const float v = clamp((b * c1 - c2) / det, -eb[edge_j], eb[edge_j]);
    const Vec3f ca = pa + Ai * u, cb = pb + B[edge_j] * v;
    out.normal = n;
    out.count = 1;
    out.points[0] = {(ca + cb) * 0.5f, edge,
                     0x80000000u | std::uint32_t(edge_i) << 8 | std::uint32_t(edge_j) << 4 | name};
    // Edges that pass each other beyond their ends do not meet while the boxes are apart.
    if (edge > 0 && length(cb - ca) > edge + margin) out.count = 0;
    cache.kind = std::uint8_t(7 + 3 * edge_i + edge_j);
    if (out.count == 0 || edge < -shallow_share * min(max(ea.x, max(ea.y, ea.z)), max(eb.x, max(eb.y, eb.z)))) return;
    // Where the faces beside the edges nearly face each other, what rocks over an edge comes down on the other ones:
    // the points of the faces along n, of which the edges' is the deepest, are all of them.
    int k = 0;
    for (int i = 1; i < 3; ++i)
      if (abs(n[i]) > abs(n[k])) k = i;
    const Vec3f in_b = n * R;
    const float facing = max(abs(in_b.x), max(abs(in_b.y), abs(in_b.z)));
    if (max(abs(n[k]), facing) < facing_cosine) return;
    const Vec3f A[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3f face_normal{};
    face_normal[k] = n[k] < 0 ? -1.0f : 1.0f;
    ContactPoints points;
    clip_faces(ea, A, eb, B, t, k, face_normal, n, margin,
               1u << 31 | (n[k] < 0 ? 1u : 0u) << 28 | std::uint32_t(k) << 24, {}, points);
    if (points.count > 1) write_points(points, n, out);
    return;
  }

  // Boxes side by side, level with each other (a row of tiles): where they meet only in a strip narrower than a small
  // tolerance, a contact across the row would catch on the joint, so there is none. A matter of this pair alone.
  const float graze = min(0.02f * smallest, 0.005f);
  if (face > -graze) {
    for (int k = 0; k < 6; ++k) {
      if (k == axis) continue;
      const float s = k < 3 ? sa[k] : sb[k - 3];
      if (s <= -graze) continue;
      const Vec3f n =
          axis < 3 ? Vec3f{axis == 0 ? 1.0f : 0.0f, axis == 1 ? 1.0f : 0.0f, axis == 2 ? 1.0f : 0.0f} : B[axis - 3];
      const Vec3f m = k < 3 ? Vec3f{k == 0 ? 1.0f : 0.0f, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f} : B[k - 3];
      if (abs(dot(n, m)) > 0.02f) continue;
      const Vec3f level = k < 3 ? Vec3f{Q[0][k], Q[1][k], Q[2][k]} : Q[k - 3];
      if (max(level.x, max(level.y, level.z)) > 0.9998f) return;
    }
  }

  ContactPoints points;
  const Vec3f A[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (axis < 3) {
    Vec3f n{};
    n[axis] = t[axis] < 0 ? -1.0f : 1.0f;
    clip_faces(ea, A, eb, B, t, axis, n, n, margin, (t[axis] < 0 ? 1u : 0u) << 28 | std::uint32_t(axis) << 24, {},
               points);
    write_points(points, n, out);
  } else {
    const int j = axis - 3;
    const bool negative = tb[j] > 0;  // the face of B that looks at A
    const Vec3f n = B[j] * (negative ? -1.0f : 1.0f);
    clip_faces(eb, B, ea, A, -t, j, n, n, margin, 1u << 29 | (negative ? 1u : 0u) << 28 | std::uint32_t(j) << 24, t,
               points);
    write_points(points, -n, out);
  }
  cache.kind = std::uint8_t(1 + axis);
}

}  // namespace carom::geometry::detail
