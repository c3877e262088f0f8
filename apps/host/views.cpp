#include "apps/host/views.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/voxel_faces.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::host {

using namespace geometry;

const char* name_of(ShapeKind kind) {
  constexpr const char* names[] = {"sphere", "capsule", "box",    "cylinder", "cone",    "ellipsoid",
                                   "plane",  "mesh",    "circle", "polygon",  "segment", "chain"};
  return names[int(kind)];
}

math::Quatf quaternion_of(math::Rot2f r) {
  // Half the angle without a trigonometric function, from the better conditioned half.
  if (r.c >= 0) {
    const float w = math::sqrt(math::max(0.0f, 0.5f * (1 + r.c)));
    return {w, 0, 0, r.s / (2 * w)};
  }
  const float z = math::sqrt(math::max(0.0f, 0.5f * (1 - r.c)));
  return {r.s / (2 * z), 0, 0, z};
}

namespace {

Mesh mesh_of(const Hull& hull) {
  Mesh mesh;
  // Corners are not shared between faces: a viewer computes flat normals from them.
  for (const HullFace& face : hull.faces) {
    const auto first = std::uint32_t(mesh.vertices.size());
    std::uint16_t edge = face.first_edge;
    for (int i = 0; i < face.edge_count; ++i) {
      mesh.vertices.push_back(hull.vertices[hull.edges[edge].origin]);
      edge = hull.edges[edge].next;
    }
    for (std::uint32_t i = 2; i < face.edge_count; ++i)
      mesh.indices.insert(mesh.indices.end(), {first, first + i - 1, first + i});
  }
  return mesh;
}

Mesh mesh_of(const TriangleMesh& from, int material) {
  Mesh mesh{from.vertices, {}};
  for (std::size_t i = 0; i < from.indices.size(); ++i)
    if (material < 0 || from.materials[i / 3] == material) mesh.indices.push_back(from.indices[i]);
  return mesh;
}

Mesh mesh_of(const HeightField& field, int material) {
  Mesh mesh;
  for (int j = 0; j < field.rows; ++j)
    for (int i = 0; i < field.columns; ++i)
      mesh.vertices.push_back(
          {float(i) * field.cell.x, field.heights[std::size_t(j) * field.columns + i], float(j) * field.cell.y});
  for (int j = 0; j + 1 < field.rows; ++j) {
    for (int i = 0; i + 1 < field.columns; ++i) {
      const std::size_t cell = std::size_t(j) * (field.columns - 1) + i;
      if (cell < field.holes.size() && field.holes[cell]) continue;
      if (material >= 0 && field.materials[cell] != material) continue;
      const auto a = std::uint32_t(j * field.columns + i), b = a + 1;
      const auto c = a + std::uint32_t(field.columns), d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, d, b, a, c, d});
    }
  }
  return mesh;
}

Mesh mesh_of(const Shape3& voxels, int material) {
  Mesh mesh;
  geometry::detail::visit_voxel_faces(*voxels.voxels, bounds(voxels, {}), [&](const geometry::detail::VoxelFace& face) {
    if (material >= 0 && face.material != material) return true;
    const auto first = std::uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), face.corner, face.corner + 4);
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    return true;
  });
  return mesh;
}

}  // namespace

std::uint32_t MeshLibrary::id_of(const Shape3& shape, int material) {
  for (std::size_t i = 0; i < owners_.size(); ++i)
    if (owners_[i].data == shape.data && owners_[i].material == material) return std::uint32_t(i);
  switch (shape.type) {
    case ShapeType3::hull:
      meshes_.push_back(mesh_of(*shape.hull));
      break;
    case ShapeType3::height_field:
      meshes_.push_back(mesh_of(*shape.height_field, material));
      break;
    case ShapeType3::voxels:
      meshes_.push_back(mesh_of(shape, material));
      break;
    case ShapeType3::mesh:
      meshes_.push_back(mesh_of(*shape.mesh, material));
      break;
    default:
      meshes_.push_back({});
      break;
  }
  owners_.push_back({shape.data, material});
  return std::uint32_t(owners_.size() - 1);
}

