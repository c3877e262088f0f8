#include "carom/geometry/shape3.h"

#include <algorithm>
#include <limits>

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/corner_lanes.h"
#include "carom/geometry/detail/text.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/geometry/voxels.h"

namespace carom::geometry {

namespace {

core::Status check_round(const char* half, double half_value, const char* radius, double radius_value) {
  if (auto s = detail::check_range(half, half_value, min_shape_size, max_shape_size); !s) return s;
  return detail::check_range(radius, radius_value, min_shape_size, max_shape_size);
}

core::Status check_box(const Box& box) {
  const float least = min(box.half_extents.x, min(box.half_extents.y, box.half_extents.z));
  if (auto s = detail::check_point("box.half_extents", box.half_extents, max_shape_size); !s) return s;
  if (auto s = detail::check_range("the least of box.half_extents", least, min_shape_size, max_shape_size); !s)
    return s;
  return detail::check_range("box.radius", box.radius, 0, max_shape_size);
}

core::Status check_ellipsoid(const Ellipsoid& e) {
  for (const auto& [name, radius] :
       {std::pair{"ellipsoid.radii.x", e.radii.x}, std::pair{"ellipsoid.radii.y", e.radii.y},
        std::pair{"ellipsoid.radii.z", e.radii.z}})
    if (auto s = detail::check_range(name, radius, min_shape_size, max_shape_size); !s) return s;
  return {};
}

core::Status check_present(const void* pointer, const char* field, const char* maker) {
  if (pointer) return {};
  return detail::error("%s is null: expected one from %s", field, maker);
}

// The box of a box: exact for the placed box itself.
Bounds3f bounds_of_box(Vec3f center, Vec3f half, const Transform3f& t) {
  const Mat3f r = to_matrix(t.q);
  const Vec3f c = transform_point(t, center);
  const Vec3f e = abs(r.cx) * half.x + abs(r.cy) * half.y + abs(r.cz) * half.z;
  return {c - e, c + e};
}

// Half extents of a disc of unit radius whose axis is the unit vector a.
Vec3f disc_extents(Vec3f a) {
  return {math::sqrt(a.y * a.y + a.z * a.z), math::sqrt(a.z * a.z + a.x * a.x), math::sqrt(a.x * a.x + a.y * a.y)};
}

Bounds3f bounds_of_plane(const Plane& plane, const Transform3f& t) {
  constexpr float infinite = std::numeric_limits<float>::infinity();
  const Vec3f n = rotate(t.q, plane.normal);
  Bounds3f b{{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};
  for (int axis = 0; axis < 3; ++axis) {
    if (n[(axis + 1) % 3] != 0 || n[(axis + 2) % 3] != 0) continue;
    (n[axis] > 0 ? b.high : b.low)[axis] = t.p[axis];
  }
  return b;
}

Bounds3f bounds_of_hull(const Hull& hull, const Transform3f& t) {
  const Mat3f r = to_matrix(t.q);
  const float rows[3][3] = {{r.cx.x, r.cy.x, r.cz.x}, {r.cx.y, r.cy.y, r.cz.y}, {r.cx.z, r.cy.z, r.cz.z}};
  float low[3], high[3];
  detail::corner_kernels().extremes(hull.vertex_lanes.data(), int(hull.vertex_lanes.size() / 12), rows, low, high);
  return grow(Bounds3f{Vec3f{low[0], low[1], low[2]} + t.p, Vec3f{high[0], high[1], high[2]} + t.p}, hull.radius);
}

Bounds3f bounds_of_compound(const Compound& compound, const Transform3f& t) {
  Bounds3f b = bounds(compound.children[0].shape, t * compound.children[0].local);
  for (std::size_t i = 1; i < compound.children.size(); ++i)
    b = merge(b, bounds(compound.children[i].shape, t * compound.children[i].local));
  return b;
}

Vec3f support_of_disc(float radius, float y, Vec3f direction) {
  const float l = math::sqrt(direction.x * direction.x + direction.z * direction.z);
  if (!(l > 1e-18f)) return {0, y, 0};
  return {direction.x * (radius / l), y, direction.z * (radius / l)};
}

}  // namespace

namespace {
const std::vector<std::uint8_t>* materials_of(const Shape3& shape) {
  if (shape.type == ShapeType3::mesh) return &shape.mesh->materials;
  if (shape.type == ShapeType3::height_field) return &shape.height_field->materials;
  return nullptr;
}
}  // namespace

int material_count(const Shape3& shape) {
  if (shape.type == ShapeType3::voxels)
    return *std::max_element(shape.voxels->cells.begin(), shape.voxels->cells.end());
  const std::vector<std::uint8_t>* all = materials_of(shape);
  return all == nullptr || all->empty() ? 0 : 1 + *std::max_element(all->begin(), all->end());
}
std::uint8_t material_of_part(const Shape3& shape, std::uint32_t child) {
  if (shape.type == ShapeType3::voxels) {  // twelve triangles a cell
    const std::size_t cell = child / 12;
    return cell < shape.voxels->cells.size() && shape.voxels->cells[cell] > 0
               ? std::uint8_t(shape.voxels->cells[cell] - 1)
               : std::uint8_t(0);
  }
  const std::vector<std::uint8_t>* all = materials_of(shape);
  const std::size_t part = shape.type == ShapeType3::height_field ? child / 2 : child;  // two triangles a cell
  return all == nullptr || part >= all->size() ? std::uint8_t(0) : (*all)[part];
}

core::Status validate(const Shape3& shape) {
  switch (shape.type) {
    case ShapeType3::sphere:
      return detail::check_range("sphere.radius", shape.sphere.radius, min_shape_size, max_shape_size);
    case ShapeType3::capsule:
      if (auto s = detail::check_range("capsule.half_length", shape.capsule.half_length, 0, max_shape_size); !s)
        return s;
      return detail::check_range("capsule.radius", shape.capsule.radius, min_shape_size, max_shape_size);
    case ShapeType3::box:
      return check_box(shape.box);
    case ShapeType3::cylinder:
      if (auto s =
              check_round("cylinder.half_height", shape.cylinder.half_height, "cylinder.radius", shape.cylinder.radius);
          !s)
        return s;
      return detail::check_range("cylinder.rounding", shape.cylinder.rounding, 0, max_shape_size);
    case ShapeType3::cone:
      if (auto s = check_round("cone.half_height", shape.cone.half_height, "cone.radius", shape.cone.radius); !s)
        return s;
      return detail::check_range("cone.rounding", shape.cone.rounding, 0, max_shape_size);
    case ShapeType3::plane:
      if (!(abs(length(shape.plane.normal) - 1) < 1e-3f))
        return detail::error("plane.normal is (%g, %g, %g): expected a unit vector", double(shape.plane.normal.x),
                             double(shape.plane.normal.y), double(shape.plane.normal.z));
      return {};
    case ShapeType3::ellipsoid:
      return check_ellipsoid(shape.ellipsoid);
    case ShapeType3::hull:
      return check_present(shape.hull, "hull", "make_hull");
    case ShapeType3::mesh:
      return check_present(shape.mesh, "mesh", "make_triangle_mesh");
    case ShapeType3::height_field:
      return check_present(shape.height_field, "height_field", "make_height_field");
    case ShapeType3::voxels:
      return check_present(shape.voxels, "voxels", "make_voxel_grid");
    case ShapeType3::compound:
      return check_present(shape.compound, "compound", "make_compound");
  }
  return detail::error("shape type is %d: expected one of ShapeType3", int(shape.type));
}

Bounds3f bounds(const Shape3& shape, const Transform3f& t) {
  switch (shape.type) {
    case ShapeType3::sphere:
      return grow(Bounds3f{t.p, t.p}, shape.sphere.radius);
    case ShapeType3::capsule: {
      const Vec3f e = abs(rotate(t.q, Vec3f{0, shape.capsule.half_length, 0}));
      return grow(Bounds3f{t.p - e, t.p + e}, shape.capsule.radius);
    }
    case ShapeType3::box:
      return grow(bounds_of_box({}, shape.box.half_extents, t), shape.box.radius);
    case ShapeType3::cylinder: {
      const Vec3f axis = rotate(t.q, Vec3f{0, 1, 0});
      const Vec3f e = abs(axis) * shape.cylinder.half_height + disc_extents(axis) * shape.cylinder.radius;
      return grow(Bounds3f{t.p - e, t.p + e}, shape.cylinder.rounding);
    }
    case ShapeType3::cone: {
      const Vec3f axis = rotate(t.q, Vec3f{0, 1, 0});
      const Vec3f e = disc_extents(axis) * shape.cone.radius;
      const Vec3f base = t.p - axis * shape.cone.half_height, apex = t.p + axis * shape.cone.half_height;
      return grow(Bounds3f{min(base - e, apex), max(base + e, apex)}, shape.cone.rounding);
    }
    case ShapeType3::ellipsoid: {
      const Mat3f r = to_matrix(t.q);
      const Vec3f x = r.cx * shape.ellipsoid.radii.x, y = r.cy * shape.ellipsoid.radii.y,
                  z = r.cz * shape.ellipsoid.radii.z, squares = scale(x, x) + scale(y, y) + scale(z, z);
      const Vec3f e{math::sqrt(squares.x), math::sqrt(squares.y), math::sqrt(squares.z)};
      return {t.p - e, t.p + e};
    }
    case ShapeType3::plane:
      return bounds_of_plane(shape.plane, t);
    case ShapeType3::hull:
      return bounds_of_hull(*shape.hull, t);
    case ShapeType3::mesh: {
      const Bounds3f& b = shape.mesh->bounds;
      return bounds_of_box(b.center(), b.extents(), t);
    }
    case ShapeType3::height_field: {
      const HeightField& f = *shape.height_field;
      const Bounds3f b{{0, f.low, 0}, {float(f.columns - 1) * f.cell.x, f.high, float(f.rows - 1) * f.cell.y}};
      return bounds_of_box(b.center(), b.extents(), t);
    }
    case ShapeType3::voxels: {
      const VoxelGrid& g = *shape.voxels;
      const Vec3f half = Vec3f{float(g.columns), float(g.layers), float(g.rows)} * (0.5f * g.cell);
      return bounds_of_box(half, half, t);
    }
    case ShapeType3::compound:
      return bounds_of_compound(*shape.compound, t);
  }
  return {t.p, t.p};
}

Vec3f support(const Shape3& shape, Vec3f direction) {
  switch (shape.type) {
    case ShapeType3::sphere:
      return normalize(direction) * shape.sphere.radius;
    case ShapeType3::capsule: {
      const float y = direction.y < 0 ? -shape.capsule.half_length : shape.capsule.half_length;
      return Vec3f{0, y, 0} + normalize(direction) * shape.capsule.radius;
    }
    case ShapeType3::box: {
      const Vec3f h = shape.box.half_extents;
      const Vec3f corner{direction.x < 0 ? -h.x : h.x, direction.y < 0 ? -h.y : h.y, direction.z < 0 ? -h.z : h.z};
      return shape.box.radius > 0 ? corner + normalize(direction) * shape.box.radius : corner;
    }
    case ShapeType3::cylinder: {
      const float y = direction.y < 0 ? -shape.cylinder.half_height : shape.cylinder.half_height;
      const Vec3f rim = support_of_disc(shape.cylinder.radius, y, direction);
      return shape.cylinder.rounding > 0 ? rim + normalize(direction) * shape.cylinder.rounding : rim;
    }
    case ShapeType3::cone: {
      const Vec3f apex{0, shape.cone.half_height, 0};
      const Vec3f base = support_of_disc(shape.cone.radius, -shape.cone.half_height, direction);
      const Vec3f corner = dot(apex, direction) > dot(base, direction) ? apex : base;
      return shape.cone.rounding > 0 ? corner + normalize(direction) * shape.cone.rounding : corner;
    }
    case ShapeType3::ellipsoid: {
      const Vec3f scaled = scale(shape.ellipsoid.radii, direction);
      return scale(shape.ellipsoid.radii, normalize_or(scaled, Vec3f{1, 0, 0}, 1e-18f));
    }
    case ShapeType3::hull: {
      const Hull& hull = *shape.hull;
      std::size_t best = 0;
      float farthest = dot(hull.vertices[0], direction);
      for (std::size_t i = 1; i < hull.vertices.size(); ++i) {
        const float along = dot(hull.vertices[i], direction);
        if (along > farthest) farthest = along, best = i;
      }
      const Vec3f corner = hull.vertices[best];
      return hull.radius > 0 ? corner + normalize(direction) * hull.radius : corner;
    }
    case ShapeType3::plane:
    case ShapeType3::mesh:
    case ShapeType3::height_field:
    case ShapeType3::voxels:
    case ShapeType3::compound:
      break;  // not convex
  }
  return {};
}

}  // namespace carom::geometry
