// Ray casts in space: closed forms where there are any, in double, because a ray may be long and its target small.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/triangle_lanes.h"
#include "carom/geometry/hull.h"

namespace carom::geometry {
namespace ray3 {

struct Best {
  bool inside = false, hit = false;
  double t = 2;
  Vec3d normal{};
  void offer(double time, Vec3d n) {
    if (time >= 0 && time <= 1 && time < t) t = time, normal = n, hit = true;
  }
};

CastHit3 result(const Best& b, Vec3d o, Vec3d d) {
  CastHit3 h;
  if (b.inside) {
    h.hit = true;
    h.fraction = 0;
    h.point = Vec3f(o);
  } else if (b.hit) {
    h.hit = true;
    h.fraction = float(b.t);
    h.point = Vec3f(o + d * b.t);
    h.normal = Vec3f(normalize(b.normal));
  }
  return h;
}

/// The first root of a t² + 2 b t + c, a > 0, where c > 0 (outside) and b < 0 (approaching).
bool first_root(double a, double b, double c, double& t) {
  const double discriminant = b * b - a * c;
  if (!(a > 0) || b >= 0 || discriminant < 0) return false;
  t = c / (-b + math::sqrt(discriminant));
  return true;
}

void sphere(Best& best, Vec3d center, double r, Vec3d o, Vec3d d) {
  // The distance from the line first, so that a far origin does not cancel it away.
  const Vec3d m = o - center;
  const double a = dot(d, d), c = dot(m, m) - r * r;
  if (c <= 0) {
    best.inside = true;
    return;
  }
  double t;
  if (first_root(a, dot(m, d), c, t)) best.offer(t, m + d * t);
}

CastHit3 on_sphere(const Sphere& s, Vec3d o, Vec3d d) {
  Best best;
  sphere(best, {}, double(s.radius), o, d);
  return result(best, o, d);
}

/// The wall of a round shape about y, between two heights.
void wall(Best& best, double r, double low, double high, Vec3d o, Vec3d d) {
  const double a = d.x * d.x + d.z * d.z, b = o.x * d.x + o.z * d.z, c = o.x * o.x + o.z * o.z - r * r;
  double t;
  if (c <= 0 || !first_root(a, b, c, t)) return;
  const double y = o.y + d.y * t;
  if (y >= low && y <= high) best.offer(t, {o.x + d.x * t, 0, o.z + d.z * t});
}

void cap(Best& best, double r, double y, double sign, Vec3d o, Vec3d d) {
  if (!(d.y * sign < 0) || (o.y - y) * sign < 0) return;
  const double t = (y - o.y) / d.y;
  const double x = o.x + d.x * t, z = o.z + d.z * t;
  if (x * x + z * z <= r * r) best.offer(t, {0, sign, 0});
}

CastHit3 on_capsule(const Capsule3& c, Vec3d o, Vec3d d) {
  const double h = double(c.half_length), r = double(c.radius);
  Best best;
  const double y = clamp(o.y, -h, h);
  if (o.x * o.x + (o.y - y) * (o.y - y) + o.z * o.z <= r * r) {
    best.inside = true;
    return result(best, o, d);
  }
  wall(best, r, -h, h, o, d);
  sphere(best, {0, -h, 0}, r, o, d);
  sphere(best, {0, h, 0}, r, o, d);
  return result(best, o, d);
}

CastHit3 on_cylinder(const Cylinder& c, Vec3d o, Vec3d d) {
  const double h = double(c.half_height), r = double(c.radius);
  Best best;
  best.inside = o.y >= -h && o.y <= h && o.x * o.x + o.z * o.z <= r * r;
  wall(best, r, -h, h, o, d);
  cap(best, r, h, 1, o, d);
  cap(best, r, -h, -1, o, d);
  return result(best, o, d);
}

CastHit3 on_cone(const Cone& c, Vec3d o, Vec3d d) {
  const double h = double(c.half_height), r = double(c.radius), k = r / (2 * h);  // radius lost a metre of height
  Best best;
  const double here = k * (h - o.y), across2 = o.x * o.x + o.z * o.z;
  best.inside = o.y >= -h && o.y <= h && across2 <= here * here;
  cap(best, r, -h, -1, o, d);
  // x² + z² = k² (h − y)², the lower half of the double cone.
  const double w = h - o.y;
  const double A = d.x * d.x + d.z * d.z - k * k * d.y * d.y, B = o.x * d.x + o.z * d.z + k * k * w * d.y,
               C = across2 - k * k * w * w;
  double roots[2];
  int count = 0;
  if (math::abs(A) > 1e-14 * dot(d, d)) {
    const double discriminant = B * B - A * C;
    if (discriminant >= 0) {
      const double s = math::sqrt(discriminant);
      const double q = B > 0 ? -(B + s) : s - B;
      roots[count++] = q / A;
      if (q != 0) roots[count++] = C / q;
    }
  } else if (B != 0) {
    roots[count++] = -C / (2 * B);
  }
  for (int i = 0; i < count; ++i) {
    const double t = roots[i];
    const Vec3d p = o + d * t;
    if (!(p.y >= -h && p.y <= h)) continue;
    const Vec3d n{p.x, k * k * (h - p.y), p.z};
    const bool apex = length_squared(n) < 1e-24 * h * h;
    if (apex)
      best.offer(t, {0, 1, 0});
    else if (dot(n, d) < 0)
      best.offer(t, n);
  }
  return result(best, o, d);
}

/// A sphere in the frame where the half axes are one.
CastHit3 on_ellipsoid(const Ellipsoid& e, Vec3d o, Vec3d d) {
  const Vec3d r(e.radii), m{o.x / r.x, o.y / r.y, o.z / r.z}, w{d.x / r.x, d.y / r.y, d.z / r.z};
  Best best;
  sphere(best, {}, 1, m, w);
  best.normal = {best.normal.x / r.x, best.normal.y / r.y, best.normal.z / r.z};
  return result(best, o, d);
}

CastHit3 on_planes(const HullPlane* planes, std::size_t count, Vec3d o, Vec3d d) {
  double first = 0, last = 1;
  Vec3d normal{};
  bool inside = true;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d n(planes[i].normal);
    const double above = dot(n, o) - double(planes[i].offset), along = dot(n, d);
    if (above > 0) inside = false;
    if (along == 0) {
      if (above > 0) return {};
      continue;
    }
    const double t = -above / along;
    if (along < 0) {
      if (t > first || (t == first && above > 0)) first = t, normal = n;
    } else {
      last = min(last, t);
    }
    if (first > last) return {};
  }
  Best best;
  best.inside = inside;
  if (!inside) best.offer(first, normal);
  return result(best, o, d);
}

CastHit3 on_box(const Box& b, Vec3d o, Vec3d d) {
  const Vec3d half(b.half_extents);
  double first = 0, last = 1;
  int axis = -1;
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    // The face toward which it goes first, as if it went along +k.
    const double side = d[k] < 0 ? -1 : 1, from = o[k] * side, speed = d[k] * side;
    inside = inside && math::abs(from) <= half[k];
    if (speed == 0) {
      if (math::abs(from) > half[k]) return {};
      continue;
    }
    const double pace = 1 / speed, enter = (-half[k] - from) * pace, leave = (half[k] - from) * pace;
    if (enter > first || (enter == first && from < -half[k])) first = enter, axis = k;
    last = min(last, leave);
  }
  if (first > last) return {};
  CastHit3 h;
  h.hit = inside || axis >= 0;
  if (inside) {
    h.fraction = 0;
    h.point = Vec3f(o);
  } else if (h.hit) {
    h.fraction = float(first);
    h.point = Vec3f(o + d * first);
    h.normal[axis] = d[axis] < 0 ? 1.0f : -1.0f;
  }
  return h;
}

