// Distance, overlap and shape casts in space.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/sweep.h"
#include "carom/geometry/detail/triangle_lanes.h"

namespace carom::geometry {
namespace query3 {

using detail::Convex;
using detail::CoreDistance;
using detail::Placed;

Distance3 between_cores(const Convex& a, const Convex& b, const Transform3f& x) {
  CoreDistance d;
  detail::core_distance(Placed(a), Placed(b, x), 1e30, {}, d);
  const double distance = d.distance - double(a.radius) - double(b.radius);
  Distance3 out;
  if (d.overlap || distance <= 0) {
    out.point_a = out.point_b = Vec3f((d.point_a + d.point_b) * 0.5);
    return out;
  }
  out.distance = float(distance);
  out.normal = Vec3f(d.normal);
  out.point_a = Vec3f(d.point_a + d.normal * double(a.radius));
  out.point_b = Vec3f(d.point_b - d.normal * double(b.radius));
  return out;
}

Distance3 from_plane(const Plane& plane, const Shape3& b, const Transform3f& x) {
  const Vec3f p = transform_point(x, support(b, -inverse_rotate(x.q, plane.normal)));
  const float d = dot(p, plane.normal);
  Distance3 out;
  out.point_a = p - plane.normal * d;
  out.point_b = d > 0 ? p : out.point_a;
  if (d > 0) out.distance = d, out.normal = plane.normal;
  return out;
}

float gap(const Bounds3f& a, const Bounds3f& b) {
  const Vec3f d = max(max(a.low - b.high, b.low - a.high), Vec3f{});
  return length(d);
}

Distance3 none() {
  Distance3 d;
  d.distance = 3.4e38f;
  return d;
}

Distance3 from_surface(const Shape3& surface, const Shape3& b, const Transform3f& x) {
  const Convex core = detail::convex_of(b);
  Distance3 best = none();
  const auto look = [&](const detail::SurfaceTriangle& t) {
    const Convex triangle = detail::convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]);
    const Distance3 d = between_cores(triangle, core, x);
    if (d.distance < best.distance) best = d;
  };
  const Bounds3f box = bounds(b, x);
  if (surface.type == ShapeType3::mesh) {
    const TriangleMesh& mesh = *surface.mesh;
    nearest(mesh.tree, box, best.distance, [&](std::uint32_t i) { look(detail::triangle_of(mesh, i)); });
    return best;
  }
  const Vec3f center = transform_point(x, detail::inner_point(core));
  if (detail::inside_ground(surface, center)) {
    best.distance = 0;
    best.point_a = best.point_b = center;
    best.normal = {};
    return best;
  }
  // Rings that double until what was found is nearer than what was not looked at.
  const Bounds3f all = bounds(surface, {});
  const bool voxels = surface.type == ShapeType3::voxels;
  const Vec2f cell = voxels ? Vec2f{surface.voxels->cell, 0} : surface.height_field->cell;
  float reach = max(cell.x, cell.y) + gap(all, box);
  while (true) {
    const Bounds3f ring = grow(box, reach);
    detail::visit_triangles(surface, ring, false, [&](const detail::SurfaceTriangle& t) {
      const Bounds3f b3{min(t.corner[0], min(t.corner[1], t.corner[2])),
                        max(t.corner[0], max(t.corner[1], t.corner[2]))};
      if (gap(b3, box) < best.distance) look(t);
      return best.distance > 0;
    });
    if (best.distance <= reach || contains(ring, all)) return best;
    reach *= 2;
  }
}

Distance3 any(const Shape3& a, const Shape3& b, const Transform3f& x);

Distance3 flipped(const Shape3& a, const Shape3& b, const Transform3f& x) {
  Distance3 d = any(b, a, inverse(x));
  const Vec3f p = d.point_a;
  d.point_a = transform_point(x, d.point_b);
  d.point_b = transform_point(x, p);
  d.normal = -rotate(x.q, d.normal);
  return d;
}

Distance3 from_compound(const Compound& compound, const Shape3& b, const Transform3f& x) {
  Distance3 best = none();
  const auto look = [&](std::uint32_t i) {
    const CompoundChild& c = compound.children[i];
    Distance3 d = any(c.shape, b, inverse(c.local) * x);
    if (d.distance >= best.distance) return;
    d.point_a = transform_point(c.local, d.point_a);
    d.point_b = transform_point(c.local, d.point_b);
    d.normal = rotate(c.local.q, d.normal);
    best = d;
  };
  if (is_convex(b)) {
    nearest(compound.tree, bounds(b, x), best.distance, look);
  } else {
    for (std::uint32_t i = 0; i < std::uint32_t(compound.children.size()) && best.distance > 0; ++i) look(i);
  }
  return best;
}

