#include "carom/geometry/detail/convex.h"

#include "carom/geometry/detail/corner_lanes.h"

namespace carom::geometry::detail {

Convex convex_of(const Shape3& s) {
  Convex c;
  switch (s.type) {
    case ShapeType3::sphere:
      c.radius = s.sphere.radius;
      break;
    case ShapeType3::capsule:
      c.kind = s.capsule.half_length > 0 ? CoreKind::segment : CoreKind::point;
      c.half = {0, s.capsule.half_length, 0};
      c.radius = s.capsule.radius;
      break;
    case ShapeType3::box:
      c.kind = CoreKind::box;
      c.half = s.box.half_extents;
      c.radius = s.box.radius;
      break;
    case ShapeType3::cylinder:
      c.kind = CoreKind::cylinder;
      c.half = {s.cylinder.radius, s.cylinder.half_height, s.cylinder.radius};
      c.radius = s.cylinder.rounding;
      break;
    case ShapeType3::cone:
      c.kind = CoreKind::cone;
      c.half = {s.cone.radius, s.cone.half_height, s.cone.radius};
      c.radius = s.cone.rounding;
      break;
    case ShapeType3::ellipsoid:
      c.kind = CoreKind::ellipsoid;
      c.half = s.ellipsoid.radii;
      break;
    case ShapeType3::hull:
      c.kind = CoreKind::hull;
      c.hull = s.hull;
      c.radius = s.hull->radius;
      break;
    default:
      break;
  }
  return c;
}

Convex convex_of_triangle(Vec3f a, Vec3f b, Vec3f c) {
  Convex t;
  t.kind = CoreKind::triangle;
  t.corner[0] = a, t.corner[1] = b, t.corner[2] = c;
  t.normal = Vec3f(normalize(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a))));
  return t;
}

float inner_size(const Convex& c) {
  switch (c.kind) {
    case CoreKind::point:
    case CoreKind::segment:
      return c.radius;
    case CoreKind::box:
    case CoreKind::ellipsoid:
      return min(c.half.x, min(c.half.y, c.half.z)) + c.radius;
    case CoreKind::cylinder:
    case CoreKind::cone:
      return min(c.half.x, c.half.y) + c.radius;
    case CoreKind::hull:
      return c.hull->inner_radius + c.radius;
    case CoreKind::triangle:
      return 0;
  }
  return 0;
}

float outer_size(const Convex& c) {
  switch (c.kind) {
    case CoreKind::hull: {
      float most = 0;
      for (const Vec3f& v : c.hull->vertices) most = max(most, length_squared(v));
      return math::sqrt(most);
    }
    case CoreKind::triangle:
      return math::sqrt(
          max(length_squared(c.corner[0]), max(length_squared(c.corner[1]), length_squared(c.corner[2]))));
    case CoreKind::cylinder:
    case CoreKind::cone:
      return math::sqrt(c.half.x * c.half.x + c.half.y * c.half.y);
    case CoreKind::ellipsoid:
      return max(c.half.x, max(c.half.y, c.half.z));
    default:
      return length(c.half);
  }
}

Vec3f inner_point(const Convex& c) {
  if (c.kind == CoreKind::hull) return c.hull->centroid;
  if (c.kind == CoreKind::triangle) return (c.corner[0] + c.corner[1] + c.corner[2]) * (1.0f / 3);
  if (c.kind == CoreKind::cone) return {0, -0.5f * c.half.y, 0};
  return {};
}

bool is_round(const Convex& c) { return c.kind == CoreKind::cylinder || c.kind == CoreKind::cone; }
bool is_polyhedron(const Convex& c) { return c.kind == CoreKind::box || c.kind >= CoreKind::hull; }

static Vec3d rim_point(const Convex& c, double y, Vec3d d) {
  const double across = math::sqrt(d.x * d.x + d.z * d.z);
  if (!(across > 1e-30)) return {double(c.half.x), y, 0};
  const double k = double(c.half.x) / across;
  return {d.x * k, y, d.z * k};
}

int farthest(const float* lanes, int blocks, Vec3f d) {
  return corner_kernels().farthest(lanes, blocks, d.x, d.y, d.z);
}

