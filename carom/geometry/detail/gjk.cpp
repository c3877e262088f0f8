#include "carom/geometry/detail/gjk.h"

#include <utility>

#include "carom/geometry/detail/off_directions.h"

namespace carom::geometry::detail {
namespace gjk {

struct Reduced {
  int count;
  int index[4];
  double weight[4];
  Vec3d closest;
};

Reduced of_point(const SimplexVertex* s, int i) { return {1, {i}, {1}, s[i].w}; }

Reduced of_segment(const SimplexVertex* s, int i, int j) {
  const Vec3d a = s[i].w, d = s[j].w - a;
  const double dd = dot(d, d), t = -dot(a, d);
  if (!(t > 0)) return of_point(s, i);
  if (!(t < dd)) return of_point(s, j);
  const double u = t / dd;
  return {2, {i, j}, {1 - u, u}, a + d * u};
}

// The regions of a triangle, after Ericson 2005, §5.1.5. The side of the first two was as near as it gets before the
// third came: here and in a tetrahedron, only what the last vertex is part of can be nearer.
Reduced of_triangle(const SimplexVertex* s, int i, int j, int k) {
  const Vec3d a = s[i].w, b = s[j].w, c = s[k].w, ab = b - a, ac = c - a;
  const Vec3d n = cross(ab, ac);
  const double nn = dot(n, n);
  const auto best_edge = [&] {
    const Reduced one = of_segment(s, i, k), two = of_segment(s, j, k);
    return length_squared(two.closest) < length_squared(one.closest) ? two : one;
  };
  if (!(nn > 1e-28 * dot(ab, ab) * dot(ac, ac))) return best_edge();
  // Signed areas of the origin's projection against the edges.
  const double u = triple(n, b, c), v = triple(n, c, a), w = triple(n, a, b);
  if (u >= 0 && v >= 0 && w >= 0) {
    const double sum = u + v + w;
    if (sum > 0) return {3, {i, j, k}, {u / sum, v / sum, w / sum}, n * (dot(n, a) / nn)};
  }
  return best_edge();
}

Reduced of_tetrahedron(const SimplexVertex* s) {
  constexpr int faces[3][4] = {{0, 2, 3, 1}, {1, 0, 3, 2}, {2, 1, 3, 0}};
  Reduced best{4, {0, 1, 2, 3}, {0.25, 0.25, 0.25, 0.25}, {}};
  double least = -1;
  for (const auto& f : faces) {
    const Vec3d a = s[f[0]].w;
    const Vec3d n = cross(s[f[1]].w - a, s[f[2]].w - a);
    const double inside = dot(n, s[f[3]].w - a), origin = -dot(n, a);
    // A flat tetrahedron has no inside: every face is asked.
    const bool flat = inside * inside <= 1e-28 * dot(n, n) * length_squared(s[f[3]].w - a);
    if (!flat && origin * inside >= 0) continue;
    const Reduced r = of_triangle(s, f[0], f[1], f[2]);
    const double d = length_squared(r.closest);
    if (least < 0 || d < least) least = d, best = r;
  }
  return best;
}

Reduced reduce(const SimplexVertex* s, int count) {
  switch (count) {
    case 1:
      return of_point(s, 0);
    case 2:
      return of_segment(s, 0, 1);
    case 3:
      return of_triangle(s, 0, 1, 2);
    default:
      return of_tetrahedron(s);
  }
}

SimplexVertex support_of(const Placed& a, const Placed& b, Vec3d toward_b) {
  SimplexVertex v;
  v.a = a.support(toward_b);
  v.b = b.support(-toward_b);
  v.w = v.b - v.a;
  return v;
}

/// Along a guess from A to B; zero: of the centres.
SimplexVertex first_support(const Placed& a, const Placed& b, Vec3d guess) {
  if (!(length_squared(guess) > 1e-20)) guess = b.center() - a.center();
  if (!(length_squared(guess) > 1e-20)) guess = {0, 1, 0};
  return support_of(a, b, guess);
}

/// Closest points of the segments from a by u and from b by v (Ericson 2005, §5.1.9).
void of_segments(Vec3d a, Vec3d u, Vec3d b, Vec3d v, Vec3d& on_a, Vec3d& on_b) {
  const Vec3d w = a - b;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  const double across = uu * vv - uv * uv;
  double s = across > 1e-14 * uu * vv ? clamp((uv * vw - uw * vv) / across, 0.0, 1.0) : 0;
  const double t = vv > 0 ? clamp((uv * s + vw) / vv, 0.0, 1.0) : 0;
  s = clamp((uv * t - uw) / uu, 0.0, 1.0);
  on_a = a + u * s;
  on_b = b + v * t;
}

}  // namespace gjk

bool triangle_segment_distance(const Vec3d (&p)[3], Vec3d near, Vec3d far, double cutoff, CoreDistance& out) {
  const Vec3d edge[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec3d n = cross(edge[0], p[2] - p[0]);
  const double nn = dot(n, n);
  if (!(nn > 0)) return false;
  double low = dot(n, near - p[0]), high = dot(n, far - p[0]);
  const bool crosses = low * high < 0;
  if (math::abs(high) < math::abs(low)) {
    const Vec3d end = near;
    near = far, far = end;
    const double level = low;
    low = high, high = level;
  }
  out.count = 0;
  out.overlap = false;
  const double size = math::sqrt(nn);
  if (!crosses && math::abs(low) > cutoff * size) {
    out.distance = math::abs(low) / size;
    out.normal = n * ((low < 0 ? -1 : 1) / size);
    return true;
  }
  // How far the ends stand inside each edge. No point of an edge that both are inside of is nearest, but for its
  // corners, which the edges beside it have too.
  bool near_above = true, far_above = true, beyond[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3d inward = cross(n, edge[i]);
    const bool near_inside = dot(inward, near - p[i]) >= 0, far_inside = dot(inward, far - p[i]) >= 0;
    near_above = near_above && near_inside, far_above = far_above && far_inside;
    beyond[i] = !(near_inside && far_inside);
  }
  if (!crosses && near_above) {  // nothing of the segment is nearer to the plane
    out.point_a = near - n * (low / nn);
    out.point_b = near;
  } else {
    if (crosses) {
      const Vec3d through = near + (far - near) * (low / (low - high));
      bool inside = true;
      for (int i = 0; i < 3; ++i) inside = inside && triple(n, edge[i], through - p[i]) >= 0;
      if (inside) return false;
    }
    double least = 1e300;
    const auto offer = [&](Vec3d on_a, Vec3d on_b) {
      const double d = length_squared(on_b - on_a);
      if (d < least) least = d, out.point_a = on_a, out.point_b = on_b;
    };
    if (crosses && near_above) offer(near - n * (low / nn), near);
    if (far_above) offer(far - n * (high / nn), far);
    for (int i = 0; i < 3; ++i) {
      if (!beyond[i]) continue;
      Vec3d on_a, on_b;
      gjk::of_segments(p[i], edge[i], near, far - near, on_a, on_b);
      offer(on_a, on_b);
    }
  }
  const Vec3d d = out.point_b - out.point_a;
  out.distance = math::length(d);
  if (!(out.distance > 1e-9 * (1 + size))) return false;
  out.normal = d * (1 / out.distance);
  return true;
}

namespace gjk {

/// From the first vertex of the simplex on. support(direction): the vertex of b − a that lies nearest along it.
/// enough(direction, reach): is it to end with the distance along a direction, which is `reach` over its length?
template <class Support, class Enough>
void search(const SimplexVertex& first, double cutoff, Support&& support, Enough&& enough, CoreDistance& out) {
  SimplexVertex* s = out.simplex.items;
  s[0] = first;
  out.overlap = false;
  out.count = 1;
  Reduced r = reduce(s, 1);
  double vv = length_squared(r.closest), scale = length_squared(s[0].w);
  for (int iteration = 0; iteration < 64; ++iteration) {
    if (out.count == 4 || vv <= 1e-20 * scale) {
      out.overlap = true;
      break;
    }
    const Vec3d v = r.closest;
    const SimplexVertex next = support(v);
    const double reach = dot(v, next.w);
    if (reach > 0 && (reach * reach > cutoff * cutoff * vv || enough(v, reach))) {
      out.distance = reach / math::sqrt(vv);
      out.normal = v / math::sqrt(vv);
      return;
    }
    if (vv - reach <= 1e-9 * vv + 1e-15 * math::sqrt(vv * scale)) break;
    bool known = false;
    for (int i = 0; i < out.count; ++i) known = known || next.w == s[i].w;
    if (known) break;
    scale = max(scale, length_squared(next.w));
    RawArray<SimplexVertex, 4> grown;
    for (int i = 0; i < out.count; ++i) grown[i] = s[i];
    grown[out.count] = next;
    const Reduced smaller = reduce(grown.items, out.count + 1);
    const double nearer = length_squared(smaller.closest);
    if (smaller.count < 4 && !(nearer < vv)) break;  // rounding: no nearer any more
    r = smaller;
    vv = nearer;
    out.count = r.count;
    for (int i = 0; i < r.count; ++i) s[i] = grown[r.index[i]];
  }
  out.point_a = out.point_b = {};
  for (int i = 0; i < r.count; ++i) {
    out.point_a += s[i].a * r.weight[i];
    out.point_b += s[i].b * r.weight[i];
  }
  out.distance = out.overlap ? 0 : math::sqrt(vv);
  out.normal = out.overlap ? Vec3d{} : r.closest * (1 / out.distance);
}

/// Of a box and a segment from its middle to `end` and as far back, or a point. Half the slope of the squared distance
/// along the segment grows from place to place and is straight between those where it passes the plane of a face: its
/// zero is found exactly. False where they touch.
bool box_segment_distance(const Placed& box, Vec3d center, Vec3d end, CoreDistance& out) {
  const Vec3d h(box.core->half), c = (center - box.position) * box.rotation, half = end * box.rotation;
  const auto beyond = [&](double t) {
    const Vec3d p = c + half * t;
    return p - min(max(p, -h), h);
  };
  double low = -1, high = 1, slope_low = dot(beyond(low), half), slope_high = dot(beyond(high), half);
  double t = slope_low >= 0 ? low : high;
  if (slope_low < 0 && slope_high > 0) {
    for (int k = 0; k < 3; ++k) {
      if (half[k] == 0) continue;
      for (const double side : {-h[k], h[k]}) {
        const double at = (side - c[k]) / half[k];
        if (!(at > low && at < high)) continue;
        const double slope = dot(beyond(at), half);
        if (slope < 0)
          low = at, slope_low = slope;
        else
          high = at, slope_high = slope;
      }
    }
    t = low - slope_low * (high - low) / (slope_high - slope_low);
  }
  const Vec3d p = c + half * t, on_box = min(max(p, -h), h), apart = p - on_box;
  const double distance = math::length(apart);
  if (!(distance > 1e-9 * (1 + math::length(h)))) return false;
  out.overlap = false;
  out.count = 0;
  out.distance = distance;
  out.normal = box.rotation * (apart * (1 / distance));
  out.point_a = box.rotation * on_box + box.position;
  out.point_b = box.rotation * p + box.position;
  return true;
}

/// Of a triangle or a box and a segment or a point. False for other pairs, and where they touch.
bool closed_distance(const Placed& a, const Placed& b, double cutoff, CoreDistance& out) {
  if (b.core->kind > CoreKind::segment) return false;
  const Vec3d half = b.rotation * Vec3d{0, double(b.core->half.y), 0};
  if (a.core->kind == CoreKind::box) return box_segment_distance(a, b.position, half, out);
  if (a.core->kind != CoreKind::triangle) return false;
  Vec3d p[3];
  for (int i = 0; i < 3; ++i) p[i] = a.rotation * Vec3d(a.core->corner[i]) + a.position;
  return triangle_segment_distance(p, b.position + half, b.position - half, cutoff, out);
}

}  // namespace gjk

void core_distance(const Placed& a, const Placed& b, double cutoff, Vec3d guess, CoreDistance& out) {
  if (gjk::closed_distance(a, b, cutoff, out)) return;
  const auto never = [](const Vec3d&, double) { return false; };
  gjk::search(gjk::first_support(a, b, guess), cutoff, [&](Vec3d v) { return gjk::support_of(a, b, v); }, never, out);
}

void core_clearance(const Placed& a, const Placed& b, double radii, double near, double share, Vec3d guess,
                    CoreDistance& out) {
  if (gjk::closed_distance(a, b, 1e30, out)) return;
  if (gjk::closed_distance(b, a, 1e30, out)) {
    std::swap(out.point_a, out.point_b);
    out.normal = -out.normal;
    return;
  }
  const auto enough = [&](const Vec3d& v, double reach) {
    const double most = math::length(v), least = reach / most - radii;
    return least > near && least >= share * (most - radii);
  };
  gjk::search(gjk::first_support(a, b, guess), 1e30, [&](Vec3d v) { return gjk::support_of(a, b, v); }, enough, out);
}

/// In closed form: of an edge and an edge, or of a corner of the triangle before a face. Not for what nearly touches.
static bool distance_of_edges(const Vec3f (&p)[3], const PlacedCorners& b, int beyond, CoreDistance& out) {
  PlacedCorners::Edge edge{}, nearest{};
  int on = -1, ends = 0;
  for (int e = 0; e < 3; ++e) {
    if ((beyond >> e & 1) == 0) continue;
    const int next = e == 2 ? 0 : e + 1;
    if (!b.nearest_edge(p[e], p[next] - p[e], edge)) return false;
    if (on < 0 || edge.distance_squared < nearest.distance_squared) nearest = edge, on = e;
    ends |= 1 << e | 1 << next;
  }
  const Vec3d start(p[on]), from(nearest.start);
  gjk::of_segments(start, Vec3d(p[on == 2 ? 0 : on + 1]) - start, from, Vec3d(nearest.way), out.point_a, out.point_b);
  double least = math::length(out.point_b - out.point_a);
  for (int k = 0; k < 3; ++k) {
    if ((ends >> k & 1) == 0) continue;
    const PlacedCorners::Before face = b.face_before(p[k], p[k], p[k]);
    if (!(face.distance > 0 && double(face.distance) < least)) continue;
    const Vec3f foot = p[k] - face.normal * face.distance;
    if (b.face_before(foot, foot, foot).distance > 1e-5f) continue;  // beside the face
    least = double(face.distance);
    out.point_a = Vec3d(p[k]), out.point_b = Vec3d(foot);
  }
  if (!(least > 1e-4)) return false;
  out.overlap = false;
  out.count = 0;
  out.distance = least;
  out.normal = (out.point_b - out.point_a) * (1 / least);
  return true;
}

bool triangle_distance(const Vec3d (&corner)[3], const PlacedCorners& b, Vec3d toward_b, double cutoff, int beyond,
                       OffDirections& off, CoreDistance& out) {
  const Vec3d origin(b.origin());
  const Vec3d p[3] = {corner[0] - origin, corner[1] - origin, corner[2] - origin};
  const auto support = [&](Vec3d v) {
    const double along[3] = {dot(p[0], v), dot(p[1], v), dot(p[2], v)};
    SimplexVertex s;
    s.a = along[0] >= along[1] && along[0] >= along[2] ? p[0] : (along[1] >= along[2] ? p[1] : p[2]);
    s.b = Vec3d(b.corner(b.farthest(Vec3f(-v))));
    s.w = s.b - s.a;
    return s;
  };
  bool is_off = false;
  const Vec3f q[3] = {Vec3f(p[0]), Vec3f(p[1]), Vec3f(p[2])};
  const auto keeps_off = [&](const Vec3d& v, double reach) {
    is_off = off.may_learn(reach, v) && off.learn(Vec3f(v), q[0], q[1], q[2]);
    return is_off;
  };
  if (beyond != 0 && distance_of_edges(q, b, beyond, out))
    keeps_off(out.normal, out.distance);
  else
    gjk::search(support(toward_b), cutoff, support, keeps_off, out);
  if (is_off) return false;
  out.point_a += origin, out.point_b += origin;
  if (!out.overlap) return true;
  for (int i = 0; i < out.count; ++i) out.simplex[i].a += origin, out.simplex[i].b += origin;
  return true;
}

namespace epa {

constexpr int max_vertices = 80, max_faces = 160;
struct Face {
  int v[3];
  Vec3d normal;
  double distance;
  bool alive;
};
struct Polytope {
  RawArray<SimplexVertex, max_vertices> vertex;
  RawArray<Face, max_faces> face;
  int vertices = 0, faces = 0;
  Vec3d inside{};

  bool add_face(int i, int j, int k) {
    if (faces == max_faces) return false;
    Face& f = face[faces];
    f.v[0] = i, f.v[1] = j, f.v[2] = k;
    const Vec3d p = vertex[i].w;
    Vec3d n = cross(vertex[j].w - p, vertex[k].w - p);
    const double l = math::length(n);
    if (!(l > 1e-200)) return false;
    n *= 1 / l;
    if (dot(n, p - inside) < 0) {
      n = -n;
      f.v[1] = k, f.v[2] = j;
    }
    f.normal = n;
    f.distance = dot(n, p);
    f.alive = true;
    ++faces;
    return true;
  }
};

constexpr double unit_axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// Adds support points until the simplex is a tetrahedron with volume.
bool complete(const Placed& a, const Placed& b, SimplexVertex* s, int count, double scale) {
  const double tiny = 1e-9 * scale;
  if (count == 4 && math::abs(triple(s[1].w - s[0].w, s[2].w - s[0].w, s[3].w - s[0].w)) <= tiny * scale * scale)
    count = 3;
  if (count == 3 && math::length(cross(s[1].w - s[0].w, s[2].w - s[0].w)) <= tiny * scale) count = 2;
  if (count == 2 && math::length(s[1].w - s[0].w) <= tiny) count = 1;
  for (int k = 0; count == 1 && k < 6; ++k) {
    const Vec3d d = Vec3d{unit_axes[k / 2][0], unit_axes[k / 2][1], unit_axes[k / 2][2]} * (k & 1 ? -1.0 : 1.0);
    s[1] = gjk::support_of(a, b, d);
    if (math::length(s[1].w - s[0].w) > tiny) count = 2;
  }
  if (count == 2) {
    const Vec3d line = normalize(s[1].w - s[0].w);
    const Vec3d u = perpendicular(line), v = cross(line, u);
    constexpr double turn[6][2] = {{1, 0},  {-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386},
                                   {-1, 0}, {0.5, -0.8660254037844386}, {0.5, 0.8660254037844386}};
    for (int k = 0; count == 2 && k < 6; ++k) {
      s[2] = gjk::support_of(a, b, u * turn[k][0] + v * turn[k][1]);
      if (math::length(cross(s[2].w - s[0].w, line)) > tiny) count = 3;
    }
  }
  if (count == 3) {
    const Vec3d n = normalize(cross(s[1].w - s[0].w, s[2].w - s[0].w));
    for (int k = 0; count == 3 && k < 2; ++k) {
      s[3] = gjk::support_of(a, b, k == 0 ? n : -n);
      if (math::abs(dot(s[3].w - s[0].w, n)) > tiny) count = 4;
    }
  }
  return count == 4;
}

}  // namespace epa

bool core_depth(const Placed& a, const Placed& b, CoreDistance& d) {
  double scale = 0;
  for (const auto& x : epa::unit_axes) {
    const Vec3d axis{x[0], x[1], x[2]};
    scale = max(scale, math::length(gjk::support_of(a, b, axis).w - gjk::support_of(a, b, -axis).w));
  }
  epa::Polytope p;
  SimplexVertex s[4];
  for (int i = 0; i < d.count; ++i) s[i] = d.simplex[i];
  if (!(scale > 0) || !epa::complete(a, b, s, d.count, scale)) return false;
  for (int i = 0; i < 4; ++i) p.vertex[i] = s[i];
  p.vertices = 4;
  p.inside = (s[0].w + s[1].w + s[2].w + s[3].w) * 0.25;
  if (!p.add_face(0, 1, 2) || !p.add_face(0, 2, 3) || !p.add_face(0, 3, 1) || !p.add_face(1, 3, 2)) return false;

  epa::Face found{};
  while (true) {
    int best = 0;
    for (int i = 1; i < p.faces; ++i)
      if (p.face[i].distance < p.face[best].distance) best = i;
    found = p.face[best];
    // The polytope is of b − a: the origin lies `distance` behind this face, so moving B by −normal·distance parts
    // them.
    const SimplexVertex next = gjk::support_of(a, b, -found.normal);
    const double gain = dot(next.w, found.normal) - found.distance;
    if (gain <= 1e-7 * scale || p.vertices == epa::max_vertices) break;
    bool known = false;
    for (int i = 0; i < p.vertices; ++i) known = known || next.w == p.vertex[i].w;
    if (known) break;
    // The horizon: edges of faces that see the new point, each used once.
    int edge[epa::max_faces][2], edges = 0;
    bool fits = true;
    for (int i = 0; i < p.faces; ++i) {
      epa::Face& g = p.face[i];
      if (dot(g.normal, next.w) - g.distance <= 1e-12 * scale) continue;
      g.alive = false;
      for (int k = 0; k < 3; ++k) {
        const int u = g.v[k], v = g.v[(k + 1) % 3];
        int twin = -1;
        for (int e = 0; e < edges; ++e)
          if (edge[e][0] == v && edge[e][1] == u) twin = e;
        if (twin >= 0) {
          --edges;
          edge[twin][0] = edge[edges][0], edge[twin][1] = edge[edges][1];
        } else if (edges < epa::max_faces) {
          edge[edges][0] = u, edge[edges][1] = v;
          ++edges;
        } else {
          fits = false;
        }
      }
    }
    int alive = 0;
    for (int i = 0; i < p.faces; ++i)
      if (p.face[i].alive) {
        if (alive != i) p.face[alive] = p.face[i];
        ++alive;
      }
    p.faces = alive;
    fits = fits && edges >= 3 && edges + p.faces <= epa::max_faces;
    p.vertex[p.vertices] = next;
    for (int e = 0; fits && e < edges; ++e) fits = p.add_face(edge[e][0], edge[e][1], p.vertices);
    ++p.vertices;
    if (!fits) break;  // the last good face stands
  }
  const SimplexVertex t[3] = {p.vertex[found.v[0]], p.vertex[found.v[1]], p.vertex[found.v[2]]};
  const Vec3d q = found.normal * found.distance;
  const Vec3d e0 = t[1].w - t[0].w, e1 = t[2].w - t[0].w, e2 = q - t[0].w;
  const double d00 = dot(e0, e0), d01 = dot(e0, e1), d11 = dot(e1, e1), d20 = dot(e2, e0), d21 = dot(e2, e1);
  const double det = d00 * d11 - d01 * d01;
  double v = det > 0 ? (d11 * d20 - d01 * d21) / det : 1.0 / 3, w = det > 0 ? (d00 * d21 - d01 * d20) / det : 1.0 / 3;
  v = clamp(v, 0.0, 1.0), w = clamp(w, 0.0, 1.0 - v);
  d.point_a = t[0].a * (1 - v - w) + t[1].a * v + t[2].a * w;
  d.point_b = t[0].b * (1 - v - w) + t[1].b * v + t[2].b * w;
  d.normal = -found.normal;
  d.distance = -max(found.distance, 0.0);
  d.overlap = true;
  return true;
}

}  // namespace carom::geometry::detail