Distance3 any(const Shape3& a, const Shape3& b, const Transform3f& x) {
  if (is_convex(a) && is_convex(b)) return between_cores(detail::convex_of(a), detail::convex_of(b), x);
  if (a.type == ShapeType3::compound) return from_compound(*a.compound, b, x);
  if (b.type == ShapeType3::compound) return flipped(a, b, x);
  if (is_convex(b)) return a.type == ShapeType3::plane ? from_plane(a.plane, b, x) : from_surface(a, b, x);
  if (is_convex(a)) return flipped(a, b, x);
  return none();
}

/// B moves by `way` in A's frame. Without a closed form by conservative advancement, where a touch within `tolerance`
/// counts.
CastHit3 cast_cores(const Convex& a, const Convex& b, const Transform3f& x, Vec3d way, float limit) {
  CastHit3 hit;
  detail::Sweep closed;
  if (detail::closed_cast(a, b, x, way, double(limit), closed)) {
    hit.hit = closed.hit;
    if (!closed.hit) return hit;
    hit.fraction = float(closed.time);
    hit.normal = Vec3f(closed.normal);
    hit.point = Vec3f(closed.core_point + closed.normal * double(a.radius));
    return hit;
  }
  const bool round = a.kind == detail::CoreKind::point || a.kind == detail::CoreKind::segment;
  const Quatd q(x.q);
  if (round && detail::closed_cast(b, a, inverse(x), -inverse_rotate(q, way), double(limit), closed)) {
    hit.hit = closed.hit;  // the same pair seen from B
    if (!closed.hit) return hit;
    hit.fraction = float(closed.time);
    hit.normal = Vec3f(-rotate(q, closed.normal));
    const Vec3d touched = closed.core_point + closed.normal * double(b.radius);
    hit.point = Vec3f(rotate(q, touched) + Vec3d(x.p) + way * closed.time);
    return hit;
  }
  const Placed pa(a);
  Placed pb(b, x);
  const Vec3d start = pb.position;
  const double radius = double(a.radius) + double(b.radius);
  const double tolerance = max(1e-5, 1e-6 * (math::length(start) + math::length(way)));
  double t = 0;
  Vec3d guess{};
  for (int i = 0; i < 64; ++i) {
    pb.position = start + way * t;
    CoreDistance d;
    detail::core_distance(pa, pb, 1e30, guess, d);
    const double gap = d.distance - radius;
    if (gap <= (i == 0 ? 0 : tolerance) || i == 63) {
      hit.hit = true;
      hit.fraction = float(t);
      if (i > 0) hit.normal = Vec3f(d.overlap ? normalize(guess) : d.normal);
      hit.point = Vec3f(d.point_a) + hit.normal * a.radius;
      return hit;
    }
    const double closing = -dot(d.normal, way);
    if (!(closing > 0)) return hit;
    t += max(gap - 0.5 * tolerance, 0.5 * tolerance) / closing;
    if (t > double(limit)) return hit;
    guess = d.normal;
  }
  return hit;
}

CastHit3 cast_any(const Shape3& a, const Shape3& b, const Transform3f& x, Vec3f way, float limit);
bool touch(const Shape3& a, const Shape3& b, const Transform3f& x);

/// Without its normal, which distances do not ask for.
Convex bare_triangle(const detail::SurfaceTriangle& t) {
  Convex c;
  c.kind = detail::CoreKind::triangle;
  for (int k = 0; k < 3; ++k) c.corner[k] = t.corner[k];
  return c;
}

