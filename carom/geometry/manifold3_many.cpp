// Contacts of meshes, height fields and compounds: one manifold a patch of nearly coplanar triangles or a child.
// A patch's points vote together: a triangle may push along its own normal or over an edge that really stands out
// (Gauss map of the edge), never over a flat or concave one, so nothing catches where triangles meet.
#include "carom/geometry/compound.h"
#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/detail/queries.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/triangle_reach.h"

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
  std::uint32_t child = 0, material = 0;
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

/// The shape's own corners come before points cut by triangles' edges: in ties they are kept, with their names.
void own_corners_first(ContactPoints& points) {
  const auto is_own = [&](int i) { return points.point[i].feature <= 0xff; };
  int own = 0;
  while (own < points.count && is_own(own)) ++own;
  bool in_order = true;
  for (int i = own; i < points.count; ++i) in_order = in_order && !is_own(i);
  if (in_order) return;
  ContactPoints sorted;
  for (const bool first : {true, false})
    for (int i = 0; i < points.count; ++i)
      if (is_own(i) == first) sorted.point[sorted.count++] = points.point[i];
  for (int i = 0; i < points.count; ++i) points.point[i] = sorted.point[i];
}

/// A shape whose middle is in filled cells goes out by the nearest free face; the way up counts half.
bool buried(const VoxelGrid& grid, const detail::Convex& b, const Transform3f& x, Manifold3& m) {
  const Vec3f p = transform_point(x, detail::inner_point(b));
  int c[3];
  if (!detail::inside_voxels(grid, p, c)) return false;
  constexpr int axes[6] = {1, 0, 0, 2, 2, 1}, signs[6] = {1, 1, -1, 1, -1, -1};
  float least = 3.4e38f, plane = 0;
  int way = 0;
  for (int k = 0; k < 6; ++k) {
    int at[3] = {c[0], c[1], c[2]};
    while (grid.at(at[0], at[1], at[2]) != 0) at[axes[k]] += signs[k];
    const float face = float(at[axes[k]] + (signs[k] > 0 ? 0 : 1)) * grid.cell;
    const float far = float(signs[k]) * (face - p[axes[k]]);
    if ((k == 0 ? 0.5f : 1.0f) * far < least) least = (k == 0 ? 0.5f : 1.0f) * far, plane = face, way = k;
  }
  Vec3f n{};
  n[axes[way]] = float(signs[way]);
  const Vec3f lowest = transform_point(x, Vec3f(detail::support(b, Vec3d(-inverse_rotate(x.q, n))))) - n * b.radius;
  const float s = float(signs[way]) * (lowest[axes[way]] - plane);
  m = {};
  m.normal = n;
  m.count = 1;
  m.child = std::uint32_t(grid.index(c[0], c[1], c[2])) * 12;
  m.material = std::uint32_t(grid.cells[grid.index(c[0], c[1], c[2])] - 1);
  m.points[0] = {lowest - n * (0.5f * s), s, 0};
  return true;
}

/// A shape so deep below a height field that no triangle holds it (the ground was raised over it) goes up.
bool sunk(const HeightField& field, const detail::Convex& b, const Transform3f& x, Manifold3& m) {
  const Vec3f p = transform_point(x, detail::inner_point(b)), up{0, 1, 0};
  float height;
  if (!detail::height_at(field, p.x, p.z, height) || p.y >= height) return false;
  const Vec3f lowest = transform_point(x, Vec3f(detail::support(b, Vec3d(-inverse_rotate(x.q, up))))) - up * b.radius;
  const std::size_t cell =
      std::size_t(clamp(int(p.z / field.cell.y), 0, field.rows - 2)) * std::size_t(field.columns - 1) +
      std::size_t(clamp(int(p.x / field.cell.x), 0, field.columns - 2));
  m = {};
  m.normal = up;
  m.count = 1;
  m.child = std::uint32_t(2 * cell);
  if (!field.materials.empty()) m.material = field.materials[cell];
  m.points[0] = {lowest + up * (0.5f * (height - lowest.y)), lowest.y - height, 0};
  return true;
}

/// A shape that meets nothing of a surface is at least this far (m) from all of it; at most `limit`, and 0 where it is
/// less than `worth`. What lies below a height field is solid, so of its triangles only what keeps the shape above or
/// beside them counts.
float clearance(const Shape3& surface, const Shape3& shape, const detail::Convex& b,
                const detail::PlacedCorners& corners, const detail::OffDirections& off, const Transform3f& x,
                const Bounds3f& tight, float limit, float worth, bool solid) {
  const Mat3f turn = to_matrix(x.q);
  const Bounds3f own = detail::own_bounds(shape);
  const detail::ClearanceQuestion question{{turn.cx, turn.cy, turn.cz}, own.low, own.high, tight.low, tight.high};
  detail::PlacedShape placed{};
  corners.tell(placed);
  off.tell(placed);
  placed.radius = b.radius, placed.solid = solid;
  Bounds3f box = grow(tight, limit);
  if (solid) box.high.y = 3.4e38f;
  float least = limit;
  detail::visit_groups(surface, box, false, [&](const detail::TriangleGroup& group, std::uint32_t lanes) {
    float gaps[detail::TriangleGroup::lanes];
    detail::triangle_kernels().clearance(group, placed, question, gaps);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      float gap = gaps[lane];
      if (!corners.known() && gap < least) {
        const detail::SurfaceTriangle t = detail::triangle_of(surface, group, lane);
        Vec3f normal = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
        const float size = length(normal);
        for (const float side : {1.0f, -1.0f}) {
          if (!(size > 0) || (side < 0 && solid)) continue;
          const Vec3f n = normal * (side / size);
          const Vec3f nearest = transform_point(x, Vec3f(detail::support(b, Vec3d(inverse_rotate(x.q, -n)))));
          gap = max(gap, dot(n, nearest - t.corner[0]) - b.radius);
        }
      }
      least = min(least, gap);
    }
    return least > worth;
  });
  return least > worth ? least : 0;
}