Vec3d support(const Convex& c, Vec3d d) {
  switch (c.kind) {
    case CoreKind::point:
      return {};
    case CoreKind::segment:
      return {0, d.y < 0 ? -double(c.half.y) : double(c.half.y), 0};
    case CoreKind::box:
      return {d.x < 0 ? -double(c.half.x) : double(c.half.x), d.y < 0 ? -double(c.half.y) : double(c.half.y),
              d.z < 0 ? -double(c.half.z) : double(c.half.z)};
    case CoreKind::cylinder:
      return rim_point(c, d.y < 0 ? -double(c.half.y) : double(c.half.y), d);
    case CoreKind::cone: {
      const Vec3d base = rim_point(c, -double(c.half.y), d), apex{0, double(c.half.y), 0};
      return dot(apex, d) >= dot(base, d) ? apex : base;
    }
    case CoreKind::ellipsoid: {
      const Vec3d radii(c.half), scaled = scale(radii, d);
      const double l = math::length(scaled);
      return l > 1e-150 ? scale(radii, scaled * (1 / l)) : Vec3d{radii.x, 0, 0};
    }
    case CoreKind::hull:
      return Vec3d(c.hull->vertices[std::size_t(farthest(c.hull->vertex_lanes, Vec3f(d)))]);
    case CoreKind::triangle: {
      const Vec3d p[3] = {Vec3d(c.corner[0]), Vec3d(c.corner[1]), Vec3d(c.corner[2])};
      const double x = dot(p[0], d), y = dot(p[1], d), z = dot(p[2], d);
      return x >= y && x >= z ? p[0] : (y >= z ? p[1] : p[2]);
    }
  }
  return {};
}

int face_count(const Convex& c) {
  switch (c.kind) {
    case CoreKind::box:
      return 6;
    case CoreKind::cylinder:
      return 2;
    case CoreKind::cone:
    case CoreKind::triangle:
      return 1;
    case CoreKind::hull:
      return int(c.hull->planes.size());
    default:
      return 0;
  }
}

FacePlane face_plane(const Convex& c, int face) {
  switch (c.kind) {
    case CoreKind::box: {
      Vec3f n{};
      n[face >> 1] = (face & 1) ? -1.0f : 1.0f;
      return {n, c.half[face >> 1]};
    }
    case CoreKind::cylinder:
      return {{0, face == 0 ? 1.0f : -1.0f, 0}, c.half.y};
    case CoreKind::cone:
      return {{0, -1, 0}, c.half.y};
    case CoreKind::hull: {
      const HullPlane& p = c.hull->planes[std::size_t(face)];
      return {p.normal, p.offset};
    }
    default:
      return {c.normal, dot(c.normal, c.corner[0])};
  }
}

// The rim as eight fixed corners, of a tilted disc sixteen, and the point lowest along `toward`, so that a tilted disc
// stands on its true rim, and what rocks on it finds the next points nearly as high as the rim is there.
static void add_disc(const Convex& c, float y, bool upward, Vec3f toward, Feature& out) {
  constexpr int sides = 16;
  constexpr float s = 0.70710678118654752f, c1 = 0.92387953251128674f, s1 = 0.38268343236508977f;
  constexpr float table[sides][2] = {{1, 0},  {c1, s1},   {s, s},   {s1, c1},   {0, 1},  {-s1, c1}, {-s, s}, {-c1, s1},
                                     {-1, 0}, {-c1, -s1}, {-s, -s}, {-s1, -c1}, {0, -1}, {s1, -c1}, {s, -s}, {c1, -s1}};
  const float across = math::sqrt(toward.x * toward.x + toward.z * toward.z);
  const float r = c.half.x;
  const int step = across > 0.01f ? 1 : 2;
  int lowest_after = -1;
  float lx = 0, lz = 0;
  if (across > 1e-4f) {
    lx = toward.x / across, lz = toward.z / across;
    float most = -2;
    int near = 0;
    for (int i = 0; i < sides; i += step) {
      const float a = table[i][0] * lx + table[i][1] * lz;
      if (a > most) most = a, near = i;
    }
    if (most < 0.99999f) {
      const float side = table[near][0] * lz - table[near][1] * lx;
      lowest_after = side > 0 ? near : (near + sides - step) % sides;
    }
  }
  Feature ring;
  for (int i = 0; i < sides; i += step) {
    ring.add({table[i][0] * r, y, table[i][1] * r}, i);
    if (i == lowest_after) ring.add({lx * r, y, lz * r}, sides);
  }
  // x towards z is clockwise seen from +y.
  for (int i = 0; i < ring.count; ++i) {
    const int k = upward ? ring.count - 1 - i : i;
    out.add(ring.point[k], ring.id[k] + (upward ? 64 : 0));
  }
  out.normal = {0, upward ? 1.0f : -1.0f, 0};
}