/// Watertight enough in double: edge functions of the ray against the three corners (one-sided).
bool on_triangle(const Vec3f* corner, Vec3d o, Vec3d d, double& t, Vec3d& normal) {
  const Vec3d a = Vec3d(corner[0]) - o, b = Vec3d(corner[1]) - o, c = Vec3d(corner[2]) - o;
  const Vec3d n = cross(b - a, c - a);
  const double along = dot(n, d);
  if (!(along < 0)) return false;
  const double u = triple(d, c, b), v = triple(d, a, c), w = triple(d, b, a);
  if (u < 0 || v < 0 || w < 0) return false;
  t = dot(n, a) / along;
  normal = n;
  return t >= 0 && t <= 1;
}

CastHit3 on_mesh(const TriangleMesh& mesh, Vec3f origin, Vec3f translation) {
  const Vec3d o(origin), d(translation);
  Best best;
  std::uint32_t child = 0;
  cast_leaves(mesh.tree, origin, translation, Vec3f{}, 1, [&](const std::uint32_t* items, int count, float) {
    const detail::TriangleLanes lanes(mesh, items, count, origin);
    for (std::uint32_t met = lanes.met_by_line(translation); met != 0; met &= met - 1) {
      const std::uint32_t i = items[__builtin_ctz(met)];
      const detail::SurfaceTriangle triangle = detail::triangle_of(mesh, i);
      double t;
      Vec3d n;
      if (on_triangle(triangle.corner, o, d, t, n) && (t < best.t || (t == best.t && i < child))) {
        best.t = t, best.normal = n, best.hit = true;
        child = i;
      }
    }
    return best.hit ? float(best.t) * 1.000001f : 1.0f;
  });
  CastHit3 h = result(best, o, d);
  h.child = child;
  return h;
}