/// Returns −1 for what meets nothing. `near`: of a shape with corners, some of it was in the box.
int surface_convex(const Shape3& surface, const Shape3& shape, const detail::Convex& b,
                   const detail::PlacedCorners& corners, const Transform3f& x, float margin, Vec3f held, Bounds3f box,
                   detail::OffDirections& off, bool& near, std::span<Manifold3> out) {
  constexpr int max_patches = 12;
  const bool solid = surface.type == ShapeType3::height_field;
  if (surface.type == ShapeType3::voxels && buried(*surface.voxels, b, x, out[0])) return 1;
  if (solid) box.high.y += 2 * (detail::outer_size(b) + b.radius);
  const bool cornered = corners.known();
  const Bounds3f own = grow(detail::own_bounds(shape), margin);
  const float same = 2e-3f * length(own.extents());  // hulls may lie far from the origin of their frame
  Patch patches[max_patches];
  int count = 0;
  const auto meet = [&](const detail::SurfaceTriangle& t) {
    const detail::Convex triangle = detail::convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]);
    ContactPoints points;
    Vec3f n;
    if (!detail::collide_triangle(triangle, t.edges, solid, b, corners, x, margin, held, off, points, n)) return;
    // Corners of the moving shape keep their names from triangle to triangle; points cut by an edge are the triangle's.
    for (int i = 0; i < points.count; ++i)
      if (points.point[i].feature > 0xff) points.point[i].feature ^= t.index * 2654435761u;
    const float depth = least(points);
    int at = -1;
    for (int i = 0; i < count && at < 0; ++i)
      if (dot(patches[i].normal, n) > 0.998f && patches[i].material == t.material) at = i;
    if (at < 0) {
      if (count < max_patches) {
        at = count++;
      } else {
        int shallowest = 0;
        for (int i = 1; i < count; ++i)
          if (patches[i].depth > patches[shallowest].depth) shallowest = i;
        if (patches[shallowest].depth <= depth) return;
        at = shallowest;
      }
      patches[at].points.count = 0;
      patches[at].normal = n, patches[at].depth = depth, patches[at].child = t.index;
      patches[at].material = t.material;
    }
    Patch& patch = patches[at];
    if (depth < patch.depth) patch.depth = depth, patch.normal = n;
    patch.child = min(patch.child, t.index);
    merge_into(patch, points, same);
  };
  if (cornered) {
    detail::CornersReach reach(corners, b.radius, length(max(abs(own.low), abs(own.high))), margin, held, solid, off);
    detail::visit_groups(surface, box, true, [&](const detail::TriangleGroup& group, std::uint32_t lanes) {
      near = true;
      lanes = reach.meets(group, lanes);
      for (const int learned = off.learned(); lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        if (off.learned() == learned || !reach.keeps_off(group, lane)) meet(triangle_of(surface, group, lane));
      }
      return true;
    });
  } else {
    const detail::TriangleReach reach(shape, b, x, margin, held, solid);
    detail::visit_triangles(surface, box, true, [&](const detail::SurfaceTriangle& t) {
      if (reach.meets(t.corner)) meet(t);
      return true;
    });
  }
  if (solid && count == 0 && sunk(*surface.height_field, b, x, out[0])) return 1;
  if (count == 0) return -1;
  Deepest found{out};
  for (int i = 0; i < count; ++i) {
    own_corners_first(patches[i].points);
    Manifold3 m;
    detail::write_points(patches[i].points, patches[i].normal, m);
    m.child = patches[i].child;
    m.material = patches[i].material;
    found.offer(m);
  }
  return found.count;
}