void view_shape(const Shape2& shape, const math::Transform2f& local, bool sensor, MeshLibrary&,
                std::vector<ShapeView>& out) {
  if (const int materials = material_count(shape); materials > 1) {
    const Chain& chain = *shape.chain;
    for (int i = 0; i < chain.segment_count(); ++i) {
      const ChainSegment s = chain.segment(i);
      if (i > 0 && chain.materials[std::size_t(i)] == chain.materials[std::size_t(i - 1)]) {
        out.back().points.push_back(s.b);
        continue;
      }
      ShapeView part;
      part.sensor = sensor;
      part.local = {{local.p.x, local.p.y, 0}, quaternion_of(local.q)};
      part.kind = ShapeKind::chain;
      part.points = {s.a, s.b};
      part.material = chain.materials[std::size_t(i)];
      out.push_back(std::move(part));
    }
    return;
  }
  ShapeView view;
  view.sensor = sensor;
  view.local = {{local.p.x, local.p.y, 0}, quaternion_of(local.q)};
  switch (shape.type) {
    case ShapeType2::circle:
      view.kind = ShapeKind::circle;
      view.radius = shape.circle.radius;
      break;
    case ShapeType2::capsule:
      view.kind = ShapeKind::capsule;
      view.radius = shape.capsule.radius;
      view.size.y = shape.capsule.half_length;
      break;
    case ShapeType2::polygon:
      view.kind = ShapeKind::polygon;
      view.radius = shape.polygon.radius;
      view.points.assign(shape.polygon.vertices, shape.polygon.vertices + shape.polygon.count);
      break;
    case ShapeType2::segment:
      view.kind = ShapeKind::segment;
      view.points = {shape.segment.a, shape.segment.b};
      break;
    case ShapeType2::chain_segment:
      view.kind = ShapeKind::segment;
      view.points = {shape.chain_segment.a, shape.chain_segment.b};
      break;
    case ShapeType2::chain:
      view.kind = ShapeKind::chain;
      view.points = shape.chain->points;
      view.loop = shape.chain->loop;
      break;
  }
  out.push_back(std::move(view));
}

void view_shape(const Shape3& shape, const math::Transform3f& local, bool sensor, MeshLibrary& meshes,
                std::vector<ShapeView>& out) {
  if (shape.type == ShapeType3::compound) {
    for (const CompoundChild& child : shape.compound->children)
      view_shape(child.shape, local * child.local, sensor, meshes, out);
    return;
  }
  if (const int materials = material_count(shape); materials > 1) {
    std::vector<bool> used(std::size_t(materials), false);
    if (shape.type == ShapeType3::voxels) {
      for (const std::uint8_t cell : shape.voxels->cells)
        if (cell > 0) used[std::size_t(cell) - 1] = true;
    } else {
      for (const std::uint8_t m :
           shape.type == ShapeType3::mesh ? shape.mesh->materials : shape.height_field->materials)
        used[m] = true;
    }
    for (int m = 0; m < materials; ++m) {
      if (!used[std::size_t(m)]) continue;
      ShapeView part;
      part.sensor = sensor;
      part.local = local;
      part.kind = ShapeKind::mesh;
      part.material = m;
      part.mesh = meshes.id_of(shape, m);
      out.push_back(std::move(part));
    }
    return;
  }
  ShapeView view;
  view.sensor = sensor;
  view.local = local;
  switch (shape.type) {
    case ShapeType3::sphere:
      view.kind = ShapeKind::sphere;
      view.radius = shape.sphere.radius;
      break;
    case ShapeType3::capsule:
      view.kind = ShapeKind::capsule;
      view.radius = shape.capsule.radius;
      view.size.y = shape.capsule.half_length;
      break;
    case ShapeType3::box:
      view.kind = ShapeKind::box;
      view.size = shape.box.half_extents;
      view.radius = shape.box.radius;
      break;
    case ShapeType3::cylinder:
      view.kind = ShapeKind::cylinder;
      view.radius = shape.cylinder.radius;
      view.size = {shape.cylinder.rounding, shape.cylinder.half_height, 0};
      break;
    case ShapeType3::cone:
      view.kind = ShapeKind::cone;
      view.radius = shape.cone.radius;
      view.size = {shape.cone.rounding, shape.cone.half_height, 0};
      break;
    case ShapeType3::ellipsoid:
      view.kind = ShapeKind::ellipsoid;
      view.size = shape.ellipsoid.radii;
      break;
    case ShapeType3::plane:
      view.kind = ShapeKind::plane;
      view.size = shape.plane.normal;
      break;
    case ShapeType3::hull:
    case ShapeType3::mesh:
    case ShapeType3::height_field:
    case ShapeType3::voxels:
    case ShapeType3::compound:
      view.kind = ShapeKind::mesh;
      view.mesh = meshes.id_of(shape);
      break;
  }
  out.push_back(std::move(view));
}

}  // namespace carom::host