CastHit3 cast_on_surface(const Shape3& surface, const Shape3& b, const Transform3f& x, Vec3f way, float limit) {
  CastHit3 best;
  const Convex core = detail::convex_of(b);
  const Bounds3f box = bounds(b, x);
  const Vec3f center = transform_point(x, detail::inner_point(core));
  const bool solid = surface.type == ShapeType3::height_field, voxels = surface.type == ShapeType3::voxels;
  if ((solid || voxels) && touch(surface, b, x)) {
    best.hit = true;
    best.fraction = 0;
    best.point = center;
    return best;
  }
  const auto look = [&](const detail::SurfaceTriangle& t) {
    // One-sided: what comes from behind, or moves away, passes.
    const Vec3d a(t.corner[0]), normal = cross(Vec3d(t.corner[1]) - a, Vec3d(t.corner[2]) - a);
    if (!solid && (dot(normal, Vec3d(center) - a) < 0 || dot(normal, Vec3d(way)) > 0)) return;
    const Convex triangle = bare_triangle(t);
    CastHit3 h = cast_cores(triangle, core, x, Vec3d(way), limit);
    if (!h.hit || (best.hit && h.fraction >= best.fraction)) return;
    h.child = t.index;
    best = h;
    limit = h.fraction;
  };
  // A little wider than the shape, for the tolerance of a touch.
  const Vec3f extents = box.extents() + Vec3f{1, 1, 1} * (2e-5f + 2e-6f * (length(x.p) + length(way)));
  if (surface.type == ShapeType3::mesh) {
    const TriangleMesh& mesh = *surface.mesh;
    cast(mesh.tree, box.center(), way, extents, limit, [&](std::uint32_t i, float) {
      look(detail::triangle_of(mesh, i));
      return limit;
    });
    return best;
  }
  const detail::SlabRay<Vec3f> ray(box.center(), way, extents);
  if (voxels) {
    // From piece to piece of the way, each as long as a few cells: what lies before the first touch is all that is
    // seen.
    const float piece = 4 * surface.voxels->cell + 2 * max(extents.x, max(extents.y, extents.z));
    const int pieces = int(clamp(length(way) / piece, 0.0f, 4095.0f)) + 1;
    for (int i = 0; i < pieces && !(best.hit && best.fraction <= float(i) / float(pieces)); ++i) {
      const Vec3f from = way * (float(i) / float(pieces)), to = way * (float(i + 1) / float(pieces));
      const Bounds3f part =
          grow(merge(Bounds3f{box.low + from, box.high + from}, Bounds3f{box.low + to, box.high + to}),
               length(extents) * 1e-3f);
      detail::visit_triangles(surface, part, false, [&](const detail::SurfaceTriangle& t) {
        const Bounds3f b3{min(t.corner[0], min(t.corner[1], t.corner[2])),
                          max(t.corner[0], max(t.corner[1], t.corner[2]))};
        if (ray.enter(b3, limit) <= limit) look(t);
        return true;
      });
    }
    return best;
  }
  const Bounds3f swept = grow(merge(box, Bounds3f{box.low + way, box.high + way}), length(extents) * 1e-3f);
  detail::visit_triangles(surface, swept, false, [&](const detail::SurfaceTriangle& t) {
    const Bounds3f b3{min(t.corner[0], min(t.corner[1], t.corner[2])), max(t.corner[0], max(t.corner[1], t.corner[2]))};
    if (ray.enter(b3, limit) <= limit) look(t);
    return true;
  });
  return best;
}

CastHit3 cast_on_plane(const Plane& plane, const Shape3& b, const Transform3f& x, Vec3f way, float limit) {
  CastHit3 hit;
  const Distance3 d = from_plane(plane, b, x);
  if (d.distance <= 0) {
    hit.hit = true;
    hit.fraction = 0;
    hit.point = d.point_a;
    return hit;
  }
  const float closing = -dot(plane.normal, way);
  if (!(closing > 0) || d.distance > closing * limit) return hit;
  hit.hit = true;
  hit.fraction = d.distance / closing;
  hit.normal = plane.normal;
  hit.point = d.point_b + way * hit.fraction;
  return hit;
}

CastHit3 cast_on_compound(const Compound& compound, const Shape3& b, const Transform3f& x, Vec3f way, float limit) {
  CastHit3 best;
  const auto look = [&](std::uint32_t i, float) {
    const CompoundChild& c = compound.children[i];
    CastHit3 h = cast_any(c.shape, b, inverse(c.local) * x, inverse_rotate(c.local.q, way), limit);
    if (h.hit && (!best.hit || h.fraction < best.fraction)) {
      h.point = transform_point(c.local, h.point);
      h.normal = rotate(c.local.q, h.normal);
      h.child = i;
      best = h;
      limit = h.fraction;
    }
    return limit;
  };
  const Bounds3f box = bounds(b, x);
  cast(compound.tree, box.center(), way, box.extents() * 1.00001f + Vec3f{1e-4f, 1e-4f, 1e-4f}, limit, look);
  return best;
}

CastHit3 cast_any(const Shape3& a, const Shape3& b, const Transform3f& x, Vec3f way, float limit) {
  if (b.type == ShapeType3::compound) {  // each child by itself
    CastHit3 best;
    for (const CompoundChild& c : b.compound->children) {
      const CastHit3 h = cast_any(a, c.shape, x * c.local, way, limit);
      if (h.hit && (!best.hit || h.fraction < best.fraction)) best = h, limit = h.fraction;
    }
    return best;
  }
  if (!is_convex(b)) return {};
  switch (a.type) {
    case ShapeType3::plane:
      return cast_on_plane(a.plane, b, x, way, limit);
    case ShapeType3::mesh:
    case ShapeType3::height_field:
    case ShapeType3::voxels:
      return cast_on_surface(a, b, x, way, limit);
    case ShapeType3::compound:
      return cast_on_compound(*a.compound, b, x, way, limit);
    default:
      return cast_cores(detail::convex_of(a), detail::convex_of(b), x, Vec3d(way), limit);
  }
}