void face_feature(const Convex& c, int face, Vec3f toward, Feature& out) {
  out.count = 0;
  switch (c.kind) {
    case CoreKind::box: {
      const int axis = face >> 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
      const float sign = (face & 1) ? -1.0f : 1.0f;
      constexpr int turn[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
      for (int i = 0; i < 4; ++i) {
        const int k = sign > 0 ? i : 3 - i;
        Vec3f p;
        p[axis] = sign * c.half[axis];
        p[u] = float(turn[k][0]) * c.half[u];
        p[v] = float(turn[k][1]) * c.half[v];
        out.add(p, (p.x > 0 ? 1 : 0) | (p.y > 0 ? 2 : 0) | (p.z > 0 ? 4 : 0));
      }
      out.normal = {};
      out.normal[axis] = sign;
      return;
    }
    case CoreKind::cylinder:
      add_disc(c, face == 0 ? c.half.y : -c.half.y, face == 0, toward, out);
      return;
    case CoreKind::cone:
      add_disc(c, -c.half.y, false, toward, out);
      return;
    case CoreKind::hull: {
      const Hull& h = *c.hull;
      const HullFace& f = h.faces[std::size_t(face)];
      const int n = f.edge_count, step = (n + 19) / 20;
      std::uint16_t e = f.first_edge;
      for (int i = 0; i < n; ++i, e = h.edges[e].next)
        if (i % step == 0) out.add(h.vertices[h.edges[e].origin], h.edges[e].origin);
      out.normal = h.planes[std::size_t(face)].normal;
      return;
    }
    default:
      for (int i = 0; i < 3; ++i) out.add(c.corner[i], i);
      out.normal = c.normal;
  }
}

void feature(const Convex& c, Vec3f d, Feature& out) {
  out.count = 0;
  out.normal = d;
  switch (c.kind) {
    case CoreKind::point:
      out.add({}, 0);
      return;
    case CoreKind::ellipsoid:
      out.add(Vec3f(support(c, Vec3d(d))), 0);
      return;
    case CoreKind::segment:
      out.add({0, -c.half.y, 0}, 0);
      out.add({0, c.half.y, 0}, 1);
      return;
    case CoreKind::box: {
      const Vec3f a = abs(d);
      const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
      return face_feature(c, 2 * axis + (d[axis] < 0 ? 1 : 0), d, out);
    }
    case CoreKind::cylinder: {
      if (abs(d.y) > 0.70710678f) return face_feature(c, d.y > 0 ? 0 : 1, d, out);
      Vec3f line[2];
      const float across = math::sqrt(d.x * d.x + d.z * d.z);
      const float x = d.x / across * c.half.x, z = d.z / across * c.half.x;
      line[0] = {x, -c.half.y, z}, line[1] = {x, c.half.y, z};
      out.add(line[0], 40);
      out.add(line[1], 41);
      return;
    }
    case CoreKind::cone: {
      const float across = math::sqrt(d.x * d.x + d.z * d.z);
      const float slant = math::sqrt(4 * c.half.y * c.half.y + c.half.x * c.half.x);
      const float side = (across * 2 * c.half.y + d.y * c.half.x) / slant;
      if (-d.y > side) return face_feature(c, 0, d, out);
      const float x = across > 1e-6f ? d.x / across * c.half.x : c.half.x;
      const float z = across > 1e-6f ? d.z / across * c.half.x : 0;
      out.add({x, -c.half.y, z}, 40);
      out.add({0, c.half.y, 0}, 41);
      return;
    }
    case CoreKind::hull:
      return face_feature(c, farthest(c.hull->normal_lanes, d), d, out);
    case CoreKind::triangle:
      face_feature(c, 0, d, out);
      if (dot(c.normal, d) < 0) {
        const Vec3f p = out.point[1];
        out.point[1] = out.point[2], out.point[2] = p;
        out.id[1] = 2, out.id[2] = 1;
        out.normal = -c.normal;
      }
  }
}

bool side_line(const Convex& c, Vec3f d, Vec3f line[2]) {
  const bool edged = c.kind == CoreKind::box || c.kind == CoreKind::hull;
  if (c.kind != CoreKind::segment && !is_round(c) && !edged) return false;
  Feature f;
  feature(c, d, f);
  int first = 0, second = 1;
  if (edged) {  // of the sides of the face the one that stands out
    float most = -1e30f;
    for (int i = 0; i < f.count; ++i) {
      const int k = i + 1 == f.count ? 0 : i + 1;
      if (const float out = dot(d, f.point[i] + f.point[k]); out > most) most = out, first = i, second = k;
    }
    if (f.id[first] > f.id[second]) std::swap(first, second);  // the same way round whichever face was taken
  } else if (f.count != 2) {
    return false;
  }
  line[0] = f.point[first], line[1] = f.point[second];
  const Vec3f t = line[1] - line[0];
  return abs(dot(t, d)) < 0.03f * length(t);
}

}  // namespace carom::geometry::detail
