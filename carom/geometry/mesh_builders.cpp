#include "carom/geometry/mesh_builders.h"

#include "carom/geometry/detail/voxel_faces.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"

namespace carom::geometry {

namespace {

namespace mesh_building {

void add_triangle(Triangles& t, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  t.indices.insert(t.indices.end(), {a, b, c});
}
void add_quad(Triangles& t, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  add_triangle(t, a, b, c);
  add_triangle(t, a, c, d);
}

void append(Triangles& out, const Triangles& part, const Transform3f& place) {
  const std::uint32_t base = std::uint32_t(out.positions.size());
  for (const Vec3f& p : part.positions) out.positions.push_back(transform_point(place, p));
  for (const std::uint32_t i : part.indices) out.indices.push_back(base + i);
}

Vec2f direction(int i, int n) {
  const auto turn = math::sincos(2 * pi * i / n);
  return {float(turn.cos), float(turn.sin)};
}

// A quarter circle from the equator (0) to the pole, as (radius, height) steps.
std::vector<Vec2f> quarter(int steps) {
  std::vector<Vec2f> arc;
  for (int i = 0; i < steps; ++i) arc.push_back(direction(i, 4 * steps));
  arc.push_back({0, 1});
  return arc;
}

Triangles capsule_mesh(float half_length, float radius, int detail) {
  const std::vector<Vec2f> arc = quarter(max(2, detail / 4));
  std::vector<Vec2f> profile;
  for (std::size_t i = arc.size(); i-- > 0;) profile.push_back({radius * arc[i].x, -half_length - radius * arc[i].y});
  for (std::size_t i = half_length > 0 ? 0 : 1; i < arc.size(); ++i)
    profile.push_back({radius * arc[i].x, half_length + radius * arc[i].y});
  return make_lathe_mesh(profile, detail);
}

// A convex polyhedron swept by a sphere: each face moved out, each edge rounded by strips, each corner by a fan of
// arcs. `vertex` pieces are built between the normals of the faces round the corner.
Vec3f between(Vec3f a, Vec3f b, float s) { return normalize(lerp(a, b, s)); }

void add_edge_strip(Triangles& out, Vec3f a, Vec3f b, Vec3f n, Vec3f m, float r, int steps) {
  for (int i = 0; i < steps; ++i) {
    const Vec3f u = between(n, m, float(i) / float(steps)), v = between(n, m, float(i + 1) / float(steps));
    const std::uint32_t base = std::uint32_t(out.positions.size());
    out.positions.insert(out.positions.end(), {a + r * u, a + r * v, b + r * v, b + r * u});
    add_quad(out, base, base + 1, base + 2, base + 3);
  }
}

void add_corner_patch(Triangles& out, Vec3f center, Vec3f a, Vec3f b, Vec3f c, float r, int steps) {
  const auto at = [&](int i, int j) {
    const float s = float(i) / float(steps), t = i > 0 ? float(j) / float(i) : 0;
    return center + r * between(between(a, b, s), between(a, c, s), t);
  };
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j <= i; ++j) {
      const std::uint32_t base = std::uint32_t(out.positions.size());
      out.positions.insert(out.positions.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      add_triangle(out, base, base + 1, base + 2);
      if (j == i) continue;
      out.positions.push_back(at(i, j + 1));
      add_triangle(out, base, base + 2, base + 3);
    }
}

Triangles sharp_hull(const Hull& hull) {
  Triangles out;
  out.positions = hull.vertices;
  for (const HullFace& face : hull.faces) {
    const std::uint32_t first = hull.edges[face.first_edge].origin;
    for (std::uint16_t e = hull.edges[face.first_edge].next; hull.edges[e].next != face.first_edge;
         e = hull.edges[e].next)
      add_triangle(out, first, hull.edges[e].origin, hull.edges[hull.edges[e].next].origin);
  }
  return out;
}

Triangles rounded_hull(const Hull& hull, int detail) {
  Triangles out;
  const float r = hull.radius;
  const int steps = clamp(detail / 8, 2, 8);
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const HullFace& face = hull.faces[f];
    const Vec3f shift = hull.planes[f].normal * r;
    const std::uint32_t base = std::uint32_t(out.positions.size());
    std::uint16_t e = face.first_edge;
    for (std::uint32_t k = 0; k < face.edge_count; ++k, e = hull.edges[e].next) {
      out.positions.push_back(hull.vertices[hull.edges[e].origin] + shift);
      if (k >= 2) add_triangle(out, base, base + k - 1, base + k);
    }
  }
  for (std::size_t e = 0; e + 1 < hull.edges.size(); e += 2) {
    const HullEdge &edge = hull.edges[e], &twin = hull.edges[e + 1];
    add_edge_strip(out, hull.vertices[edge.origin], hull.vertices[twin.origin], hull.planes[edge.face].normal,
                   hull.planes[twin.face].normal, r, steps);
  }
  std::vector<bool> done(hull.vertices.size(), false);
  for (std::size_t start = 0; start < hull.edges.size(); ++start) {
    const std::uint16_t v = hull.edges[start].origin;
    if (done[v]) continue;
    done[v] = true;
    std::vector<Vec3f> normals;
    std::uint16_t e = std::uint16_t(start);
    do {
      normals.push_back(hull.planes[hull.edges[e].face].normal);
      std::uint16_t arriving = e;
      while (hull.edges[arriving].next != e) arriving = hull.edges[arriving].next;
      e = hull.edges[arriving].twin;
    } while (e != start);
    for (std::size_t i = 1; i + 1 < normals.size(); ++i)
      add_corner_patch(out, hull.vertices[v], normals[0], normals[i], normals[i + 1], r, steps);
  }
  return out;
}

Triangles box_mesh(const Box& box, int detail) {
  if (!(box.radius > 0)) return make_box_mesh(box.half_extents);
  const Vec3f h = box.half_extents;
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z});
  const auto hull = make_hull(corners, {.radius = box.radius});
  return hull.ok() ? rounded_hull(**hull, detail) : make_box_mesh(h);
}