bool cores_touch(const Convex& a, const Convex& b, const Transform3f& x) {
  bool touching;
  if (detail::closed_overlap(a, b, x, touching)) return touching;
  if (a.kind == detail::CoreKind::point && detail::closed_overlap(b, a, inverse(x), touching)) return touching;
  const double radius = double(a.radius) + double(b.radius);
  CoreDistance d;
  detail::core_distance(Placed(a), Placed(b, x), radius, {}, d);
  return d.overlap || d.distance <= radius;
}

bool touch(const Shape3& a, const Shape3& b, const Transform3f& x) {
  if (is_convex(a) && is_convex(b)) return cores_touch(detail::convex_of(a), detail::convex_of(b), x);
  if (b.type == ShapeType3::compound || (is_convex(a) && !is_convex(b))) return touch(b, a, inverse(x));
  if (a.type == ShapeType3::compound) {
    const Compound& compound = *a.compound;
    bool found = false;
    const auto look = [&](std::uint32_t i) {
      const CompoundChild& c = compound.children[i];
      found = touch(c.shape, b, inverse(c.local) * x);
      return !found;
    };
    if (is_convex(b))
      query(compound.tree, bounds(b, x), look);
    else
      for (std::uint32_t i = 0; i < std::uint32_t(compound.children.size()) && look(i);) ++i;
    return found;
  }
  if (!is_convex(b) || a.type == ShapeType3::plane) return any(a, b, x).distance <= 0;
  const Convex core = detail::convex_of(b);
  if (detail::inside_ground(a, transform_point(x, detail::inner_point(core)))) return true;
  const Bounds3f box = bounds(b, x);
  bool found = false;
  const auto look = [&](const detail::SurfaceTriangle& t) {
    found = cores_touch(bare_triangle(t), core, x);
    return !found;
  };
  if (a.type == ShapeType3::mesh) {  // mostly the first few tell
    const TriangleMesh& mesh = *a.mesh;
    query_leaves(mesh.tree, box, [&](const std::uint32_t* items, int count) {
      const detail::TriangleLanes lanes(mesh, items, count, {});
      for (std::uint32_t near = lanes.met_by_box(box); near != 0 && !found; near &= near - 1)
        look(detail::triangle_of(mesh, items[__builtin_ctz(near)]));
      return !found;
    });
  } else {
    detail::visit_triangles(a, box, false, look);
  }
  return found;
}

}  // namespace query3

Distance3 distance(const Shape3& a, const Shape3& b, const Transform3f& b_in_a) { return query3::any(a, b, b_in_a); }

bool overlap(const Shape3& a, const Shape3& b, const Transform3f& b_in_a) { return query3::touch(a, b, b_in_a); }

CastHit3 shape_cast(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, Vec3f translation) {
  return query3::cast_any(a, b, b_in_a, translation, 1);
}

namespace detail {
CastHit3 shape_cast_within(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, Vec3f translation,
                           float limit) {
  return query3::cast_any(a, b, b_in_a, translation, limit);
}
CastHit3 cast_point(const Shape3& convex, Vec3f origin, Vec3f translation) {
  const Convex point;
  return query3::cast_cores(convex_of(convex), point, {origin, {}}, Vec3d(translation), 1);
}
bool inside_ground(const Shape3& surface, Vec3f p) {
  if (surface.type == ShapeType3::voxels) {
    int cell[3];
    return inside_voxels(*surface.voxels, p, cell);
  }
  float height;
  return surface.type == ShapeType3::height_field && height_at(*surface.height_field, p.x, p.z, height) &&
         p.y <= height;
}
bool height_at(const HeightField& f, float x, float z, float& height) {
  const HeightFieldCells cells{f};
  const float u = x / f.cell.x, v = z / f.cell.y;
  if (!(u >= 0 && v >= 0 && u <= float(cells.columns()) && v <= float(cells.rows()))) return false;
  const int i = min(int(u), cells.columns() - 1), j = min(int(v), cells.rows() - 1);
  if (!cells.exists(i, j)) return false;
  const float s = u - float(i), t = v - float(j);
  const float h00 = cells.vertex(i, j).y, h11 = cells.vertex(i + 1, j + 1).y;
  height = s >= t ? h00 + (cells.vertex(i + 1, j).y - h00) * (s - t) + (h11 - h00) * t
                  : h00 + (cells.vertex(i, j + 1).y - h00) * (t - s) + (h11 - h00) * s;
  return true;
}
}  // namespace detail

}  // namespace carom::geometry
