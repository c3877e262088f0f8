// Contacts of general convex cores: the axis by distance or depth, the points by clipping the features that face it.
#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/off_directions.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::geometry::detail {
std::uint32_t pack_direction(Vec3f n) {
  const float k = 1 / (abs(n.x) + abs(n.y) + abs(n.z));
  float u = n.x * k, v = n.y * k;
  if (n.z < 0) {
    const float w = (1 - abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = w;
  }
  return std::uint32_t(int((u + 1) * 32767.0f)) << 16 | std::uint32_t(int((v + 1) * 32767.0f));
}
Vec3f unpack_direction(std::uint32_t p) {
  float u = float(p >> 16) / 32767.0f - 1, v = float(p & 0xffff) / 32767.0f - 1;
  const float z = 1 - abs(u) - abs(v);
  if (z < 0) {
    const float w = (1 - abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = w;
  }
  return normalize(Vec3f{u, v, z});
}

namespace core_pair {

constexpr std::uint8_t face_of_a = 1, face_of_b = 2, direction = cached_direction;

void place(Feature& f, const Transform3f& t) {
  for (int i = 0; i < f.count; ++i) f.point[i] = transform_point(t, f.point[i]);
  f.normal = rotate(t.q, f.normal);
}

int face_index(const Convex& c, Vec3f n) {
  if (c.kind == CoreKind::hull) return farthest(c.hull->normal_lanes, n);
  float most = -2;
  int best = -1;
  const int count = face_count(c);
  for (int i = 0; i < count; ++i) {
    const float d = dot(face_plane(c, i).normal, n);
    if (d > most) most = d, best = i;
  }
  return best;
}

struct Pair {
  const Convex &a, &b;
  const Transform3f& x;  // B in A
  float margin;

  float radius() const { return a.radius + b.radius; }
  // The corner of B that is deepest below a face of A (n in A's frame), or of A below one of B (n in B's frame), and
  // the separation of the cores along the face.
  Vec3f below_a(Vec3f n) const { return transform_point(x, Vec3f(support(b, Vec3d(-inverse_rotate(x.q, n))))); }
  Vec3f below_b(Vec3f n) const { return inverse_transform_point(x, Vec3f(support(a, Vec3d(-rotate(x.q, n))))); }
  float along_a(FacePlane p) const { return dot(p.normal, below_a(p.normal)) - p.offset; }
  float along_b(FacePlane p) const { return dot(p.normal, below_b(p.normal)) - p.offset; }
  int face_of_a(Vec3f n) const { return face_index(a, n); }
  int face_of_b(Vec3f n) const { return face_index(b, -inverse_rotate(x.q, n)); }  // n from A to B, in A's frame
  Vec3f normal_of_b(int face) const { return -rotate(x.q, face_plane(b, face).normal); }
  float along_face_of_a(int face) const { return along_a(face_plane(a, face)); }
  float along_face_of_b(int face) const { return along_b(face_plane(b, face)); }
  // Separation of the cores along n, from A to B in A's frame.
  float along(Vec3f n) const {
    const Vec3f on_a = Vec3f(support(a, Vec3d(n))), on_b = Vec3f(support(b, Vec3d(-inverse_rotate(x.q, n))));
    return dot(n, transform_point(x, on_b) - on_a);
  }
  void clip_a(const Feature& face, ContactPoints& points) const {
    Feature incident;
    feature(b, -inverse_rotate(x.q, face.normal), incident);
    place(incident, x);
    clip_to_face(face, a.radius, incident, b.radius, margin, 0, points);
  }
  void clip_b(Feature face, ContactPoints& points) const {
    place(face, x);
    Feature incident;
    feature(a, -face.normal, incident);
    clip_to_face(face, b.radius, incident, a.radius, margin, 0x80000000u, points);
  }
  /// Of a face of A or B, towards n (from A to B, in A's frame).
  Vec3f clip(bool of_a, int face, Vec3f n, ContactPoints& points) const {
    Feature flat;
    if (of_a) {
      face_feature(a, face, n, flat);
      clip_a(flat, points);
      return flat.normal;
    }
    face_feature(b, face, -inverse_rotate(x.q, n), flat);
    clip_b(flat, points);
    return -rotate(x.q, flat.normal);
  }
};

/// What clip_to_face finds of the line of a ball or capsule over a triangle, for far less. Returns whether anything.
bool clip_line(const Convex& t, const Convex& b, Vec3f center, Vec3f end, float margin, float widen,
               ContactPoints& out) {
  const int count = b.kind == CoreKind::point ? 1 : 2;
  Vec3f p[2] = {center - end, center + end};
  std::uint32_t name[2] = {0, 1};
  for (std::uint32_t e = 0; e < 3; ++e) {
    const Vec3f a = t.corner[e], side = cross(t.corner[e == 2 ? 0 : e + 1] - a, t.normal);  // outward
    const float size = dot(side, side), tolerance = max(1e-5f * size, widen > 0 ? widen * math::sqrt(size) : 0.0f);
    const float first = dot(side, p[0] - a), second = count == 2 ? dot(side, p[1] - a) : first;
    const bool out_first = first > tolerance, out_second = second > tolerance;
    if (!out_first && !out_second) continue;
    if (out_first && out_second) return false;
    const float from = out_first ? first : min(first, 0.0f), to = out_second ? second : min(second, 0.0f);
    const Vec3f cut = p[0] + (p[1] - p[0]) * (from / (from - to));
    const std::uint32_t low = min(name[0], name[1]), high = max(name[0], name[1]);
    const int replaced = out_first ? 0 : 1;
    p[replaced] = cut;
    name[replaced] = (e + 1) << 8 | ((low * 31 + high * 7) & 0xffff) << 14 | (low & 0xff);
  }
  const int before = out.count;
  for (int i = 0; i < count; ++i) {
    const float height = dot(t.normal, p[i] - t.corner[0]), s = height - b.radius;
    if (s <= margin) out.add(p[i] - t.normal * (0.5f * (b.radius + height)), s, name[i]);
  }
  return out.count > before;
}

/// A triangle (A) and the line of a ball or capsule, from its middle to an end.
struct LinePair : Pair {
  Vec3f center, end;

  int face_of_a(Vec3f) const { return 0; }
  int face_of_b(Vec3f) const { return -1; }
  Vec3f normal_of_b(int) const { return {}; }
  float along_face_of_a(int) const { return dot(a.normal, center - a.corner[0]) - abs(dot(a.normal, end)); }
  float along_face_of_b(int) const { return -1e30f; }
  Vec3f clip(bool, int, Vec3f, ContactPoints& points) const {
    clip_line(a, b, center, end, margin, 0, points);
    return a.normal;
  }
};

/// A triangle (A) and a shape whose corners and faces are placed already: what is asked of them costs far less.
struct TrianglePair : Pair {
  const PlacedCorners& corners;

  int face_of_a(Vec3f) const { return 0; }
  int face_of_b(Vec3f n) const { return corners.face_toward(-n); }
  Vec3f normal_of_b(int face) const { return -corners.plane(face).normal; }
  float along_face_of_a(int) const {
    return dot(a.normal, corners.corner(corners.farthest(-a.normal)) + x.p - a.corner[0]);
  }
  float along_face_of_b(int face) const {
    const FacePlane plane = corners.plane(face);
    const Vec3f m = plane.normal;
    return min(dot(m, a.corner[0] - x.p), min(dot(m, a.corner[1] - x.p), dot(m, a.corner[2] - x.p))) - plane.offset;
  }
  Vec3f clip(bool of_a, int face, Vec3f n, ContactPoints& points) const {
    if (!of_a) return Pair::clip(of_a, face, n, points);
    corners.clip_face(a.corner, a.normal, b.radius, margin, 0, points);
    return a.normal;
  }
};

float least_separation(const ContactPoints& c) {
  float s = c.point[0].separation;
  for (int i = 1; i < c.count; ++i) s = min(s, c.point[i].separation);
  return s;
}

// What is round and leans over the border of a face by an angle θ, meets its edge r (1 − cos θ) sooner than the face
// tells. More than that, by the shape's size, is not to be overlooked: what rocks there would be lifted by it whenever
// the edge takes over.
constexpr float overlooked = 1e-3f;  // half of it, as cos θ is 1 − θ²/2
bool leans(const Pair& pair, const ContactPoints& points, Vec3f corner, float deeper, Vec3f n, float small) {
  if (pair.radius() == 0) return false;
  float beside = 1e30f;
  for (int i = 0; i < points.count; ++i) {
    const Vec3f d = points.point[i].point - corner;
    beside = min(beside, math::length_squared(d - n * dot(n, d)));
  }
  return deeper * deeper * pair.radius() > overlooked * small * beside;
}

// The face that held the contact last time holds it still, if it is shallow and the features still overlap on it.
bool keep_face(const Pair& pair, const PairCache& cache, float small, Manifold3& out, bool& apart) {
  const float shallow = 0.04f * small + 0.5f * pair.radius();
  const bool of_a = cache.kind == face_of_a;
  const Convex& c = of_a ? pair.a : pair.b;
  if (cache.d >= std::uint32_t(face_count(c))) return false;
  const FacePlane plane = face_plane(c, int(cache.d));
  Vec3f corner = of_a ? pair.below_a(plane.normal) : pair.below_b(plane.normal);
  const float s = dot(plane.normal, corner) - plane.offset;
  if (s - pair.radius() > pair.margin) {
    apart = true;
    out.points[0].separation = s - pair.radius();
    out.normal = of_a ? plane.normal : -rotate(pair.x.q, plane.normal);
    return true;
  }
  if (s < -shallow) return false;
  Feature face;
  face_feature(c, int(cache.d), plane.normal, face);
  ContactPoints points;
  if (of_a)
    pair.clip_a(face, points);
  else
    pair.clip_b(face, points);
  // It tells the true separation only where the nearest corner is over it.
  const float deeper = points.count > 0 ? least_separation(points) - (s - pair.radius()) : 1e30f;
  if (deeper > 0.05f * abs(s) + 0.01f * shallow) return false;
  const Vec3f n = of_a ? face.normal : -rotate(pair.x.q, face.normal);
  if (!of_a) corner = transform_point(pair.x, corner);
  if (leans(pair, points, corner, deeper, n, small)) return false;
  write_points(points, n, out);
  return true;
}

// Sharp shapes side by side with a flat face of each level with the other's (an upright cylinder before the next tile):
// where they meet only in a strip narrower than a small tolerance, a contact across the row would catch on the joint.
bool grazes(const Convex& a, const Convex& b, const Transform3f& b_in_a, Vec3f n, float tolerance) {
  if (face_count(a) > 12) return false;
  const Pair pair{a, b, b_in_a, 0};
  for (int i = 0; i < face_count(a); ++i) {
    const FacePlane plane = face_plane(a, i);
    if (abs(dot(plane.normal, n)) > 0.3f) continue;
    const Vec3f facing = -inverse_rotate(b_in_a.q, plane.normal);
    const int k = face_index(b, facing);
    if (k < 0 || dot(face_plane(b, k).normal, facing) < 0.9998f) continue;
    if (pair.along_a(plane) > -tolerance) return true;
  }
  return false;
}

float half_length(const Convex& c) {
  if (c.kind == CoreKind::triangle) return 1e30f;
  const Vec3f half = c.kind == CoreKind::hull ? c.hull->bounds.extents() : c.half;
  return max(half.x, max(half.y, half.z));
}

/// What faces show each other along the normal of two edges that cross (facing_cosine).
void clip_beside(const Pair& pair, Vec3f n, float facing_a, float facing_b, ContactPoints& points) {
  Feature on_a, on_b;
  feature(pair.a, n, on_a);
  feature(pair.b, -inverse_rotate(pair.x.q, n), on_b);
  place(on_b, pair.x);
  const bool of_a = on_a.count > 2 && (on_b.count <= 2 || facing_a >= facing_b);
  const Feature& face = of_a ? on_a : on_b;
  Feature& other = of_a ? on_b : on_a;
  if (face.count <= 2) return;
  const Vec3f along = of_a ? n : -n, lean = along - face.normal;
  const float scale = 1 / dot(along, face.normal), radius_r = of_a ? pair.a.radius : pair.b.radius;
  for (int i = 0; i < other.count; ++i)
    other.point[i] -= lean * (scale * dot(face.normal, other.point[i] - face.point[0]));
  clip_to_face(face, radius_r, other, pair.radius() - radius_r, pair.margin, of_a ? 0x20000000u : 0xa0000000u, points);
  for (int i = 0; i < points.count; ++i) points.point[i].point += lean * (0.5f * points.point[i].separation + radius_r);
}

// Contacts for the normal n (A to B, in A's frame) with core separation d. Returns the cache entry.
template <class AnyPair>
void points_for(const AnyPair& pair, const CoreDistance& found, float slack, PairCache& cache, Manifold3& out) {
  const Vec3f n = normalize(Vec3f(found.normal));
  const float d = float(found.distance);
  const int fa = pair.face_of_a(n), fb = pair.face_of_b(n);
  const float sa = fa >= 0 ? pair.along_face_of_a(fa) : -1e30f, sb = fb >= 0 ? pair.along_face_of_b(fb) : -1e30f;
  if (pair.radius() == 0 && pair.a.kind != CoreKind::triangle && slack > 0) {
    const float graze = min(40 * slack, 0.005f);  // 2 % of the smaller shape
    if (d > -graze && (grazes(pair.a, pair.b, pair.x, n, graze) ||
                       grazes(pair.b, pair.a, inverse(pair.x), inverse_rotate(pair.x.q, n), graze))) {
      cache.kind = direction;
      cache.d = pack_direction(n);
      return;
    }
  }
  const float tolerance = d > 0 ? 0.01f * d + 0.02f * slack : 0.05f * -d + slack;
  const auto level = [&](Vec3f face) { return d <= 0 || pair.radius() * (1 - dot(face, n)) < 0.5f * slack; };
  const bool use_a = sa >= d - tolerance && level(face_plane(pair.a, fa).normal);
  const bool use_b = sb >= d - tolerance && level(pair.normal_of_b(fb));
  for (int attempt = 0; attempt < 2; ++attempt) {
    const bool of_a = (attempt == 0) == (use_a && (!use_b || sb <= sa + slack));
    if (!(of_a ? use_a : use_b)) continue;
    ContactPoints points;
    const Vec3f normal = pair.clip(of_a, of_a ? fa : fb, n, points);
    if (points.count == 0) continue;
    // The deepest corner may stand outside the face, or belong to another face than the one clipped.
    const float deepest = (of_a ? sa : sb) - pair.radius();
    if (least_separation(points) > deepest + 0.05f * abs(deepest) + slack && deepest <= pair.margin) {
      const Vec3f pa = Vec3f(found.point_a) + n * pair.a.radius, pb = Vec3f(found.point_b) - n * pair.b.radius;
      points.add((pa + pb) * 0.5f, d - pair.radius(), 0x20000000u);
    }
    write_points(points, normal, out);
    cache.kind = of_a ? face_of_a : face_of_b;
    cache.d = std::uint32_t(of_a ? fa : fb);
    return;
  }
  cache.kind = direction;
  cache.d = pack_direction(n);
  // Over the border of a face: see border_tolerance.
  const auto roundness = [](const Convex& c) {
    return c.kind == CoreKind::ellipsoid ? inner_size(c) : is_round(c) ? c.half.x : c.radius;
  };
  const float border = border_tolerance(roundness(pair.a) + roundness(pair.b));
  Vec3f pushed = n;
  bool beyond = false;  // above the face's level and well beside it: nothing to meet yet
  if (border > 0 && d - pair.radius() > -border) {
    if (fa >= 0 && pair.a.radius == 0 && sa - pair.radius() > -border) {
      const Vec3f f = face_plane(pair.a, fa).normal;
      if (dot(f, n) > border_cosine)
        pushed = f;
      else
        beyond = d > pair.radius();
    }
    if (fb >= 0 && pair.b.radius == 0 && sb - pair.radius() > -border && pushed == n) {
      const Vec3f f = pair.normal_of_b(fb);
      if (dot(f, n) > border_cosine)
        pushed = f;
      else
        beyond = beyond || d > pair.radius();
    }
  }
  if (beyond) return;
  // Two straight sides along each other touch in two points.
  Vec3f la[2], lb[2];
  if (side_line(pair.a, n, la) && side_line(pair.b, -inverse_rotate(pair.x.q, n), lb)) {
    for (Vec3f& p : lb) p = transform_point(pair.x, p);
    const Vec3f da = la[1] - la[0], db = lb[1] - lb[0];
    const float length_a = length(da), length_b = length(db);
    const float sine = length(cross(da, db)) / (length_a * length_b);
    if (sine < (pair.radius() > 0 ? 0.5f : 0.03f)) {
      const Vec3f t = da * (1 / length_a);
      float t0 = dot(lb[0] - la[0], t), t1 = dot(lb[1] - la[0], t);
      float low = max(0.0f, min(t0, t1)), high = min(length_a, max(t0, t1)), least = 1e-3f * length_a;
      // Round ones that cross touch along a stretch, as capsules do (along_each_other).
      if (sine >= 0.03f) {
        const float middle = dot(Vec3f(found.point_a) - la[0], t), width = 0.0447f * max(d, 0.0f) / sine;
        low = max(low, middle - width), high = min(high, middle + width), least = 0.1f * length_a;
      }
      if (high - low > least) {
        out.normal = pushed;
        out.count = 0;
        for (int k = 0; k < 2; ++k) {
          const float u = k == 0 ? low : high;
          const Vec3f pa = la[0] + t * u, pb = lb[0] + db * ((u - t0) / (t1 - t0));
          const float s = dot(n, pb - pa) - pair.radius();
          if (s > pair.margin) continue;
          const std::uint32_t name = 0x40000000u | std::uint32_t(k);
          out.points[out.count++] = {(pa + n * pair.a.radius + pb - n * pair.b.radius) * 0.5f, s, name};
        }
        if (out.count > 0) return;
      }
    }
  }
  const float s = d - pair.radius();
  if (s > pair.margin) return;
  const Vec3f pa = Vec3f(found.point_a) + n * pair.a.radius, pb = Vec3f(found.point_b) - n * pair.b.radius;
  const ManifoldPoint3 nearest = {(pa + pb) * 0.5f, s, 0x20000000u};
  const float facing_a = fa >= 0 ? dot(face_plane(pair.a, fa).normal, n) : -1;
  const float facing_b = fb >= 0 ? dot(pair.normal_of_b(fb), n) : -1;
  if (max(facing_a, facing_b) >= facing_cosine && d > -shallow_share * min(half_length(pair.a), half_length(pair.b))) {
    ContactPoints points;
    clip_beside(pair, n, facing_a, facing_b, points);
    if (points.count == 0 || least_separation(points) > s + 0.05f * abs(s) + slack)
      points.add(nearest.point, nearest.separation, nearest.feature);
    write_points(points, pushed, out);
    return;
  }
  out.normal = pushed;
  out.count = 1;
  out.points[0] = nearest;
}

}  // namespace core_pair

void collide_cores(const Convex& a, const Convex& b, const Transform3f& x, float margin, PairCache& cache,
                   Manifold3& out) {
  using namespace core_pair;
  const Pair pair{a, b, x, margin};
  float small = 1e30f;
  for (const Convex* c : {&a, &b})
    if (const float s = inner_size(*c); s > 0) small = min(small, s);
  if (cache.kind == face_of_a || cache.kind == face_of_b) {
    bool apart = false;
    if (keep_face(pair, cache, small, out, apart)) return;
  }
  Vec3f guess{};
  if (cache.kind == direction) {
    guess = unpack_direction(cache.d);
    const float s = pair.along(guess) - pair.radius();
    if (s > margin) {
      out.points[0].separation = s;
      out.normal = guess;
      return;
    }
  }
  const Placed pa(a), pb(b, x);
  CoreDistance found;
  core_distance(pa, pb, double(pair.radius()) + double(margin), Vec3d(guess), found);
  if (!found.overlap && found.distance > double(pair.radius()) + double(margin)) {
    cache.kind = direction;
    cache.d = pack_direction(Vec3f(found.normal));
    out.points[0].separation = float(found.distance) - pair.radius();
    out.normal = normalize(Vec3f(found.normal));
    return;
  }
  if (found.overlap && !core_depth(pa, pb, found)) {
    Vec3d n = pb.center() - pa.center();
    n = length(n) > 1e-9 ? normalize(n) : Vec3d{0, 1, 0};
    found.normal = n, found.distance = 0;
  }
  points_for(pair, found, 5e-4f * small, cache, out);
}

bool collide_triangle(const Convex& t, std::uint8_t edges, bool solid, const Convex& b, const PlacedCorners& corners,
                      const Transform3f& x, float margin, Vec3f held, OffDirections& off, ContactPoints& out,
                      Vec3f& normal) {
  using namespace core_pair;
  const int flat_edges = edges & (edge0_flat | edge1_flat | edge2_flat);
  const Pair pair{t, b, x, margin};
  // Balls and capsules: what stands for them is a line about their middle, and most is known in closed form.
  const bool line = b.kind == CoreKind::point || b.kind == CoreKind::segment;
  const Vec3f center = line ? x.p : corners.known() ? corners.middle() + x.p : transform_point(x, inner_point(b));
  const Vec3f end = line ? rotate(x.q, Vec3f{0, b.half.y, 0}) : Vec3f{};
  const float behind = dot(t.normal, center - t.corner[0]);
  if (solid ? behind < -2 * (outer_size(b) + b.radius) : behind + dot(t.normal, held) < 0) return false;
  // The point that comes nearest to the triangle's plane, and how near, without the radius.
  Vec3f foot{};
  if (corners.known())
    foot = corners.corner(corners.farthest(-t.normal)) + x.p;
  else if (line)
    foot = dot(t.normal, end) > 0 ? center - end : center + end;
  else
    foot = transform_point(x, Vec3f(support(b, Vec3d(-inverse_rotate(x.q, t.normal)))));
  const float along_face = line ? behind - abs(dot(t.normal, end)) : dot(t.normal, foot - t.corner[0]);
  if (along_face - pair.radius() > margin) return false;
  const float small = max(inner_size(b), 1e-6f);
  // Beside the triangle, farther than anything may reach? Three support points tell that sooner than the search for a
  // distance.
  if (!line && !corners.known()) {
    const float reach = 1.0001f * (pair.radius() + margin) + 0.02f * small;
    for (int e = 0; e < 3; ++e) {
      const Vec3f outward = cross(t.corner[e == 2 ? 0 : e + 1] - t.corner[e], t.normal);
      const Vec3f nearest = transform_point(x, Vec3f(support(b, Vec3d(-inverse_rotate(x.q, outward)))));
      const float beyond = dot(outward, nearest - t.corner[e]);
      if (beyond > 0 && beyond * beyond > reach * reach * length_squared(outward)) return false;
    }
  }

  const auto on_face = [&] {
    if (line) {
      normal = t.normal;
      return clip_line(t, b, center, end, margin, flat_edges != 0 ? 0.0175f * b.radius : 0.0f, out);
    }
    // Between two faces that meet in a flat edge a ball's centre may be over neither: sin 1° of its radius.
    const float widen = flat_edges != 0 ? 0.0175f * (b.kind == CoreKind::ellipsoid ? inner_size(b) : b.radius) : 0.0f;
    const int before = out.count;
    if (corners.known()) {
      corners.clip_face(t.corner, t.normal, b.radius, margin, widen, out);
    } else {
      Feature face, incident;
      face_feature(t, 0, t.normal, face);
      feature(b, -inverse_rotate(x.q, t.normal), incident);
      place(incident, x);
      clip_to_face(face, 0, incident, b.radius, margin, 0, out, widen);
    }
    normal = t.normal;
    return out.count > before;
  };
  if (flat_edges == 7 || along_face > -0.02f * small) {
    // Nothing but the face may push, or it is shallow: where something stands over the face, the face it is.
    if (flat_edges == 7 || along_face <= 0)
      if (on_face()) return true;
    if (flat_edges == 7) return false;
  }
  const double cutoff = double(pair.radius()) + double(margin);
  CoreDistance found;
  const Vec3d own[3] = {Vec3d(t.corner[0]), Vec3d(t.corner[1]), Vec3d(t.corner[2])};
  // What stands over the face with the point that comes nearest to its plane has no nearer one. Else the nearest point
  // of the triangle lies on an edge that the foot is beyond: distances from a convex shape are a convex function, and
  // grow on every way away from its foot. Where all of these are flat, the contact is the neighbours'. The same holds
  // of any point of the plane that is in the shape, unless an edge that it is beyond goes through the shape.
  int beyond = 0;
  const auto look_beyond = [&](Vec3f p) {
    for (int e = 0; e < 3; ++e)
      if (dot(cross(t.corner[e == 2 ? 0 : e + 1] - t.corner[e], t.normal), p - t.corner[e]) > 0) beyond |= 1 << e;
  };
  if (along_face > 0) {
    look_beyond(foot);
  } else if (corners.has_faces() && behind > 0) {
    look_beyond(foot + (center - foot) * (along_face / (along_face - behind)));
    for (int e = 0; e < 3; ++e)
      if ((beyond >> e & 1) != 0 &&
          corners.meets_segment(t.corner[e] - x.p, t.corner[e == 2 ? 0 : e + 1] - t.corner[e]))
        beyond = 0;
  }
  if (line ? along_face > 0 && (beyond & ~flat_edges) == 0 : beyond != 0 && (beyond & ~flat_edges) == 0)
    return on_face();
  const auto stands_over = [&] {
    if (line || along_face <= 0 || beyond != 0) return false;
    found.distance = double(along_face);
    found.normal = Vec3d(t.normal);
    found.point_b = Vec3d(foot);
    found.point_a = found.point_b - found.normal * found.distance;
    return true;
  };
  const auto in_closed_form = [&] {
    return line &&
           triangle_segment_distance(own, Vec3d(center) + Vec3d(end), Vec3d(center) - Vec3d(end), cutoff, found);
  };
  if (!in_closed_form() && !stands_over()) {
    if (!corners.known())
      core_distance(Placed(t), Placed(b, x), cutoff, {}, found);
    else if (!triangle_distance(own, corners, Vec3d(t.normal), cutoff, beyond, off, found))
      return false;
    if (found.overlap && !core_depth(Placed(t), Placed(b, x), found)) return on_face();
  }
  if (!found.overlap && found.distance > cutoff) return false;
  const Vec3f n = normalize(Vec3f(found.normal)), p = Vec3f(found.point_a);
  // The Gauss map of the surface, edge by edge: a direction that leans over a flat or concave edge is not on it.
  bool legal = dot(n, t.normal) > -1e-3f;
  const bool grazes = along_face - pair.radius() > -min(0.02f * small, 0.005f);
  for (int e = 0; e < 3; ++e) {
    const bool open = grazes && (edges & edge0_open << e) != 0;
    if ((flat_edges >> e & 1) == 0 && !open) continue;
    const Vec3f a = t.corner[e], d = t.corner[e == 2 ? 0 : e + 1] - a;
    const Vec3f outward = cross(d, t.normal);
    const float l = length(outward);
    if (dot(outward, p - a) < -1e-3f * l * l) continue;
    if (dot(n, outward) <= 1e-3f * l) continue;
    if (open) return false;
    legal = false;
  }
  if (!legal) return on_face();
  PairCache cache;
  Manifold3 m;
  if (corners.has_faces())
    points_for(TrianglePair{pair, corners}, found, 5e-4f * small, cache, m);
  else if (line)
    points_for(LinePair{pair, center, end}, found, 5e-4f * small, cache, m);
  else
    points_for(pair, found, 5e-4f * small, cache, m);
  for (int i = 0; i < m.count; ++i) out.add(m.points[i].point, m.points[i].separation, m.points[i].feature);
  normal = m.normal;
  return m.count > 0;
}

void collide_plane(const Plane& plane, const Convex& b, const Transform3f& x, float margin, Manifold3& out) {
  const Vec3f n = plane.normal;
  const Vec3f down = -inverse_rotate(x.q, n);
  ContactPoints points;
  const auto add = [&](Vec3f local, std::uint32_t id) {
    const Vec3f p = transform_point(x, local);
    const float s = dot(n, p) - b.radius;
    if (s <= margin) points.add(p - n * (b.radius + 0.5f * s), s, id);
  };
  if (b.kind == CoreKind::hull) {
    const std::vector<Vec3f>& v = b.hull->vertices;
    for (std::size_t i = 0; i < v.size() && points.count < ContactPoints::capacity; ++i) add(v[i], std::uint32_t(i));
  } else if (b.kind == CoreKind::box) {
    for (int i = 0; i < 8; ++i)
      add({i & 1 ? b.half.x : -b.half.x, i & 2 ? b.half.y : -b.half.y, i & 4 ? b.half.z : -b.half.z}, std::uint32_t(i));
  } else {
    Feature f;
    feature(b, down, f);
    for (int i = 0; i < f.count; ++i) add(f.point[i], f.id[i]);
  }
  write_points(points, n, out);
}

}  // namespace carom::geometry::detail