Triangles cylinder_mesh(const Cylinder& c, int detail) {
  if (!(c.rounding > 0)) return make_prism_mesh(c.radius, c.half_height, detail);
  std::vector<Vec2f> profile;
  const int steps = max(2, detail / 4);
  for (const float side : {-1.0f, 1.0f})
    for (int i = 0; i <= steps; ++i) {
      const auto turn = math::sincos(pi / 2 * (side < 0 ? i - steps : i) / steps);
      profile.push_back({c.radius + c.rounding * float(turn.cos), side * c.half_height + c.rounding * float(turn.sin)});
    }
  return make_lathe_mesh(profile, detail);
}

Triangles cone_mesh(const Cone& c, int detail) {
  std::vector<Vec2f> profile;
  if (c.rounding > 0) {
    const int steps = max(2, detail / 4);
    const double side = math::atan2(double(c.radius), 2 * double(c.half_height));  // where its normal points
    for (int i = 0; i <= 2 * steps; ++i) {
      const auto turn = math::sincos(-pi / 2 + (side + pi / 2) * i / (2 * steps));
      profile.push_back({c.radius + c.rounding * float(turn.cos), c.rounding * float(turn.sin) - c.half_height});
    }
    for (int i = 0; i <= steps; ++i) {
      const auto turn = math::sincos(side + (pi / 2 - side) * i / steps);
      profile.push_back({i == steps ? 0 : c.rounding * float(turn.cos), c.rounding * float(turn.sin) + c.half_height});
    }
  } else {
    profile = {{c.radius, -c.half_height}, {0, c.half_height}};
  }
  return make_lathe_mesh(profile, detail);
}

Triangles height_field_mesh(const HeightField& field) {
  Triangles out;
  const std::uint32_t columns = std::uint32_t(field.columns), rows = std::uint32_t(field.rows);
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i)
      out.positions.push_back({float(i) * field.cell.x, field.heights[j * columns + i], float(j) * field.cell.y});
  for (std::uint32_t j = 0; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      if (!field.holes.empty() && field.holes[j * (columns - 1) + i]) continue;
      const std::uint32_t v = j * columns + i;
      add_quad(out, v, v + columns, v + columns + 1, v + 1);
    }
  return out;
}

