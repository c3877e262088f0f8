// Contacts of meshes, height fields and compounds: one manifold a patch of nearly coplanar triangles or a child.
// A patch's points vote together: a triangle may push along its own normal or over an edge that really stands out
// (Gauss map of the edge), never over a flat or concave one, so nothing catches where triangles meet.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/detail/surface.h"

namespace carom::geometry {
namespace many3 {

using detail::ContactPoints;

float least(const ContactPoints& c) {
  float s = c.point[0].separation;
  for (int i = 1; i < c.count; ++i) s = min(s, c.point[i].separation);
  return s;
}
float least(const Manifold3& m) {
  float s = m.points[0].separation;
  for (int i = 1; i < m.count; ++i) s = min(s, m.points[i].separation);
  return s;
}

/// The deepest manifolds found, at most as many as asked for, deepest first.
struct Deepest {
  std::span<Manifold3> out;
  int count = 0;

  void offer(const Manifold3& m) {
    if (m.count == 0 || out.empty()) return;
    const float depth = least(m);
    int place = count;
    while (place > 0 && depth < least(out[std::size_t(place - 1)])) --place;
    if (place >= int(out.size())) return;
    if (count < int(out.size())) ++count;
    for (int i = count - 1; i > place; --i) out[std::size_t(i)] = out[std::size_t(i - 1)];
    out[std::size_t(place)] = m;
  }
};

struct Patch {
  Vec3f normal{};
  float depth = 0;  ///< least separation
  std::uint32_t child = 0;
  ContactPoints points;
};

void merge_into(Patch& patch, const ContactPoints& from, float same) {
  for (int i = 0; i < from.count; ++i) {
    const ManifoldPoint3& p = from.point[i];
    int twin = -1;
    for (int k = 0; k < patch.points.count && twin < 0; ++k)
      if (distance_squared(p.point, patch.points.point[k].point) < same * same) twin = k;
    if (twin >= 0) {
      ManifoldPoint3& q = patch.points.point[twin];
      const std::uint32_t name = min(q.feature, p.feature);
      if (p.separation < q.separation) q = p;
      q.feature = name;
      continue;
    }
    if (patch.points.count == ContactPoints::capacity) {
      Manifold3 four;
      detail::write_points(patch.points, patch.normal, four);
      patch.points.count = 0;
      for (int k = 0; k < four.count; ++k) patch.points.point[patch.points.count++] = four.points[k];
    }
    patch.points.point[patch.points.count++] = p;
  }
}

int surface_convex(const Shape3& surface, const Shape3& shape, const Transform3f& x, float margin,
                   std::span<Manifold3> out) {
  constexpr int max_patches = 12;
  const detail::Convex b = detail::convex_of(shape);
  const bool solid = surface.type == ShapeType3::height_field;
  Bounds3f box = grow(bounds(shape, x), margin);
  if (solid) box.high.y += 2 * (detail::outer_size(b) + b.radius);
  const float same = 2e-3f * (detail::outer_size(b) + b.radius);
  Patch patches[max_patches];
  int count = 0;
  detail::visit_triangles(surface, box, true, [&](const detail::SurfaceTriangle& t) {
    const detail::Convex triangle = detail::convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]);
    ContactPoints points;
    Vec3f n;
    if (!detail::collide_triangle(triangle, t.edges, solid, b, x, margin, points, n)) return true;
    // Corners of the moving shape keep their names from triangle to triangle; points cut by an edge are the triangle's.
    for (int i = 0; i < points.count; ++i)
      if (points.point[i].feature > 0xff) points.point[i].feature ^= t.index * 2654435761u;
    const float depth = least(points);
    int at = -1;
    for (int i = 0; i < count && at < 0; ++i)
      if (dot(patches[i].normal, n) > 0.998f) at = i;
    if (at < 0) {
      if (count < max_patches) {
        at = count++;
      } else {
        int shallowest = 0;
        for (int i = 1; i < count; ++i)
          if (patches[i].depth > patches[shallowest].depth) shallowest = i;
        if (patches[shallowest].depth <= depth) return true;
        at = shallowest;
      }
      patches[at].points.count = 0;
      patches[at].normal = n, patches[at].depth = depth, patches[at].child = t.index;
    }
    Patch& patch = patches[at];
    if (depth < patch.depth) patch.depth = depth, patch.normal = n;
    patch.child = min(patch.child, t.index);
    merge_into(patch, points, same);
    return true;
  });
  Deepest found{out};
  for (int i = 0; i < count; ++i) {
    // The shape's own corners come before points cut by triangles' edges: in ties they are kept, with their names.
    ContactPoints& points = patches[i].points;
    ContactPoints sorted;
    for (const bool own : {true, false})
      for (int k = 0; k < points.count; ++k)
        if ((points.point[k].feature <= 0xff) == own) sorted.point[sorted.count++] = points.point[k];
    points = sorted;
    Manifold3 m;
    detail::write_points(patches[i].points, patches[i].normal, m);
    m.child = patches[i].child;
    found.offer(m);
  }
  return found.count;
}

bool is_surface(const Shape3& s) { return s.type == ShapeType3::mesh || s.type == ShapeType3::height_field; }

int compound_any(const Shape3& a, const Shape3& b, const Transform3f& x, float margin, std::span<Manifold3> out) {
  const Compound& compound = *a.compound;
  Deepest found{out};
  Manifold3 part[8];
  const auto child = [&](std::uint32_t i) {
    const CompoundChild& c = compound.children[i];
    const Transform3f b_in_child = inverse(c.local) * x;
    int count = 0;
    if (b.type <= ShapeType3::plane) {
      PairCache cache;
      collide(c.shape, b, b_in_child, margin, cache, part[0]);
      count = part[0].count > 0 ? 1 : 0;
    } else {
      count = collide_many(c.shape, b, b_in_child, margin, part);
    }
    for (int k = 0; k < count; ++k) {
      Manifold3& m = part[k];
      m.normal = rotate(c.local.q, m.normal);
      for (int p = 0; p < m.count; ++p) m.points[p].point = transform_point(c.local, m.points[p].point);
      m.child = i + m.child * 65537u;
      found.offer(m);
    }
    return true;
  };
  if (is_convex(b)) {
    const Bounds3f box = grow(bounds(b, x), margin);
    query(compound.tree, box, child);
  } else {
    for (std::uint32_t i = 0; i < std::uint32_t(compound.children.size()); ++i) child(i);
  }
  return found.count;
}

}  // namespace many3

int collide_many(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, float margin, std::span<Manifold3> out) {
  if (out.empty()) return 0;
  if (a.type <= ShapeType3::plane && b.type <= ShapeType3::plane) {
    PairCache cache;
    collide(a, b, b_in_a, margin, cache, out[0]);
    return out[0].count > 0 ? 1 : 0;
  }
  if (a.type == ShapeType3::compound) return many3::compound_any(a, b, b_in_a, margin, out);
  if (many3::is_surface(a) && is_convex(b)) return many3::surface_convex(a, b, b_in_a, margin, out);
  if (b.type == ShapeType3::compound || (many3::is_surface(b) && is_convex(a))) {
    const int count = collide_many(b, a, inverse(b_in_a), margin, out);
    for (int i = 0; i < count; ++i) detail::flip(out[std::size_t(i)], b_in_a);
    return count;
  }
  return 0;  // two surfaces, or a surface and a plane: both static
}

}  // namespace carom::geometry