CastHit3 on_height_field(const HeightField& field, Vec3f origin, Vec3f translation) {
  const detail::HeightFieldCells cells{field};
  const Vec3d o(origin), d(translation);
  Best best;
  float height;
  if (detail::height_at(field, origin.x, origin.z, height) && origin.y < height) {
    best.inside = true;
    return result(best, o, d);
  }
  // The part of the ray over the grid and between the heights, then from cell to cell (Amanatides & Woo 1987).
  const double sx = double(field.cell.x), sz = double(field.cell.y);
  double first = 0, last = 1;
  const double low[3] = {0, double(field.low), 0};
  const double high[3] = {sx * cells.columns(), double(field.high), sz * cells.rows()};
  const double pad = 1e-6 * (high[0] + high[2]) + 1e-6;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < low[k] - pad || o[k] > high[k] + pad) return {};
      continue;
    }
    const double a = (low[k] - pad - o[k]) / d[k], b = (high[k] + pad - o[k]) / d[k];
    first = max(first, min(a, b)), last = min(last, max(a, b));
  }
  if (first > last) return {};
  const Vec3d p = o + d * first;
  int i = clamp(int(p.x / sx), 0, cells.columns() - 1), j = clamp(int(p.z / sz), 0, cells.rows() - 1);
  const int di = d.x > 0 ? 1 : -1, dj = d.z > 0 ? 1 : -1;
  const double huge = 1e300;
  const auto next_x = [&] { return d.x == 0 ? huge : (double(i + (di > 0 ? 1 : 0)) * sx - o.x) / d.x; };
  const auto next_z = [&] { return d.z == 0 ? huge : (double(j + (dj > 0 ? 1 : 0)) * sz - o.z) / d.z; };
  std::uint32_t child = 0;
  const auto look = [&](int ci, int cj) {
    if (!cells.exists(ci, cj)) return;
    for (int k = 0; k < 2; ++k) {
      const detail::SurfaceTriangle triangle = cells.triangle(ci, cj, k, false);
      double t;
      Vec3d n;
      if (on_triangle(triangle.corner, o, d, t, n) && t < best.t) {
        best.t = t, best.normal = n, best.hit = true;
        child = triangle.index;
      }
    }
  };
  while (true) {
    look(i, j);
    const double tx = next_x(), tz = next_z();
    if (best.hit && best.t <= min(tx, tz)) break;
    if (min(tx, tz) > last) break;
    // Through a corner both neighbours are asked as well.
    if (tx == tz) look(i + di, j), look(i, j + dj);
    if (tx <= tz) i += di;
    if (tz <= tx) j += dj;
    if (i < 0 || j < 0 || i >= cells.columns() || j >= cells.rows()) break;
  }
  CastHit3 h = result(best, o, d);
  h.child = child;
  return h;
}