Triangles plane_mesh(const Plane& plane) {
  const Vec3f n = plane.normal, u = perpendicular(n) * 100.0f, v = cross(n, perpendicular(n)) * 100.0f;
  return {{-u - v, u - v, u + v, v - u}, {0, 1, 2, 0, 2, 3}};
}

void add_arc(Outline& out, Vec2f center, Vec2f from, Vec2f to, float radius, int detail) {
  const double angle = math::atan2(double(cross(from, to)), double(dot(from, to)));
  const int steps = max(1, int(math::abs(angle) / (2 * pi) * detail + 0.999));
  for (int i = 0; i <= steps; ++i) {
    const auto turn = math::sincos(angle * i / steps);
    out.points.push_back(center + radius * rotate(Rot2f{float(turn.cos), float(turn.sin)}, from));
  }
}

}  // namespace mesh_building

}  // namespace

Triangles make_box_mesh(Vec3f h) {
  Triangles out;
  for (int i = 0; i < 8; ++i) out.positions.push_back({i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z});
  const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) mesh_building::add_quad(out, q[0], q[1], q[2], q[3]);
  return out;
}

Triangles make_lathe_mesh(std::span<const Vec2f> profile, int slices) {
  Triangles out;
  const std::uint32_t n = std::uint32_t(max(slices, 3));
  std::vector<std::uint32_t> ring;  // first vertex of each ring; rings of radius 0 are one vertex
  std::vector<Vec2f> points(profile.begin(), profile.end());
  if (points.empty()) return out;
  if (points.front().x > 0) points.insert(points.begin(), Vec2f{0, points.front().y});
  if (points.back().x > 0) points.push_back({0, points.back().y});
  for (const Vec2f& p : points) {
    ring.push_back(std::uint32_t(out.positions.size()));
    for (std::uint32_t i = 0; i < (p.x > 0 ? n : 1); ++i) {
      const Vec2f d = mesh_building::direction(int(i), int(n));
      out.positions.push_back({p.x * d.x, p.y, -p.x * d.y});
    }
  }
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const bool low = points[k].x > 0, high = points[k + 1].x > 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = (i + 1) % n;
      if (low && high)
        mesh_building::add_quad(out, ring[k] + i, ring[k] + next, ring[k + 1] + next, ring[k + 1] + i);
      else if (low)
        mesh_building::add_triangle(out, ring[k] + i, ring[k] + next, ring[k + 1]);
      else if (high)
        mesh_building::add_triangle(out, ring[k], ring[k + 1] + next, ring[k + 1] + i);
    }
  }
  return out;
}

Triangles make_sphere_mesh(float radius, int slices, int stacks) {
  std::vector<Vec2f> profile;
  const int n = max(stacks, 2);
  profile.push_back({0, -radius});
  for (int i = 1; i < n; ++i) {
    const auto turn = math::sincos(pi * i / n);
    profile.push_back({radius * float(turn.sin), -radius * float(turn.cos)});
  }
  profile.push_back({0, radius});
  return make_lathe_mesh(profile, slices);
}

Triangles make_prism_mesh(float radius, float half_height, int sides) {
  const Vec2f profile[] = {{radius, -half_height}, {radius, half_height}};
  return make_lathe_mesh(profile, sides);
}

Triangles make_torus_mesh(float major, float minor, int major_segments, int minor_segments) {
  Triangles out;
  const std::uint32_t m = std::uint32_t(max(major_segments, 3)), n = std::uint32_t(max(minor_segments, 3));
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const Vec2f u = mesh_building::direction(int(i), int(m)), v = mesh_building::direction(int(j), int(n));
      out.positions.push_back({(major + minor * v.x) * u.x, (major + minor * v.x) * u.y, minor * v.y});
    }
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * n, b = (i + 1) % m * n, next = (j + 1) % n;
      mesh_building::add_quad(out, a + j, b + j, b + next, a + next);
    }
  return out;
}