int surface_convex(const Shape3& surface, const Shape3& shape, const Transform3f& x, float margin,
                   const detail::ShapeWay& approach, PairCache& cache, std::span<Manifold3> out) {
  const detail::Convex b = detail::convex_of(shape);
  detail::PlacedCorners corners(b, x);
  const Bounds3f now = corners.known() ? corners.bounds() : Bounds3f{};
  const Bounds3f tight = corners.known() ? grow(Bounds3f{x.p + now.low, x.p + now.high}, b.radius) : bounds(shape, x);
  Bounds3f box = grow(tight, margin);
  if (corners.known() && approach.margin < margin) {
    corners.go(approach);
    const Bounds3f way = grow(merge(now, corners.bounds_then()), b.radius + approach.margin + approach.bend);
    box.low = max(box.low, x.p + way.low), box.high = min(box.high, x.p + way.high);
  }
  const bool solid = surface.type == ShapeType3::height_field;
  detail::OffDirections off(corners, approach, b.radius, margin, solid);
  off.begin_with(cache);
  bool near = false;
  const int count = surface_convex(surface, shape, b, corners, x, margin, approach.held, box, off, near, out);
  off.keep(cache);
  if (count >= 0) return count;
  out[0] = {};
  if (near && approach.worth >= margin) return 0;  // the distance is hardly worth knowing
  // A little less than what was measured, for rounding. To be farther off than is worth knowing is no better.
  const float half = 0.5f * detail::inner_size(b);
  const float limit = margin + (approach.worth > 0 ? min(half, approach.worth) : half);
  const float apart = clearance(surface, shape, b, corners, off, x, tight, limit, approach.worth, solid);
  out[0].points[0].separation = apart - 1e-5f * (1 + length(x.p));
  return 0;
}

/// The corners of the mesh that are below the plane or near it: one patch.
int mesh_plane(const TriangleMesh& mesh, const Plane& plane, const Transform3f& x, float margin,
               std::span<Manifold3> out) {
  const Vec3f n = rotate(x.q, plane.normal);
  const float level = dot(n, x.p);
  Patch patch;
  patch.normal = -n;
  const float same = 2e-3f * length(mesh.bounds.extents());
  const auto add = [&](std::uint32_t triangle) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.indices[3 * triangle + k];
      const Vec3f p = mesh.vertices[vertex];
      const float s = dot(n, p) - level;
      if (s > margin) continue;
      ContactPoints one;
      one.add(p - n * (0.5f * s), s, vertex);
      merge_into(patch, one, same);
    }
  };
  // The box of what is below the plane: along its steepest axis, for the lowest that the others can be.
  Bounds3f box = mesh.bounds;
  const int k = abs(n.x) >= abs(n.y) && abs(n.x) >= abs(n.z) ? 0 : (abs(n.y) >= abs(n.z) ? 1 : 2);
  float rest = level + margin;
  for (int other = 0; other < 3; ++other)
    if (other != k) rest -= min(n[other] * box.low[other], n[other] * box.high[other]);
  const float end = rest / n[k];
  if (n[k] > 0)
    box.high[k] = min(box.high[k], end);
  else
    box.low[k] = max(box.low[k], end);
  if (box.low[k] > box.high[k]) return 0;
  query(mesh.tree, grow(box, 1e-6f * length(mesh.bounds.extents())), [&](std::uint32_t i) {
    add(i);
    return true;
  });
  if (patch.points.count == 0) return 0;
  out[0].child = out[0].material = 0;
  detail::write_points(patch.points, patch.normal, out[0]);
  return 1;
}

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

int detail::collide_surface(const Shape3& surface, const Shape3& b, const Transform3f& b_in_a, float margin,
                            const Bounds3f& box, std::span<Manifold3> out) {
  const Convex core = convex_of(b);
  const PlacedCorners corners(core, b_in_a);
  OffDirections off(corners, {}, core.radius, margin, false);
  bool near = false;
  return max(many3::surface_convex(surface, b, core, corners, b_in_a, margin, {}, box, off, near, out), 0);
}
int detail::collide_approaching(const Shape3& surface, const Shape3& b, const Transform3f& b_in_a, float margin,
                                const ShapeWay& approach, PairCache& cache, std::span<Manifold3> out) {
  return many3::surface_convex(surface, b, b_in_a, margin, approach, cache, out);
}

int collide_many(const Shape3& a, const Shape3& b, const Transform3f& b_in_a, float margin, std::span<Manifold3> out) {
  if (out.empty()) return 0;
  if (a.type <= ShapeType3::plane && b.type <= ShapeType3::plane) {
    PairCache cache;
    collide(a, b, b_in_a, margin, cache, out[0]);
    return out[0].count > 0 ? 1 : 0;
  }
  if (a.type == ShapeType3::compound) return many3::compound_any(a, b, b_in_a, margin, out);
  if (is_surface(a) && is_convex(b)) {
    PairCache cache;
    return many3::surface_convex(a, b, b_in_a, margin, {}, cache, out);
  }
  if (a.type == ShapeType3::mesh && b.type == ShapeType3::plane)
    return many3::mesh_plane(*a.mesh, b.plane, b_in_a, margin, out);
  const bool plane_mesh = a.type == ShapeType3::plane && b.type == ShapeType3::mesh;
  if (plane_mesh || b.type == ShapeType3::compound || (is_surface(b) && is_convex(a))) {
    const int count = collide_many(b, a, inverse(b_in_a), margin, out);
    for (int i = 0; i < count; ++i) detail::flip(out[std::size_t(i)], b_in_a);
    return count;
  }
  return 0;  // two surfaces, or a height field and a plane
}

}  // namespace carom::geometry