/// From cell to cell (Amanatides & Woo 1987) until one is filled.
CastHit3 on_voxels(const VoxelGrid& grid, Vec3f origin, Vec3f translation) {
  const Vec3d o(origin), d(translation);
  const double cell = double(grid.cell);
  const int count[3] = {grid.columns, grid.layers, grid.rows};
  Best best;
  double first = 0, last = 1;
  int entered = -1;
  for (int k = 0; k < 3; ++k) {
    const double high = cell * count[k];
    if (d[k] == 0) {
      if (o[k] < 0 || o[k] > high) return {};
      continue;
    }
    const double a = -o[k] / d[k], b = (high - o[k]) / d[k];
    if (min(a, b) > first) first = min(a, b), entered = k;
    last = min(last, max(a, b));
  }
  if (first > last) return {};
  const Vec3d p = o + d * first;
  int at[3], step[3];
  double next[3];
  for (int k = 0; k < 3; ++k) {
    step[k] = d[k] > 0 ? 1 : -1;
    at[k] = clamp(int(p[k] / cell), 0, count[k] - 1);
    if (k == entered) at[k] = d[k] > 0 ? 0 : count[k] - 1;
  }
  CastHit3 hit;
  double t = first;
  while (true) {
    if (grid.at(at[0], at[1], at[2]) != 0) {
      const std::uint32_t name = std::uint32_t(grid.index(at[0], at[1], at[2])) * 12;
      if (entered < 0) {
        best.inside = true;
        hit = result(best, o, d);
      } else {
        Vec3d n{};
        n[entered] = -step[entered];
        best.offer(t, n);
        hit = result(best, o, d);
        hit.child = name + std::uint32_t(2 * (2 * entered + (n[entered] > 0 ? 0 : 1)));
        return hit;
      }
      hit.child = name;
      return hit;
    }
    for (int k = 0; k < 3; ++k) next[k] = d[k] == 0 ? 1e300 : (cell * (at[k] + (step[k] > 0 ? 1 : 0)) - o[k]) / d[k];
    entered = next[0] <= next[1] && next[0] <= next[2] ? 0 : (next[1] <= next[2] ? 1 : 2);
    t = next[entered];
    if (t > last) return hit;
    at[entered] += step[entered];
    if (at[entered] < 0 || at[entered] >= count[entered]) return hit;
  }
}

CastHit3 on_compound(const Compound& compound, Vec3f origin, Vec3f translation) {
  CastHit3 best;
  cast(compound.tree, origin, translation, Vec3f{}, 1, [&](std::uint32_t i, float limit) {
    const CompoundChild& c = compound.children[i];
    CastHit3 h = ray_cast(c.shape, inverse_transform_point(c.local, origin), inverse_rotate(c.local.q, translation));
    if (h.hit && (!best.hit || h.fraction < best.fraction)) {
      h.point = transform_point(c.local, h.point);
      h.normal = rotate(c.local.q, h.normal);
      h.child = i;
      best = h;
      return h.fraction;
    }
    return limit;
  });
  return best;
}

}  // namespace ray3

CastHit3 ray_cast(const Shape3& s, Vec3f origin, Vec3f translation) {
  const Vec3d o(origin), d(translation);
  switch (s.type) {
    case ShapeType3::sphere:
      return ray3::on_sphere(s.sphere, o, d);
    case ShapeType3::capsule:
      return ray3::on_capsule(s.capsule, o, d);
    case ShapeType3::box:
      if (s.box.radius > 0) return detail::cast_point(s, origin, translation);
      return ray3::on_box(s.box, o, d);
    case ShapeType3::cylinder:
      if (s.cylinder.rounding > 0) return detail::cast_point(s, origin, translation);
      return ray3::on_cylinder(s.cylinder, o, d);
    case ShapeType3::cone:
      if (s.cone.rounding > 0) return detail::cast_point(s, origin, translation);
      return ray3::on_cone(s.cone, o, d);
    case ShapeType3::ellipsoid:
      return ray3::on_ellipsoid(s.ellipsoid, o, d);
    case ShapeType3::hull:
      if (s.hull->radius > 0) return detail::cast_point(s, origin, translation);
      return ray3::on_planes(s.hull->planes.data(), s.hull->planes.size(), o, d);
    case ShapeType3::plane: {
      const HullPlane plane{s.plane.normal, 0};
      return ray3::on_planes(&plane, 1, o, d);
    }
    case ShapeType3::mesh:
      return ray3::on_mesh(*s.mesh, origin, translation);
    case ShapeType3::height_field:
      return ray3::on_height_field(*s.height_field, origin, translation);
    case ShapeType3::voxels:
      return ray3::on_voxels(*s.voxels, origin, translation);
    case ShapeType3::compound:
      return ray3::on_compound(*s.compound, origin, translation);
  }
  return {};
}

}  // namespace carom::geometry