Triangles make_grid_mesh(int columns, int rows, Vec2f cell) {
  Triangles out;
  const std::uint32_t w = std::uint32_t(max(columns, 1)), h = std::uint32_t(max(rows, 1));
  for (std::uint32_t j = 0; j <= h; ++j)
    for (std::uint32_t i = 0; i <= w; ++i) out.positions.push_back({float(i) * cell.x, 0, float(j) * cell.y});
  for (std::uint32_t j = 0; j < h; ++j)
    for (std::uint32_t i = 0; i < w; ++i) {
      const std::uint32_t v = j * (w + 1) + i;
      mesh_building::add_quad(out, v, v + w + 1, v + w + 2, v + 1);
    }
  return out;
}

Triangles to_triangles(const Hull& hull, int detail) {
  return hull.radius > 0 ? mesh_building::rounded_hull(hull, clamp(detail, 8, 256)) : mesh_building::sharp_hull(hull);
}

Triangles to_triangles(const Shape3& shape, int detail) {
  detail = clamp(detail, 8, 256);
  switch (shape.type) {
    case ShapeType3::sphere:
      return make_sphere_mesh(shape.sphere.radius, detail, detail / 2);
    case ShapeType3::capsule:
      return mesh_building::capsule_mesh(shape.capsule.half_length, shape.capsule.radius, detail);
    case ShapeType3::box:
      return mesh_building::box_mesh(shape.box, detail);
    case ShapeType3::cylinder:
      return mesh_building::cylinder_mesh(shape.cylinder, detail);
    case ShapeType3::cone:
      return mesh_building::cone_mesh(shape.cone, detail);
    case ShapeType3::ellipsoid: {
      Triangles out = make_sphere_mesh(1, detail, detail / 2);
      for (Vec3f& p : out.positions) p = scale(p, shape.ellipsoid.radii);
      return out;
    }
    case ShapeType3::hull:
      return to_triangles(*shape.hull, detail);
    case ShapeType3::plane:
      return mesh_building::plane_mesh(shape.plane);
    case ShapeType3::mesh:
      return {shape.mesh->vertices, shape.mesh->indices};
    case ShapeType3::height_field:
      return mesh_building::height_field_mesh(*shape.height_field);
    case ShapeType3::voxels: {
      Triangles out;
      geometry::detail::visit_voxel_faces(
          *shape.voxels, bounds(shape, {}), [&](const geometry::detail::VoxelFace& face) {
            const auto first = std::uint32_t(out.positions.size());
            out.positions.insert(out.positions.end(), face.corner, face.corner + 4);
            out.indices.insert(out.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
            return true;
          });
      return out;
    }
    case ShapeType3::compound: {
      Triangles out;
      for (const CompoundChild& child : shape.compound->children)
        mesh_building::append(out, to_triangles(child.shape, detail), child.local);
      return out;
    }
  }
  return {};
}

Outline to_outline(const Shape2& shape, int detail) {
  Outline out;
  detail = clamp(detail, 8, 256);
  switch (shape.type) {
    case ShapeType2::circle:
      for (int i = 0; i < detail; ++i) out.points.push_back(shape.circle.radius * mesh_building::direction(i, detail));
      return out;
    case ShapeType2::capsule:
      for (const float side : {1.0f, -1.0f})
        for (int i = 0; i <= detail / 2; ++i) {
          const Vec2f d = side * mesh_building::direction(i, detail / 2 * 2);
          out.points.push_back(Vec2f{0, side * shape.capsule.half_length} + shape.capsule.radius * d);
        }
      return out;
    case ShapeType2::polygon: {
      const Polygon& p = shape.polygon;
      for (int i = 0; i < p.count; ++i) {
        if (!(p.radius > 0))
          out.points.push_back(p.vertices[i]);
        else
          mesh_building::add_arc(out, p.vertices[i], p.normals[(i + p.count - 1) % p.count], p.normals[i], p.radius,
                                 detail);
      }
      return out;
    }
    case ShapeType2::segment:
      return {{shape.segment.a, shape.segment.b}, false};
    case ShapeType2::chain_segment:
      return {{shape.chain_segment.a, shape.chain_segment.b}, false};
    case ShapeType2::chain:
      return {shape.chain->points, shape.chain->loop};
  }
  return out;
}

}  // namespace carom::geometry
